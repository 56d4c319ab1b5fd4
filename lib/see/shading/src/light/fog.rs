//! Fog and haze between a surface and the camera.

use glam::Vec3;
use schema::tables::Weather;
use simd::{F32x8, exp_neg};

/// Haze of clear air per metre: visibility of about 60 km.
const AIR_PER_M: f32 = 6e-5;
/// Thinning with height per metre and unit of the weather's falloff.
const FALLOFF_PER_M: f32 = 0.04;
/// Distance at which the sky is seen through fog, metres.
const SKY_M: f32 = 4000.0;

/// Extinction of fog at the ground, per metre, by its density (0 to 1): `d (0.02 + 0.03 d)`. That is a
/// visibility (3.9 / extinction, Koschmieder) of 1.7 km at 10 %, 220 m at 50 %, 78 m at 100 %.
pub fn fog_extinction_per_m(density: f32) -> f32 {
    density * (0.02 + 0.03 * density)
}

/// Fog is no thicker than this, metres, however slowly it thins.
const THICKEST_M: f32 = 300.0;
/// Droplets scatter so much ahead (the mean cosine), that half of what they take from sunlight still throws
/// shadows.
const AHEAD: f32 = 0.85;
const BLURRED: f32 = 0.5;

/// What a weather's fog makes of light that comes from high above with the sine `up` of an altitude: the
/// share that still comes from there, and the share that comes from all over the sky instead. Two-stream
/// approximation of a layer that absorbs nothing: of all light `1 / (1 + 0.75 (1 - g) tau)` passes.
pub(super) fn through(weather: &Weather, up: f32) -> [f32; 2] {
    let density = (weather.fog_density / 100.0).clamp(0.0, 1.0) as f32;
    let per_height = FALLOFF_PER_M * weather.fog_falloff.clamp(0.0, 5.0) as f32;
    let depth = fog_extinction_per_m(density) * (1.0 / per_height.max(1e-6)).min(THICKEST_M);
    let direct = frames::math::f32::exp(-BLURRED * depth / up.max(0.1));
    let passes = 1.0 / (1.0 + 0.75 * (1.0 - AHEAD) * depth);
    [direct.min(passes), (passes - direct).max(0.0)]
}

/// Extinction of a fog layer that thins with height above the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fog {
    /// Light scattered into the line of sight.
    pub(crate) rgb: Vec3,
    even_per_m: f32,
    ground_per_m: f32,
    per_height: f32,
    start_m: f32,
    ground_z: f32,
}

impl Fog {
    /// The fog of a weather under a sky of this radiance at the horizon; `ground_z` is the height (local)
    /// from which it thins.
    pub(crate) fn new(weather: &Weather, horizon: Vec3, ground_z: f32) -> Self {
        let share = |percent: f64| (percent / 100.0).clamp(0.0, 1.0) as f32;
        let density = share(weather.fog_density);
        let rain = share(weather.precipitation);
        let dust = share(weather.dust_storm);
        let scattered = weather.scattering_intensity.clamp(0.0, 2.0) as f32;
        let dust_rgb = Vec3::new(1.15, 0.95, 0.7);
        Self {
            rgb: horizon * (0.85 + 0.15 * scattered) * Vec3::ONE.lerp(dust_rgb, dust),
            even_per_m: AIR_PER_M + 0.0028 * rain * rain + 0.02 * dust,
            ground_per_m: fog_extinction_per_m(density),
            per_height: FALLOFF_PER_M * weather.fog_falloff.clamp(0.0, 5.0) as f32,
            start_m: weather.fog_distance_m.max(0.0) as f32,
            ground_z,
        }
    }

    /// Share of light that passes from points at height `z` to a camera at `camera_z`, `distance_m` away.
    #[inline]
    pub(crate) fn passes(&self, camera_z: f32, z: F32x8, distance_m: F32x8) -> F32x8 {
        if self.is_clear() {
            // At most 0.06 within a camera's reach: the series' first terms are exact to 4e-5.
            let depth = distance_m * self.even_per_m;
            return (1.0 - depth * (1.0 - depth * 0.5)).fast_max(F32x8::ZERO);
        }
        // The mean of exp(-k h) along a straight line; a level line has one height.
        let camera = F32x8::splat(camera_z);
        let (low, rise) = (camera.fast_min(z) - self.ground_z, (camera - z).abs());
        let k = self.per_height;
        let x = rise * k;
        let slanted = (1.0 - exp_neg(x)) / x;
        let mean = x.simd_gt(1e-3).select(slanted, 1.0 - x * 0.5);
        let dense = exp_neg((low * k).fast_max(F32x8::ZERO)) * mean * self.ground_per_m;
        let beyond = (distance_m - self.start_m).fast_max(F32x8::ZERO);
        exp_neg(distance_m * self.even_per_m + dense * beyond)
    }

