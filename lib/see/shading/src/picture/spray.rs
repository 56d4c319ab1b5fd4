//! Spray behind the wheels of vehicles that drive fast on wet roads.
//!
//! Each wheel throws up a puff at even times; it is dragged along for a while, rises, widens and thins. A
//! puff is a Gaussian cloud, longer than wide, whose thickness along a pixel's ray up to what the pixel shows
//! is known in closed form. Where puffs are follows from the frame's time, the vehicle and its motion alone.

use crate::textures::{hash2, unit};
use frames::Aabb;
use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;
use render::VisibilityBuffer;
use schema::geometry::{Instance, Snapshot};
use schema::{FRAME_PERIOD_S, Tag};
use simd::{F32x8, LANES, Vec3x8, exp_neg};

use super::film::Film;
use super::picture::Picture;
use super::vignette::Vignette;
use crate::light::Lighting;
use render::CameraView;

/// Vehicles that are followed at most, the nearest, and how far off, metres.
const MOST_VEHICLES: usize = 8;
const FARTHEST_M: f32 = 120.0;
/// From this speed on there is some, and at this one all of it, metres a second.
const SPEEDS_MPS: [f32; 2] = [9.0, 30.0];
/// Less wet roads throw up nothing; from this wetness on they throw up all.
const WETNESS: [f32; 2] = [0.25, 0.85];
/// Puffs of a wheel follow one another in this time and last so long, seconds; those of front wheels are soon
/// among the next ones.
const EVERY_S: f32 = 0.09;
const LASTS_S: f32 = 1.0;
const FRONT_LASTS_S: f32 = 0.4;
/// They thin away within this time, seconds.
const THINS_S: f32 = 0.38;
/// Share of the speed that they have at first, and how long they keep it, seconds.
const DRAGGED: f32 = 0.45;
const KEEPS_S: f32 = 0.3;
/// Thickness of a fresh puff across its middle.
const THICK: f32 = 0.42;
/// Where axles are, shares of the length from either end.
const OVERHANG: f32 = 0.19;
/// Beyond so many widths nothing is left of a puff.
const REACH: f32 = 3.2;
/// Share of the light that drops send on.
const SENT_ON: f32 = 0.95;

/// A cloud: its middle, its axes over their widths (rows), how thick it is for a way of a metre through its
/// middle, and its light.
#[derive(Clone, Copy, Debug)]
struct Puff {
    middle: Vec3,
    scaled: Mat3,
    per_m: f32,
    widest_m: f32,
    light: Vec3,
}

/// A vehicle that throws up water.
struct Thrower {
    object: u16,
    /// How much, 0 to 1, and more for what is heavy.
    strength: f32,
    /// Its frame to the local one.
    local_from_object: glam::Affine3A,
    velocity: Vec3,
    bounds: Aabb,
}

/// What is needed to see spray as the rest of a picture.
pub(super) struct Spray<'a> {
    pub(super) snapshot: &'a Snapshot,
    pub(super) lighting: &'a Lighting,
    pub(super) film: &'a Film,
    pub(super) vignette: Vignette,
    pub(super) balance: Vec3,
    pub(super) exposure: f32,
}

impl Spray<'_> {
    /// Lays spray over a picture.
    pub(super) fn draw(&self, picture: &mut Picture, view: &CameraView, buffer: &VisibilityBuffer) {
        let wetness = smooth(WETNESS, self.lighting.around.wetness);
        if wetness <= 0.0 {
            return;
        }
        let camera = Vec3::from(view.local_from_optical.translation);
        let throwers = throwers(self.snapshot, camera, wetness);
        let time_s = f64::from(self.lighting.frame) * FRAME_PERIOD_S;
        let mut puffs: Vec<Puff> = throwers.iter().flat_map(|thrower| thrower.puffs(time_s)).collect();
        self.light(&mut puffs, camera);
        veil(picture, self, &puffs, view, buffer);
    }

    /// Gives puffs the light that they send on: of the sky all around, and of lamps.
    fn light(&self, puffs: &mut [Puff], camera: Vec3) {
        let Lighting { sky, lamps, fog, .. } = self.lighting;
        let pi = std::f32::consts::PI;
        let even = sky.ambient[0] / pi + sky.key_klx / (4.0 * pi);
        for chunk in puffs.chunks_mut(LANES) {
            let place = |i: usize| chunk.get(i).map_or(camera, |puff| puff.middle);
            let places = Vec3x8::from_fn(place);
            let to_camera = Vec3x8::from_fn(|i| (camera - place(i)).normalize_or(Vec3::Z));
            let by_lamps = if lamps.is_empty() {
                Vec3x8::default()
            } else {
                // From before and behind: drops send light on to all sides.
                let both = lamps.illuminance(&places, &to_camera)
                    + lamps.illuminance(&places, &(to_camera * F32x8::splat(-1.0)))
                    + lamps.illuminance(&places, &Vec3x8::splat(Vec3::Z));
                both * F32x8::splat(0.25 / pi)
            };
            let away_m = (places - Vec3x8::splat(camera)).length_squared().sqrt();
            let passes = fog.passes(camera.z, places.z, away_m).to_array();
            for (i, puff) in chunk.iter_mut().enumerate() {
                let seen = (even + by_lamps.lane(i)) * SENT_ON;
                puff.light = fog.rgb.lerp(seen, passes[i]) * self.exposure * self.balance;
                puff.per_m *= passes[i];
            }
        }
    }
}

