//! A share that runs evenly over a triangle.

use glam::Vec3;
use simd::{F32x8, Vec3x8};

/// A number along a triangle, linear in its plane between those of its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerGradient {
    corner: Vec3,
    first: f32,
    slope: Vec3,
}

impl CornerGradient {
    /// Of the corners of a triangle (object frame) and the numbers there; their mean where it has no area.
    pub(crate) fn new([corner, second, third]: [Vec3; 3], [a, b, c]: [f32; 3]) -> Self {
        let (along, across) = (second - corner, third - corner);
        let normal = along.cross(across);
        let slope =
            (across.cross(normal) * (b - a) + normal.cross(along) * (c - a)) / normal.length_squared();
        if slope.is_finite() {
            Self { corner, first: a, slope }
        } else {
            Self { corner, first: (a + b + c) / 3.0, slope: Vec3::ZERO }
        }
    }

    /// The shares at points of the triangle (object frame, metres), 0 to 1.
    #[inline]
    pub(crate) fn at(&self, position_object: &Vec3x8) -> F32x8 {
        let along = (*position_object - Vec3x8::splat(self.corner)).dot(Vec3x8::splat(self.slope));
        (along + self.first).fast_clamp(F32x8::ZERO, F32x8::ONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_what_its_corners_say_and_runs_evenly_between() {
        let corners = [Vec3::new(1.0, 0.5, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(1.5, 2.0, 1.0)];
        let ramp = CornerGradient::new(corners, [0.2, 0.9, 0.5]);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let at = |i: usize| {
            corners.get(i).copied().unwrap_or(if i == 3 { middle } else { corners[1] * 2.0 - corners[0] })
        };
        let got = ramp.at(&Vec3x8::from_fn(at)).to_array();
        for (got, want) in got.into_iter().zip([0.2, 0.9, 0.5, 1.6 / 3.0, 1.0]) {
            assert!((got - want).abs() < 1e-5, "{got} {want}");
        }
        let none = CornerGradient::new([corners[0]; 3], [0.2, 0.9, 0.4]);
        assert!((none.at(&Vec3x8::splat(middle)).to_array()[0] - 0.5).abs() < 1e-6);
    }
}
