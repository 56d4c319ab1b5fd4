//! The sky of a frame: clear air, clouds, night glow; what it shines on surfaces.

use crate::textures::Noise;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use schema::tables::Weather;
use simd::{F32x8, Vec3x8, exp_neg, floor_words};

use super::atmosphere::Atmosphere;
use super::fog;
use super::math::luminance;

/// Side of the picture of the sky, texels.
const SIDE: usize = 512;
/// Altitudes and azimuths at which the clear air is worked out.
const ALTITUDES: usize = 40;
const AZIMUTHS: usize = 24;
/// Share of light that the ground sends back up.
const GROUND_ALBEDO: Vec3 = Vec3::new(0.17, 0.16, 0.14);
/// Full moon on a facing surface, brightened for the film, kilolux.
const MOON_KLX: Vec3 = Vec3::new(0.0007, 0.0009, 0.0013);
/// Altitude of the moon, which stands opposite the sun.
const MOON_UP: f32 = 0.6;
/// Glow of the night sky and of towns behind the horizon, kcd/m2.
const NIGHT: Vec3 = Vec3::new(0.000_05, 0.000_075, 0.000_14);
const TOWN: Vec3 = Vec3::new(0.000_35, 0.000_28, 0.000_22);
/// Share of direct light that comes back from lit surroundings.
const BOUNCED: f32 = 0.13;
/// Radius of the sun's disc, radians, a little enlarged by glare.
const SUN_RADIUS: f32 = 0.0075;

/// Red, green and blue; the fourth is idle.
type Texel = wide::f32x4;

/// The sky and the sun or moon of one frame; the same for all agents.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Radiance over the upper half of directions: `(x, y) / (1 + z)` spans the square.
    texels: Vec<Texel>,
    /// Radiance of the ground far away.
    ground: Vec3,
    /// Mean radiance near the horizon.
    pub(crate) horizon: Vec3,
    /// Towards the sun, or the moon when the sun is down; world axes.
    pub(crate) key_direction: Vec3,
    /// What it gives a facing surface, kilolux.
    pub(crate) key_klx: Vec3,
    /// Radiance of its disc.
    disc: Vec3,
    /// Illuminance from sky and ground of a surface with normal `n` is `ambient[0] + n . ambient[1..4]`.
    pub(crate) ambient: [Vec3; 4],
    /// What things stand in, those included that stand upright, kilolux.
    pub(crate) around_klx: Vec3,
    horizontal_klx: f32,
}

impl Sky {
    /// The sky in a weather, `time_s` seconds after frame 0 (clouds drift with the wind).
    #[must_use]
    pub fn new(weather: &Weather, time_s: f64) -> Self {
        let sun = Vec3::from_array(weather.direction_to_sun().map(|v| v as f32));
        let cover = (weather.cloudiness / 100.0).clamp(0.0, 1.0) as f32;
        let air = Atmosphere::new(
            weather.rayleigh_scattering_scale,
            weather.mie_scattering_scale,
            (weather.dust_storm / 100.0).clamp(0.0, 1.0) as f32,
            sun.z,
        );
        let clear = ClearSky::new(&air, sun);
        // Thick cloud lets a third of the light through and none of it directly.
        let veiled = smooth(0.45, 0.97, cover);
        let sun_klx = air.sun_klx();
        let (key_direction, clear_key) = if luminance(sun_klx) > luminance(MOON_KLX) {
            (sun, sun_klx)
        } else {
            let away = Vec2::new(-sun.x, -sun.y).normalize_or(Vec2::X) * (1.0 - MOON_UP * MOON_UP).sqrt();
            (away.extend(MOON_UP), MOON_KLX)
        };
        let [direct, scattered] = fog::through(weather, key_direction.z);
        // The sky's own light comes from all over it, whatever the sun does.
        let [clear_of_fog, _] = fog::through(weather, 0.5);
        let above_klx = clear_key * (1.0 - 0.985 * veiled);
        let key_klx = above_klx * direct;
        // What fog scatters comes from everywhere.
        let glow = above_klx * (scattered * key_direction.z.max(0.0) / std::f32::consts::PI);

        let clear_up = clear.mean() * std::f32::consts::PI + clear_key * key_direction.z.max(0.0);
        let overcast = Vec3::splat(luminance(clear_up)).lerp(clear_up, 0.35) * (0.36 / std::f32::consts::PI);
        let wind_m = (3.0 + 0.15 * weather.wind_intensity) * time_s;
        let clouds = Clouds { cover, veiled, overcast, sun, lit: clear_key, drift_m: wind_m as f32 };
        let noise = Noise::get();
        let texels: Vec<Texel> = (0..SIDE * SIDE)
            .into_par_iter()
            .with_min_len(SIDE)
            .map(|i| {
                let direction = direction_of((i % SIDE) as f32, (i / SIDE) as f32);
                let [r, g, b] = clouds.over(noise, direction, clear.at(direction)).to_array();
                Texel::new([r, g, b, 0.0])
            })
            .collect();

        let mut sky = Self {
            texels,
            ground: Vec3::ZERO,
            horizon: Vec3::ZERO,
            key_direction,
            key_klx,
            disc: if key_klx == Vec3::ZERO { Vec3::ZERO } else { key_klx * 12.0 },
            ambient: [Vec3::ZERO; 4],
            around_klx: Vec3::ZERO,
            horizontal_klx: 0.0,
        };
        sky.add_up();
        if clear_of_fog < 1.0 {
            // What comes from the sky through fog comes from everywhere, too; some goes back up.
            let even = sky.ambient_above() * (1.0 - clear_of_fog) + glow;
            let mix = |texel: &mut Texel| {
                let [r, g, b, _] = texel.to_array();
                let [r, g, b] = (Vec3::new(r, g, b) * clear_of_fog + even).to_array();
                *texel = Texel::new([r, g, b, 0.0]);
            };
            sky.texels.iter_mut().for_each(mix);
            sky.add_up();
        }
        sky
    }

