//! Retro-reflecting sheeting: how much light it sends back to where it came from.

use simd::{F32x8, Vec3x8};

/// Light that comes in within this angle of straight on is sent back in full (cosine of 30 degrees), and none
/// beyond the other (of 75).
///
/// Sheeting of class RA2 of EN 12899-1 has 180, 100 and 95 cd/(lx m2) at 5, 30 and 40 degrees, and what a
/// lidar reads of it is beyond white at any of these. The even way down from there is an assumption.
const FULL_COS: f32 = 0.866_025_4;
/// See [`FULL_COS`].
const NONE_COS: f32 = 0.258_819_05;

/// Share of the light that sheeting still sends back when it is met at an angle of this cosine.
pub fn share(cos_angle: f32) -> f32 {
    ((cos_angle - NONE_COS) / (FULL_COS - NONE_COS)).clamp(0.0, 1.0)
}

/// Retro-reflection where lamp and eye are in one place, cd/(lx m2), and the angle between them at which a
/// half is left, radians: a curve through EN 12899-1's 250, 180 and 5 of white RA2 sheeting at 0.2, 0.33 and
/// 2 degrees.
const AT_THE_LAMP: f32 = 280.0;
/// See [`AT_THE_LAMP`].
const HALF_RAD: f32 = 0.4 * std::f32::consts::PI / 180.0;

/// How much brighter than white paint sheeting shows a lamp's light to an eye: by unit vectors from it to
/// both, and the cosine of the angle between its normal and the lamp.
#[inline]
pub fn gain(to_lamp: &Vec3x8, to_eye: &Vec3x8, cos_angle: F32x8) -> F32x8 {
    let apart = *to_lamp - *to_eye;
    let apart = (apart.length_squared() * (1.0 / (HALF_RAD * HALF_RAD))).sqrt();
    // Luminance per illuminance; that of white paint is 1 / pi.
    let returned = AT_THE_LAMP * std::f32::consts::PI / (apart * apart * apart.sqrt() + 1.0);
    let share = (cos_angle - NONE_COS) * (1.0 / (FULL_COS - NONE_COS));
    returned * share.fast_clamp(F32x8::ZERO, F32x8::ONE) + 1.0
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn sheeting_is_as_bright_as_its_standard_has_it() {
        let cos = |deg: f64| frames::math::cos(frames::deg(deg)) as f32;
        assert_eq!(share(1.0), 1.0);
        assert!(share(cos(29.9)) == 1.0 && share(cos(30.1)) < 1.0);
        assert!((share(0.5 * (FULL_COS + NONE_COS)) - 0.5).abs() < 1e-6);
        assert_eq!(share(cos(75.1)), 0.0);
        // 0.2, 0.33 and 2 degrees between lamp and eye: 250, 180 and 5 cd/(lx m2), within a tenth.
        for (apart_deg, want) in [(0.2, 250.0), (0.33, 180.0), (2.0, 5.0)] {
            let (sin, cos) = frames::math::sin_cos(frames::deg(apart_deg));
            let eye = Vec3x8::splat(Vec3::new(cos as f32, sin as f32, 0.0));
            let got = gain(&Vec3x8::splat(Vec3::X), &eye, F32x8::ONE).to_array()[0];
            let got = (got - 1.0) / std::f32::consts::PI;
            assert!((got / want - 1.0).abs() < 0.1, "{apart_deg}: {got}, not {want}");
        }
        // From the side it is white paint.
        let aside = gain(&Vec3x8::splat(Vec3::X), &Vec3x8::splat(Vec3::X), F32x8::splat(0.1));
        assert_eq!(aside.to_array()[0], 1.0);
    }
}