    /// The same for the sky in directions whose altitudes have these sines.
    #[inline]
    pub(crate) fn passes_sky(&self, camera_z: f32, up: F32x8) -> F32x8 {
        let up = up.fast_max(F32x8::ZERO);
        // Looking up leaves a layer of haze a kilometre thick.
        let length = SKY_M / (up * (SKY_M / 700.0) + 1.0);
        let fog = self.passes(camera_z, up * length + camera_z, length);
        // Clear air is in the sky's colours already.
        fog / exp_neg(length * AIR_PER_M)
    }

    /// Whether there is none but clear air's haze.
    #[inline]
    pub(crate) fn is_clear(&self) -> bool {
        self.ground_per_m <= 0.0 && self.even_per_m <= AIR_PER_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fog(density: f64, falloff: f64) -> Fog {
        let weather = Weather {
            fog_density: density,
            fog_distance_m: 10.0,
            fog_falloff: falloff,
            ..Weather::default()
        };
        Fog::new(&weather, Vec3::ONE, 0.0)
    }

    fn passes(fog: &Fog, camera_z: f32, z: f32, distance_m: f32) -> f32 {
        fog.passes(camera_z, F32x8::splat(z), F32x8::splat(distance_m)).to_array()[3]
    }

    #[test]
    fn it_matches_a_sum_along_the_line() {
        let f = fog(60.0, 2.0);
        for (camera_z, z, distance) in [(1.6, 0.0, 50.0), (1.6, 30.0, 120.0), (1.6, 1.6, 200.0)] {
            let n = 2000;
            let mean: f32 = (0..n)
                .map(|i| {
                    let h = camera_z + (z - camera_z) * (i as f32 + 0.5) / n as f32;
                    frames::math::f32::exp(-f.per_height * h)
                })
                .sum::<f32>()
                / n as f32;
            let depth = AIR_PER_M * distance + f.ground_per_m * mean * (distance - 10.0);
            let want = frames::math::f32::exp(-depth);
            let got = passes(&f, camera_z, z, distance);
            assert!((got - want).abs() < 2e-3, "{camera_z} {z}: {got} {want}");
        }
    }

    #[test]
    fn fog_softens_the_sun_and_takes_little_light() {
        let through = |fog_density, fog_falloff, up| {
            through(&Weather { fog_density, fog_falloff, ..Weather::default() }, up)
        };
        assert!(through(0.0, 0.2, 0.7) == [1.0, 0.0]);
        // 50 % is an extinction of 0.0175 per metre; at a falloff of 1 its layer is as good as 25 m thick.
        let depth = 0.4375f32;
        let [direct, scattered] = through(50.0, 1.0, 0.5);
        assert!((direct - frames::math::f32::exp(-depth)).abs() < 1e-4, "{direct}");
        assert!((direct + scattered - 1.0 / (1.0 + 0.1125 * depth)).abs() < 1e-4, "{scattered}");
        // Thicker fog, and a lower sun.
        assert!(through(100.0, 0.0, 0.7)[0] < 1e-3 && through(100.0, 0.0, 0.7)[1] > 0.3);
        assert!(through(50.0, 1.0, 0.2)[0] < direct);
    }

    #[test]
    fn density_and_distance_hide() {
        assert!(fog(0.0, 1.0).is_clear());
        let passes = |density, d| passes(&fog(density, 0.0), 1.6, 1.6, d);
        assert!(passes(100.0, 90.0) < 0.03);
        assert!(passes(10.0, 90.0) > 0.8);
        assert!(passes(50.0, 200.0) < passes(50.0, 100.0));
        let sky = |up| fog(80.0, 1.0).passes_sky(1.6, F32x8::splat(up)).to_array()[0];
        assert!(sky(1.0) > sky(0.05));
    }
}