    /// The even radiance that would give as much to what faces up.
    fn ambient_above(&self) -> Vec3 {
        (self.ambient[0] + self.ambient[3]) / std::f32::consts::PI
    }

    /// Works out what the sky gives surfaces.
    fn add_up(&mut self) {
        // Radiance of the upper half weighed by each component of its direction (first-order spherical
        // harmonics).
        let mut linear = [Vec3::ZERO; 3];
        let mut weights = 0.0;
        let mut ring = (Vec3::ZERO, 0.0f32);
        let step = 8;
        for row in (step / 2..SIDE).step_by(step) {
            for column in (step / 2..SIDE).step_by(step) {
                let d = direction_of(column as f32, row as f32);
                if d.z <= 0.0 {
                    continue;
                }
                // Solid angle of a texel in this projection.
                let weight = (1.0 + d.z) * (1.0 + d.z);
                let radiance = self.texel(column, row);
                for (sum, component) in linear.iter_mut().zip(d.to_array()) {
                    *sum += radiance * (component * weight);
                }
                weights += weight;
                if d.z < 0.12 {
                    ring.0 += radiance;
                    ring.1 += 1.0;
                }
            }
        }
        // The weights sum to the half sphere, 2 pi.
        let scale = std::f32::consts::TAU / weights;
        let linear = linear.map(|l| l * scale);
        self.horizon = ring.0 / ring.1.max(1.0);
        // Irradiance of an upward surface is the z component itself.
        let up = linear[2];
        let from_sun = self.key_klx * self.key_direction.z.max(0.0);
        let pi = std::f32::consts::PI;
        self.ground = (up + from_sun * 0.7) * GROUND_ALBEDO / pi;
        // Exact for surfaces that look straight up or down; the linear terms give walls their bright side.
        let below = self.ground * pi;
        self.ambient = [(up + below) * 0.5, linear[0] * 0.5, linear[1] * 0.5, (up - below) * 0.5];

        self.horizontal_klx = luminance(up + from_sun);
        // A low sun lights upright surfaces; cameras of cars mind the road more.
        self.around_klx = up + self.key_klx * self.key_direction.z.max(0.15);
    }

    /// Sunlight that walls and ground throw back into shadows, kilolux: a fixed share.
    pub(crate) fn bounced_klx(&self) -> Vec3 {
        self.key_klx * (BOUNCED * self.key_direction.z.max(0.1))
    }

    /// Whether the sun or moon is strong enough beside the sky for its shadows to be seen.
    pub(crate) fn key_casts_shadows(&self) -> bool {
        luminance(self.key_klx) * self.key_direction.z.max(0.05) > 0.02 * luminance(self.ambient[0])
    }

