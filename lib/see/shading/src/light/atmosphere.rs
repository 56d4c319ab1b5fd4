//! Sunlight scattered once by air: colours of the clear sky by day and at dusk.
//!
//! Rayleigh and Mie scattering with ozone absorption, constants as in Bruneton and Neyret, "Precomputed
//! atmospheric scattering" (2008) and Hillaire (2020). Light scattered more than once is left out but for a
//! share of what reaches air from the sun, and of what the sky as a whole sends when the sun is down: that is
//! what makes the upper sky of twilight blue, with the ozone.

use glam::Vec3;

use super::math::exp_neg;

const GROUND_M: f32 = 6_360_000.0;
const TOP_M: f32 = 6_440_000.0;
const RAYLEIGH_HEIGHT_M: f32 = 8000.0;
const MIE_HEIGHT_M: f32 = 1200.0;
const RAYLEIGH_PER_M: Vec3 = Vec3::new(5.8e-6, 13.5e-6, 33.1e-6);
const MIE_PER_M: f32 = 4.0e-6;
const MIE_ABSORBED: f32 = 1.11;
/// Cross-sections of some 4.6, 3.2 and 0.5e-25 m2 at the wavelengths of sRGB's primaries (615, 545 and 465
/// nm; Chappuis' bands), and 5e18 molecules per m3 where there are most.
const OZONE_PER_M: Vec3 = Vec3::new(2.3e-6, 1.6e-6, 0.25e-6);
/// How much Mie scattering prefers its direction.
const MIE_FORWARD: f32 = 0.76;
/// The sky is seen from this height, metres; its horizon is so much lower than level.
const EYE_M: f32 = 20.0;
const HORIZON_RAD: f32 = 0.0025;
/// Radius of the sun's disc.
const SUN_RADIUS_RAD: f32 = 0.004_65;
/// Illuminance above the air, kilolux.
const SUN_KLX: f32 = 128.0;
/// Share of the light lost by scattering that comes back from all sides.
const AGAIN: f32 = 0.7;
/// Weather values that mean the earth's air.
const EARTH_RAYLEIGH: f64 = 0.0331;
const EARTH_MIE: f64 = 0.03;

const VIEW_STEPS: usize = 16;
const SUN_STEPS: usize = 8;

/// Share of light that passes an optical depth.
fn passes(depth: Vec3) -> Vec3 {
    Vec3::new(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z))
}

/// The air of a frame.
pub(super) struct Atmosphere {
    rayleigh_per_m: Vec3,
    mie_per_m: f32,
    /// Sine of the sun's altitude.
    pub(super) sun_up: f32,
    sun_flat: f32,
}

impl Atmosphere {
    pub(super) fn new(rayleigh_scale: f64, mie_scale: f64, dust: f32, sun_up: f32) -> Self {
        let mie = 0.3 + 0.7 * (mie_scale / EARTH_MIE).clamp(0.0, 20.0) as f32 + 20.0 * dust;
        Self {
            rayleigh_per_m: RAYLEIGH_PER_M * (rayleigh_scale / EARTH_RAYLEIGH).clamp(0.2, 5.0) as f32,
            mie_per_m: MIE_PER_M * mie,
            sun_up,
            sun_flat: (1.0 - sun_up * sun_up).max(0.0).sqrt(),
        }
    }

    /// Extinction per metre at a height.
    fn extinction(&self, height_m: f32) -> Vec3 {
        let ozone = (1.0 - (height_m - 25_000.0).abs() / 15_000.0).max(0.0);
        self.rayleigh_per_m * exp_neg(height_m.max(0.0) / RAYLEIGH_HEIGHT_M)
            + Vec3::splat(self.mie_per_m * MIE_ABSORBED * exp_neg(height_m.max(0.0) / MIE_HEIGHT_M))
            + OZONE_PER_M * ozone
    }

