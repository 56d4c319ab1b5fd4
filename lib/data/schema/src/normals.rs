//! Directions in few bytes.

use glam::{Vec2, Vec3};

/// A unit vector in four bytes: an octahedron unfolded to a square (Meyer et al., "On Floating-Point Normal
/// Vectors", EGSR 2010). Off by at most 0.01 degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Normal([i16; 2]);

const STEPS: f32 = 32_767.0;

/// The lower half of the octahedron turned outward, and back.
fn folded(v: Vec2) -> Vec2 {
    (Vec2::ONE - Vec2::new(v.y, v.x).abs()) * Vec2::ONE.copysign(v)
}

impl Normal {
    /// Of a vector of any length; of none at all z.
    #[must_use]
    pub fn new(v: Vec3) -> Self {
        let sum = v.x.abs() + v.y.abs() + v.z.abs();
        if !(sum > 0.0 && sum.is_finite()) {
            return Self::default();
        }
        let flat = v.truncate() / sum;
        let flat = if v.z < 0.0 { folded(flat) } else { flat };
        Self((flat * STEPS).round().to_array().map(|c| c as i16))
    }

    /// The vector.
    #[must_use]
    #[inline]
    pub fn get(self) -> Vec3 {
        let flat = Vec2::new(f32::from(self.0[0]), f32::from(self.0[1])) / STEPS;
        let z = 1.0 - flat.x.abs() - flat.y.abs();
        let flat = if z < 0.0 { folded(flat) } else { flat };
        flat.extend(z).normalize_or(Vec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use frames::math;

    use super::*;

    #[test]
    fn four_bytes_hold_a_direction() {
        let mut worst = 0.0_f32;
        for i in 0..40 {
            for j in 0..80 {
                let (polar, turn) = (f64::from(i) * 0.079, f64::from(j) * 0.0787);
                let (s, c) = math::sin_cos(polar);
                let (y, x) = math::sin_cos(turn);
                let v = Vec3::new((s * x) as f32, (s * y) as f32, c as f32);
                worst = worst.max((Normal::new(v * 7.0).get() - v).length());
            }
        }
        // Half a step along either axis, stretched where the octahedron is flattest.
        assert!(worst < 1e-4, "{worst}");
        assert_eq!(Normal::new(Vec3::ZERO).get(), Vec3::Z);
        assert_eq!(Normal::new(-Vec3::Z).get(), -Vec3::Z);
    }
}