    /// Whether lamps light anything visibly.
    pub(crate) fn lamps_matter(&self) -> bool {
        self.horizontal_klx < 0.6
    }

    fn texel(&self, column: usize, row: usize) -> Vec3 {
        let [r, g, b, _] = self.texels[row * SIDE + column].to_array();
        Vec3::new(r, g, b)
    }

    /// Radiance from directions (world axes), without the sun's disc.
    #[inline]
    pub(crate) fn radiance(&self, directions: &Vec3x8) -> Vec3x8 {
        let z = directions.z;
        let up = z.simd_gt(0.0);
        let mut above = Vec3x8::default();
        if up.any() {
            let scale = 0.5 * SIDE as f32 / (z.fast_max(F32x8::ZERO) + 1.0);
            let limit = F32x8::splat((SIDE - 1) as f32 - 1e-2);
            let place = |v: F32x8| (v * scale + (0.5 * SIDE as f32 - 0.5)).fast_clamp(F32x8::ZERO, limit);
            let (x, y) = (place(directions.x), place(directions.y));
            let (x0, y0) = (x.floor(), y.floor());
            let index = (floor_words(y0) * SIDE as u32 + floor_words(x0)).to_array();
            let (fx, fy) = ((x - x0).to_array(), (y - y0).to_array());
            above = Vec3x8::from_fn(|i| {
                let first = index[i] as usize;
                let at = |i: usize| self.texels.get(i).copied().unwrap_or(Texel::ZERO);
                let mix = |a: Texel, b: Texel, share: f32| a + (b - a) * share;
                let upper = mix(at(first), at(first + 1), fx[i]);
                let lower = mix(at(first + SIDE), at(first + SIDE + 1), fx[i]);
                let [r, g, b, _] = mix(upper, lower, fy[i]).to_array();
                Vec3::new(r, g, b)
            });
            if up.all() {
                return above;
            }
        }
        // The far ground goes over into haze at the horizon.
        let haze = exp_neg((z * -12.0).fast_max(F32x8::ZERO));
        let below = Vec3x8::splat(self.ground).lerp(Vec3x8::splat(self.horizon), haze);
        above.or(up, below)
    }

    /// Radiance of what a camera sees in directions: sky with the sun's or moon's disc.
    #[inline]
    pub(crate) fn seen(&self, directions: &Vec3x8) -> Vec3x8 {
        let sky = self.radiance(directions);
        // 1 - cos is half the angle squared.
        let off2 = (1.0 - directions.dot(Vec3x8::splat(self.key_direction))).fast_max(F32x8::ZERO) * 2.0;
        let edge = off2 * (1.0 / (SUN_RADIUS * SUN_RADIUS));
        let near = edge.simd_lt(4000.0);
        if near.none() {
            return sky;
        }
        let glare = (1.0 - edge * (1.0 / 4000.0)) * 0.015 / (edge * 0.02 + 1.0);
        let disc = (1.5 - edge).fast_clamp(F32x8::ZERO, F32x8::ONE);
        sky + Vec3x8::splat(self.disc) * near.select(disc + glare, F32x8::ZERO)
    }
}

/// Direction of a texel's centre.
fn direction_of(column: f32, row: f32) -> Vec3 {
    let half = 0.5 * SIDE as f32;
    let (u, v) = ((column + 0.5 - half) / half, (row + 0.5 - half) / half);
    let r2 = u * u + v * v;
    // The corners beyond the horizon repeat it, so that interpolation at the rim has neighbours.
    if r2 >= 1.0 {
        let scale = 1.0 / r2.sqrt();
        return Vec3::new(u * scale, v * scale, 0.0);
    }
    Vec3::new(2.0 * u, 2.0 * v, 1.0 - r2) / (1.0 + r2)
}

fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Azimuths, radians, that the columns of a [`ClearSky`] stand for: they are even in the cosine.
fn azimuth_spans() -> [f32; AZIMUTHS] {
    let azimuth = |column: f32| {
        let side = (1.0 - 2.0 * column / (AZIMUTHS - 1) as f32).clamp(-1.0, 1.0);
        frames::math::f32::acos(side)
    };
    std::array::from_fn(|c| azimuth(c as f32 + 0.5) - azimuth(c as f32 - 0.5))
}

/// Radiance of the cloudless sky by altitude and by azimuth from the sun.
struct ClearSky {
    table: Vec<Vec3>,
    sun: Vec2,
}