    /// Share of sunlight that reaches a place: the sun is in the plane of x and up (z), the planet's middle
    /// at the origin.
    fn sunlight(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        // In f64: the planet's radius squared loses kilometres in f32.
        let along = f64::from(x) * f64::from(self.sun_flat) + f64::from(z) * f64::from(self.sun_up);
        let aside2 = f64::from(y) * f64::from(y);
        let r2 = f64::from(x) * f64::from(x) + aside2 + f64::from(z) * f64::from(z);
        let ground = f64::from(GROUND_M) * f64::from(GROUND_M);
        let closest2 = r2 - along * along;
        if along < 0.0 && closest2 < ground {
            return Vec3::ZERO; // The planet is in between.
        }
        let top = f64::from(TOP_M) * f64::from(TOP_M);
        let length = (-along + (top - closest2).max(0.0).sqrt()) as f32;
        // The air is thickest near the start; for a sun below the horizon where its light comes closest to
        // the ground.
        let thickest = (-along).max(0.0) as f32;
        let mut depth = Vec3::ZERO;
        for end_m in [0.0, length] {
            let reach = end_m - thickest;
            if reach == 0.0 {
                continue;
            }
            let mut before = 0.0;
            for i in 0..SUN_STEPS {
                let end = (i + 1) as f32 / SUN_STEPS as f32;
                let end = reach * end * end;
                let at = thickest + 0.5 * (before + end);
                let (px, pz) = (x + at * self.sun_flat, z + at * self.sun_up);
                let height = f64::from(px) * f64::from(px) + aside2 + f64::from(pz) * f64::from(pz);
                let height_m = (height.sqrt() - f64::from(GROUND_M)) as f32;
                depth += self.extinction(height_m) * (end - before).abs();
                before = end;
            }
        }
        passes(depth)
    }

    /// Illuminance of a surface on the ground that faces the sun, kilolux: as much of it as of its disc is
    /// up.
    pub(super) fn sun_klx(&self) -> Vec3 {
        let horizon = -HORIZON_RAD;
        let up = ((self.sun_up - horizon) / (2.0 * SUN_RADIUS_RAD) + 0.5).clamp(0.0, 1.0);
        if up == 0.0 {
            return Vec3::ZERO;
        }
        let seen = self.sun_up.max(horizon);
        let seen = Self { sun_up: seen, sun_flat: (1.0 - seen * seen).max(0.0).sqrt(), ..*self };
        seen.sunlight([0.0, 0.0, GROUND_M + EYE_M]) * (up * SUN_KLX)
    }

    /// Radiance from a direction: `up` is the sine of its altitude (not negative), `side` the cosine of the
    /// angle between its azimuth and the sun's.
    pub(super) fn radiance(&self, up: f32, side: f32) -> Vec3 {
        let flat = (1.0 - up * up).max(0.0).sqrt();
        // Sun in the x-z plane; the view may leave it along y.
        let dx = flat * side;
        let dy = flat * (1.0 - side * side).max(0.0).sqrt();
        let cos = dx * self.sun_flat + up * self.sun_up;
        let pi = std::f32::consts::PI;
        let rayleigh_phase = 3.0 / (16.0 * pi) * (1.0 + cos * cos);
        let g = MIE_FORWARD;
        let spread = (1.0 + g * g - 2.0 * g * cos).max(1e-4);
        let mie_phase =
            3.0 * (1.0 - g * g) * (1.0 + cos * cos) / (8.0 * pi * (2.0 + g * g) * spread * spread.sqrt());

        let (ground, top) = (f64::from(GROUND_M + EYE_M), f64::from(TOP_M));
        let b = ground * f64::from(up);
        let length = (-b + (b * b + top * top - ground * ground).sqrt()) as f32;
        let mut depth = Vec3::ZERO;
        let mut sum = Vec3::ZERO;
        let mut before = 0.0;
        for i in 0..VIEW_STEPS {
            let end = (i + 1) as f32 / VIEW_STEPS as f32;
            let end = length * end * end;
            let (at, step) = (0.5 * (before + end), end - before);
            let (px, py) = (dx * at, dy * at);
            let pz = ground + f64::from(up * at);
            let radius = (f64::from(px * px + py * py) + pz * pz).sqrt();
            let height = (radius - f64::from(GROUND_M)) as f32;
            let here = self.extinction(height);
            let passed = passes(depth + here * (0.5 * step));
            let rayleigh = self.rayleigh_per_m * exp_neg(height.max(0.0) / RAYLEIGH_HEIGHT_M);
            let mie = self.mie_per_m * exp_neg(height.max(0.0) / MIE_HEIGHT_M);
            let sun = self.sunlight([px, py, pz as f32]);
            let once = rayleigh * rayleigh_phase + Vec3::splat(mie * mie_phase);
            let again = (rayleigh + Vec3::splat(mie)) * (AGAIN / (4.0 * pi));
            sum += passed * sun * (once + again) * step;
            depth += here * step;
            before = end;
        }
        sum * SUN_KLX
    }