/// 0 below the first, 1 above the second, smooth between.
fn smooth([low, high]: [f32; 2], x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The nearest vehicles that are fast enough, by distance.
fn throwers(snapshot: &Snapshot, camera: Vec3, wetness: f32) -> Vec<Thrower> {
    let mut found: Vec<(f32, Thrower)> = Vec::new();
    for motion in &snapshot.motions {
        let place = motion.local_from_object.translation;
        let moved = Vec3::from(place - motion.previous_local_from_object.translation);
        let velocity = moved.with_z(0.0) / FRAME_PERIOD_S as f32;
        let speed = smooth(SPEEDS_MPS, velocity.length());
        let away_m = (Vec3::from(place) - camera).length();
        if speed <= 0.0 || away_m > FARTHEST_M {
            continue;
        }
        // The body comes first.
        let is_own = |i: &&Instance| i.object == motion.object;
        let Some(body) = snapshot.instances.iter().find(is_own).map(|i| snapshot.mesh(i)) else { continue };
        let has = |tag: Tag| body.parts.iter().any(|part| part.tag == tag);
        let heavy = if has(Tag::Truck) || has(Tag::Bus) {
            2.2
        } else if has(Tag::Car) {
            1.0
        } else if has(Tag::Motorcycle) {
            0.4
        } else {
            continue;
        };
        let thrower = Thrower {
            object: motion.object,
            strength: speed * wetness * heavy,
            local_from_object: motion.local_from_object,
            velocity,
            bounds: body.aabb(),
        };
        found.push((away_m, thrower));
    }
    found.sort_by(|(a, first), (b, second)| a.total_cmp(b).then(first.object.cmp(&second.object)));
    found.into_iter().take(MOST_VEHICLES).map(|(_, thrower)| thrower).collect()
}

impl Thrower {
    /// The puffs that its wheels have thrown up and that are still there at a time.
    fn puffs(&self, time_s: f64) -> Vec<Puff> {
        let Aabb { min, max } = self.bounds;
        let (length, width, height) = (max.x - min.x, max.y - min.y, max.z - min.z);
        // A large wheel throws higher.
        let large = (height / 1.6).clamp(0.7, 1.8);
        let speed = self.velocity.length();
        let along = self.velocity / speed.max(1e-3);
        let side = Vec3::new(-along.y, along.x, 0.0);
        let latest = (time_s / f64::from(EVERY_S)).floor();
        let mut puffs = Vec::new();
        for (axle, (x, lasts_s)) in
            [(min.x + OVERHANG * length, LASTS_S), (max.x - OVERHANG * length, FRONT_LASTS_S)]
                .into_iter()
                .enumerate()
        {
            for (wheel, y) in [-0.40 * width, 0.40 * width].into_iter().enumerate() {
                let at = self.local_from_object.transform_point3(Vec3::new(x, y, 0.0));
                for back in 0..(lasts_s / EVERY_S) as i32 + 1 {
                    let number = latest as i64 - i64::from(back);
                    let age_s = (time_s - number as f64 * f64::from(EVERY_S)) as f32;
                    if age_s >= lasts_s {
                        continue;
                    }
                    let seed = hash2(i32::from(self.object), (2 * axle + wheel) as i32, number as u32);
                    let draw = |salt: i32| 2.0 * unit(hash2(salt, 0x51, seed)) - 1.0;
                    let kept = 1.0 - exp(-age_s / KEEPS_S);
                    let behind_m = speed * (age_s - DRAGGED * KEEPS_S * kept);
                    let spread = large * (0.16 + 0.5 * age_s * (1.0 + 0.3 * draw(0)));
                    let rise = large * (0.22 + 0.6 * age_s * (1.0 + 0.4 * draw(1)));
                    let aside = large * 0.5 * age_s * draw(2);
                    let middle = at - along * behind_m + side * aside + Vec3::Z * rise;
                    // Puffs of a wheel run into one another.
                    let long = spread.max(0.55 * speed * EVERY_S);
                    let high = 0.8 * spread;
                    let scaled = Mat3::from_cols(along / long, side / spread, Vec3::Z / high).transpose();
                    let fresh = 0.16 * large;
                    let ends = smooth([0.0, 0.06], age_s) * smooth([0.0, 0.3 * lasts_s], lasts_s - age_s);
                    let thick = THICK * self.strength * (1.0 + 0.4 * draw(3)) * exp(-age_s / THINS_S) * ends;
                    // A thickness across, spread over a width that grows.
                    let per_m = thick * (fresh / spread).sqrt() / (2.5 * fresh.max(spread));
                    puffs.push(Puff { middle, scaled, per_m, widest_m: long.max(spread), light: Vec3::ZERO });
                }
            }
        }
        puffs
    }
}

fn exp(x: f32) -> f32 {
    frames::math::f32::exp(x)
}

impl Puff {
    /// How thick it is along rays from a place up to depths, each in the unit of its direction.
    #[inline]
    fn thickness(&self, camera: Vec3, directions: &Vec3x8, depth: F32x8) -> F32x8 {
        // Where the cloud is a ball of width 1.
        let from = self.scaled * (camera - self.middle);
        let to = directions.turned(&self.scaled);
        let square = to.length_squared().fast_max(F32x8::splat(1e-12));
        let middle = to.dot(Vec3x8::splat(from)) * -1.0 / square;
        let off2 =
            (F32x8::splat(from.length_squared()) - middle * middle * square).fast_max(F32x8::ZERO) * 0.5;
        let near = off2.simd_lt(0.5 * REACH * REACH);
        if near.none() {
            return F32x8::ZERO;
        }
        let steep = (square * 0.5).sqrt();
        let through = erf((depth - middle) * steep) - erf(middle * steep * -1.0);
        let length = directions.length_squared().sqrt();
        // The root of pi over 8, twice, as both ends of the error function are a half.
        let whole = length / steep * (0.886_226_9 * self.per_m);
        near.select(whole * exp_neg(off2) * through.fast_max(F32x8::ZERO), F32x8::ZERO)
    }
}

/// The error function, within 5e-4 (Abramowitz and Stegun, 7.1.27).
#[inline]
fn erf(x: F32x8) -> F32x8 {
    let a = x.abs().fast_min(F32x8::splat(8.0));
    let series = (((a * 0.078_108 + 0.000_972) * a + 0.230_389) * a + 0.278_393) * a + 1.0;
    let square = series * series;
    let value = 1.0 - 1.0 / (square * square);
    x.simd_lt(0.0).select(value * -1.0, value)
}

/// The rows and columns of a picture that a puff may be seen in: first ones, and those after the last.
fn extent(puff: &Puff, view: &CameraView, buffer: &VisibilityBuffer) -> [Vec2; 2] {
    let size = Vec2::new(buffer.width as f32, buffer.height as f32);
    let all = [Vec2::ZERO, size];
    let seen = view.local_from_optical.inverse().transform_point3(puff.middle);
    let reach = REACH * puff.widest_m;
    // Through a lens, or around the camera: anywhere.
    if buffer.rays.is_some() || seen.z < reach * 1.1 {
        return if seen.z < -reach { [Vec2::ZERO; 2] } else { all };
    }
    let camera = &buffer.camera;
    let at = Vec2::new(camera.fx * seen.x / seen.z + camera.cx, camera.fy * seen.y / seen.z + camera.cy);
    let half =
        Vec2::new(camera.fx, camera.fy) * (reach / (seen.z - reach) * (1.0 + seen.length() / seen.z) * 0.5);
    [(at - half).clamp(Vec2::ZERO, size), (at + half).ceil().clamp(Vec2::ZERO, size)]
}

/// Lays puffs over a picture, row by row.
fn veil(
    picture: &mut Picture,
    with: &Spray<'_>,
    puffs: &[Puff],
    view: &CameraView,
    buffer: &VisibilityBuffer,
) {
    let extents: Vec<[Vec2; 2]> = puffs.iter().map(|puff| extent(puff, view, buffer)).collect();
    if extents.iter().all(|[first, end]| first.x >= end.x || first.y >= end.y) {
        return;
    }
    let codes = with.film.values();
    let camera = Vec3::from(view.local_from_optical.translation);
    let turn = Mat3::from(view.local_from_optical.matrix3);
    let width = picture.width as usize;
    picture.rgb.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
        let here: Vec<(usize, usize, &Puff)> = extents
            .iter()
            .zip(puffs)
            .filter(|([first, end], _)| first.y <= y as f32 + 1.0 && y as f32 <= end.y && first.x < end.x)
            .map(|([first, end], puff)| (first.x as usize, end.x as usize, puff))
            .collect();
        let Some(first) = here.iter().map(|(first, ..)| *first).min() else { return };
        let end = here.iter().map(|(_, end, _)| *end).max().unwrap_or(0);
        let row = row.as_chunks_mut::<3>().0;
        for from in (first / LANES * LANES..end).step_by(LANES) {
            let columns: [u32; LANES] = std::array::from_fn(|i| (from + i).min(width - 1) as u32);
            let directions = buffer.directions_optical(&columns, y as u32).turned(&turn);
            let depth: F32x8 = columns.map(|x| buffer.depth_m[buffer.index(x, y as u32)].min(1e6)).into();
            let (mut thick, mut light) = (F32x8::ZERO, Vec3x8::default());
            for (_, _, puff) in here.iter().filter(|(first, end, _)| *first < from + LANES && from < *end) {
                let own = puff.thickness(camera, &directions, depth);
                thick += own;
                light += Vec3x8::splat(puff.light) * own;
            }
            let is_seen = thick.simd_gt(0.005);
            if is_seen.none() {
                continue;
            }
            let light =
                light * (with.vignette.passes(&columns, y as u32) / thick.fast_max(F32x8::splat(1e-6)));
            let passes = exp_neg(thick).to_array();
            let bits = is_seen.to_bitmask();
            for (i, pixel) in row[from..width.min(from + LANES)].iter_mut().enumerate() {
                if bits >> i & 1 != 0 {
                    let behind = Vec3::from_array(pixel.map(|code| codes[usize::from(code)]));
                    let seen = light.lane(i).lerp(behind, passes[i]);
                    *pixel = seen.to_array().map(|value| with.film.code(value));
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn puff() -> Puff {
        let along = Vec3::new(0.8, 0.6, 0.0);
        let side = Vec3::new(-0.6, 0.8, 0.0);
        let scaled = Mat3::from_cols(along / 1.4, side / 0.5, Vec3::Z / 0.4).transpose();
        Puff { middle: Vec3::new(6.0, 1.0, 0.5), scaled, per_m: 0.7, widest_m: 1.4, light: Vec3::ONE }
    }

    #[test]
    fn thickness_is_the_sum_along_the_ray() {
        let (puff, camera) = (puff(), Vec3::new(0.3, -0.2, 1.1));
        for (direction, depth) in [
            (Vec3::new(1.0, 0.2, -0.1), 20.0),
            (Vec3::new(2.0, 0.3, -0.2), 3.1),
            (Vec3::new(1.0, 0.15, -0.08), 5.5),
            (Vec3::new(-1.0, 0.0, 0.0), 50.0),
            (Vec3::new(1.0, 0.9, 0.3), 9.0),
        ] {
            let steps = 20_000;
            let sum: f32 = (0..steps)
                .map(|step| {
                    let t = depth * (step as f32 + 0.5) / steps as f32;
                    let q = puff.scaled * (camera + direction * t - puff.middle);
                    exp(-0.5 * q.length_squared())
                })
                .sum::<f32>()
                * (puff.per_m * direction.length() * depth / steps as f32);
            let got = puff.thickness(camera, &Vec3x8::splat(direction), F32x8::splat(depth)).to_array()[2];
            assert!((got - sum).abs() < 0.006, "{direction} {depth}: {got} {sum}");
        }
    }

    #[test]
    fn fast_vehicles_on_wet_roads_throw_and_others_do_not() {
        let thrower = |mps: f32| Thrower {
            object: 7,
            strength: smooth(SPEEDS_MPS, mps),
            local_from_object: glam::Affine3A::IDENTITY,
            velocity: Vec3::X * mps,
            bounds: Aabb { min: Vec3::new(-2.3, -0.9, 0.0), max: Vec3::new(2.3, 0.9, 1.5) },
        };
        let all = |mps: f32| thrower(mps).puffs(12.34).iter().map(|p| p.per_m).sum::<f32>();
        assert!(all(8.0) == 0.0 && all(14.0) > 0.0 && all(28.0) > 2.0 * all(16.0));
        // They lie behind the wheels, above the ground, and thin out.
        let puffs = thrower(25.0).puffs(12.34);
        assert!(puffs.iter().all(|p| p.middle.x < 1.6 && p.middle.z > 0.1), "{puffs:?}");
        let mean = |wanted: &dyn Fn(f32) -> bool| {
            let some: Vec<f32> = puffs.iter().filter(|p| wanted(p.middle.x)).map(|p| p.per_m).collect();
            some.iter().sum::<f32>() / some.len() as f32
        };
        assert!(mean(&|x| x > -6.0) > 3.0 * mean(&|x| x < -12.0));
        // A puff moves on from frame to frame by less than the vehicle: it stays behind.
        let (now, next) = (thrower(25.0).puffs(12.31), thrower(25.0).puffs(12.33));
        assert_eq!(now.len(), next.len());
        for (a, b) in now.iter().zip(&next) {
            let back_m = a.middle.x - b.middle.x;
            assert!(back_m > 0.2 && back_m < 0.51, "{back_m}");
        }
    }
}