impl ClearSky {
    fn new(air: &Atmosphere, sun: Vec3) -> Self {
        let table: Vec<Vec3> = (0..ALTITUDES * AZIMUTHS)
            .into_par_iter()
            .map(|i| {
                // Denser near the horizon, where the sky changes most.
                let t = (i / AZIMUTHS) as f32 / (ALTITUDES - 1) as f32;
                let side = 1.0 - 2.0 * (i % AZIMUTHS) as f32 / (AZIMUTHS - 1) as f32;
                let up = t * t;
                let haze = (1.0 - up) * (1.0 - up);
                air.radiance(up, side) + NIGHT + TOWN * (haze * haze * haze)
            })
            .collect();
        let mut sky = Self { table, sun: Vec2::new(sun.x, sun.y).normalize_or(Vec2::X) };
        let down = 1.0 - smooth(-0.03, 0.05, sun.z);
        if down > 0.0 {
            sky.scatter_again(air, down);
        }
        sky
    }

    /// Adds a share of what the air scatters of the sky's own light; below the horizon there is none.
    fn scatter_again(&mut self, air: &Atmosphere, share: f32) {
        let azimuths = azimuth_spans();
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (i, radiance) in self.table.iter().enumerate() {
            // d(up) is 2 t dt.
            let weight = (i / AZIMUTHS) as f32 * azimuths[i % AZIMUTHS];
            (sum, weights) = (sum + *radiance * weight, weights + weight);
        }
        let around = sum * (0.5 * share / weights);
        for (row, radiances) in self.table.chunks_mut(AZIMUTHS).enumerate() {
            let t = row as f32 / (ALTITUDES - 1) as f32;
            let more = air.again(t * t) * around;
            radiances.iter_mut().for_each(|radiance| *radiance += more);
        }
    }

    fn at(&self, direction: Vec3) -> Vec3 {
        let flat = Vec2::new(direction.x, direction.y);
        let side = flat.normalize_or(self.sun).dot(self.sun);
        let row = direction.z.max(0.0).sqrt().min(1.0) * (ALTITUDES - 1) as f32;
        let column = (0.5 - 0.5 * side).clamp(0.0, 1.0) * (AZIMUTHS - 1) as f32;
        let (r, c) = ((row as usize).min(ALTITUDES - 2), (column as usize).min(AZIMUTHS - 2));
        let (fr, fc) = (row - r as f32, column - c as f32);
        let cell = |r: usize, c: usize| self.table[r * AZIMUTHS + c];
        cell(r, c).lerp(cell(r, c + 1), fc).lerp(cell(r + 1, c).lerp(cell(r + 1, c + 1), fc), fr)
    }

    /// Mean radiance as an upward surface weighs it.
    fn mean(&self) -> Vec3 {
        let azimuths = azimuth_spans();
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for r in 0..ALTITUDES {
            let t = r as f32 / (ALTITUDES - 1) as f32;
            // d(up) is 2 t dt; an upward surface weighs by up.
            for (c, span) in azimuths.iter().enumerate() {
                let weight = t * t * t * span;
                sum += self.table[r * AZIMUTHS + c] * weight;
                weights += weight;
            }
        }
        sum / weights
    }
}

/// Clouds on a plane above.
struct Clouds {
    cover: f32,
    veiled: f32,
    overcast: Vec3,
    sun: Vec3,
    lit: Vec3,
    drift_m: f32,
}

impl Clouds {
    const HEIGHT_M: f32 = 1500.0;