    /// How much of what the whole sky sends is sent again from a direction with the sine `up` of an altitude:
    /// a share of the sky's mean radiance.
    pub(super) fn again(&self, up: f32) -> Vec3 {
        let (ground, top) = (f64::from(GROUND_M + EYE_M), f64::from(TOP_M));
        let b = ground * f64::from(up);
        let length = (-b + (b * b + top * top - ground * ground).sqrt()) as f32;
        let (mut depth, mut sum, mut before) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for i in 0..VIEW_STEPS {
            let end = (i + 1) as f32 / VIEW_STEPS as f32;
            let end = length * end * end;
            let (at, step) = (0.5 * (before + end), end - before);
            let along = f64::from(at);
            let radius = (ground * ground + 2.0 * b * along + along * along).sqrt();
            let height = ((radius - f64::from(GROUND_M)) as f32).max(0.0);
            let here = self.extinction(height);
            let passed = passes(depth + here * (0.5 * step));
            let scattered = self.rayleigh_per_m * exp_neg(height / RAYLEIGH_HEIGHT_M)
                + Vec3::splat(self.mie_per_m * exp_neg(height / MIE_HEIGHT_M));
            sum += passed * scattered * step;
            depth += here * step;
            before = end;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn earth(altitude_deg: f32) -> Atmosphere {
        Atmosphere::new(EARTH_RAYLEIGH, EARTH_MIE, 0.0, frames::math::f32::sin(altitude_deg.to_radians()))
    }

    #[test]
    fn noon_is_blue_above_and_sunset_red_at_the_horizon() {
        let zenith = earth(60.0).radiance(1.0, 1.0);
        assert!(zenith.z > 1.8 * zenith.x, "{zenith}");
        let low_sun = earth(1.0);
        let glow = low_sun.radiance(0.03, 1.0);
        assert!(glow.x > 1.5 * glow.z, "{glow}");
        let sun = low_sun.sun_klx();
        assert!(sun.x > 3.0 * sun.z);
    }

    #[test]
    fn sunlight_at_dusk_is_the_sum_along_its_way() {
        // From 30 km up with the sun 4 degrees below the horizon there: past the ground at some 14 km.
        let air = earth(-4.0);
        // The same 600 km aside, where the ground is 28 km lower.
        for [x, y, z] in [[0.0f32, 0.0, GROUND_M + 30_000.0], [0.0, 600_000.0, GROUND_M + 2_000.0]] {
            let (mut depth, step) = (Vec3::ZERO, 100.0f32);
            for i in 0..15_000 {
                let at = (i as f32 + 0.5) * step;
                let [px, py, pz] = [x + at * air.sun_flat, y, z + at * air.sun_up].map(f64::from);
                let height = (px * px + py * py + pz * pz).sqrt() - f64::from(GROUND_M);
                depth += air.extinction(height as f32) * step;
            }
            let want = passes(depth);
            let got = air.sunlight([x, y, z]);
            assert!((got - want).abs().max_element() < 0.03 && got.x > 0.05, "{got} {want}");
        }
    }

    #[test]
    fn the_sun_sets_little_by_little() {
        let klx: Vec<f32> = (-10..=10).map(|k| earth(k as f32 * 0.05 - 0.14).sun_klx().y).collect();
        assert!(klx[0] == 0.0 && klx[20] > 1.0);
        // In steps of 0.05 degrees.
        assert!(klx.array_windows().all(|[a, b]| a <= b && b - a < 0.2 * klx[20]), "{klx:?}");
    }

    #[test]
    fn what_the_sky_sends_again_is_blue_above_and_white_at_the_horizon() {
        let air = earth(-6.0);
        let [above, level] = [air.again(1.0), air.again(0.01)];
        // Thin air sends its depth's share: 8 km of Rayleigh scattering.
        let depth = RAYLEIGH_PER_M * RAYLEIGH_HEIGHT_M + Vec3::splat(MIE_PER_M * MIE_HEIGHT_M);
        assert!((above - depth).abs().max_element() < 0.2 * depth.z, "{above} {depth}");
        assert!(above.z > 3.0 * above.x && level.min_element() > 0.5, "{above} {level}");
    }

    #[test]
    fn brightness_follows_the_sun() {
        let noon = earth(60.0).sun_klx();
        assert!((70.0..125.0).contains(&noon.y), "{noon}");
        assert_eq!(earth(-3.0).sun_klx(), Vec3::ZERO);
        let at = |deg: f32| earth(deg).radiance(0.5, 0.0).y;
        assert!(at(60.0) > at(10.0) && at(10.0) > at(-3.0) && at(-3.0) > 10.0 * at(-12.0));
    }
}