    /// The sky in a direction with clouds in front.
    fn over(&self, noise: &Noise, direction: Vec3, clear: Vec3) -> Vec3 {
        if self.cover <= 0.0 {
            return clear;
        }
        let up = direction.z.max(0.0);
        // The layer curves with the planet: it does not reach infinity at the horizon.
        let distance = Self::HEIGHT_M / (up + 0.08);
        let (x, y) = (direction.x * distance + self.drift_m, direction.y * distance + 0.4 * self.drift_m);
        let footprint = distance / SIDE as f32 / (up + 0.08);
        let large = noise.at(x / 55.0, y / 55.0, footprint / 55.0);
        let small = noise.at(y / 13.0 + 40.0, x / 13.0, footprint / 13.0);
        let thickness = 0.72 * large + 0.28 * small;
        let threshold = 0.82 - 0.9 * self.cover;
        let mask = smooth(threshold, threshold + 0.22, thickness).max(self.veiled);
        // Overcast: twice as bright above as at the horizon (CIE); thick parts are darker.
        let grey = self.overcast * ((1.0 + 2.0 * up) * (3.0 / 7.0) * (1.25 - 0.5 * thickness));
        let toward_sun = 0.5 + 0.5 * direction.dot(self.sun);
        let depth = smooth(threshold, threshold + 0.6, thickness);
        let white = self.lit * ((0.14 + 0.16 * toward_sun * toward_sun) * (1.0 - 0.45 * depth))
            + self.overcast * 0.45;
        let cloud = white.lerp(grey, self.veiled);
        // Far clouds go over into the haze.
        let haze = (1.0 - up) * (1.0 - up);
        let haze = haze * haze * haze * haze * (1.0 - 0.8 * self.veiled);
        clear.lerp(cloud, mask * (1.0 - 0.8 * haze))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radiance(sky: &Sky, direction: Vec3) -> Vec3 {
        sky.radiance(&Vec3x8::splat(direction)).lane(5)
    }

    #[test]
    fn ambient_light_is_the_sky_integrated() {
        // Against a direct sum over directions, for an upward and a tilted surface.
        let sky = Sky::new(&Weather { cloudiness: 30.0, ..Weather::default() }, 0.0);
        for (normal, tolerance) in [(Vec3::Z, 0.08), (Vec3::new(0.6, 0.0, 0.8), 0.15)] {
            let mut sum = Vec3::ZERO;
            let (rows, columns) = (120, 240);
            for r in 0..rows {
                let z = 1.0 - 2.0 * (r as f32 + 0.5) / rows as f32;
                for c in 0..columns {
                    let (sin, cos) =
                        frames::math::f32::sin_cos(std::f32::consts::TAU * (c as f32 + 0.5) / columns as f32);
                    let flat = (1.0 - z * z).sqrt();
                    let d = Vec3::new(flat * cos, flat * sin, z);
                    let radiance = if z > 0.0 { radiance(&sky, d) } else { sky.ground };
                    sum += radiance * d.dot(normal).max(0.0);
                }
            }
            let want = sum * (4.0 * std::f32::consts::PI / (rows * columns) as f32);
            let [a, x, y, z] = sky.ambient;
            let got = a + x * normal.x + y * normal.y + z * normal.z;
            assert!((got - want).abs().max_element() < tolerance * want.max_element(), "{got} {want}");
        }
    }

    #[test]
    fn directions_and_texels_agree() {
        let sky = Sky::new(&Weather { cloudiness: 60.0, ..Weather::default() }, 3.0);
        for (column, row) in [(100, 300), (256, 256), (400, 120), (60, 256)] {
            let d = direction_of(column as f32, row as f32);
            let got = radiance(&sky, d);
            assert!((got - sky.texel(column, row)).abs().max_element() < 1e-3 * got.max_element());
        }
    }

    #[test]
    fn fog_spreads_the_sun_over_the_sky() {
        let clear = Sky::new(&Weather::default(), 0.0);
        let fog = Sky::new(&Weather { fog_density: 70.0, fog_falloff: 0.5, ..Weather::default() }, 0.0);
        assert!(fog.key_klx.y < 0.6 * clear.key_klx.y);
        // What is lost from the sun is gained by the sky, but for what goes back up.
        let share = fog.horizontal_klx / clear.horizontal_klx;
        assert!((0.8..1.0).contains(&share), "{share}");
        assert!(fog.ambient[0].y > 1.3 * clear.ambient[0].y);
    }

    #[test]
    fn clouds_veil_the_sun_and_night_is_dark() {
        let clear = Sky::new(&Weather::default(), 0.0);
        let grey = Sky::new(&Weather { cloudiness: 100.0, ..Weather::default() }, 0.0);
        assert!(grey.key_klx.y < 0.03 * clear.key_klx.y);
        let night = Sky::new(&Weather { sun_altitude_deg: -40.0, ..Weather::default() }, 0.0);
        assert!(night.horizontal_klx < 1e-4 * clear.horizontal_klx);
        assert!(night.lamps_matter() && !clear.lamps_matter());
        assert!(night.key_direction.z > 0.0);
    }
}
