//! Normals that run over a triangle of a curved surface.

use glam::{Mat3, Vec3};
use simd::{F32x8, Vec3x8};

/// The normal along a triangle: linear in the triangle's plane between the normals of its corners, on the
/// camera's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// First corner, object frame.
    corner: Vec3,
    /// Shares of the second and third corner along vectors of the plane from the first one, object frame.
    shares: [Vec3; 2],
    /// Normals of the corners, local frame.
    normals_local: [Vec3; 3],
}

impl Bend {
    /// Of the corners of a triangle and its normals there, both in the object frame; `None` for a triangle
    /// without area. The sign of `side` is -1 where the camera sees the triangle's back.
    pub(crate) fn new(corners: [Vec3; 3], normals: [Vec3; 3], to_local: &Mat3, side: f32) -> Option<Self> {
        let [corner, second, third] = corners;
        let (along, across) = (second - corner, third - corner);
        let normal = along.cross(across);
        let square = normal.length_squared();
        // The basis that is dual to both edges: each is 1 along its own edge, 0 along the other.
        let shares = [across.cross(normal) / square, normal.cross(along) / square];
        let is_usable = shares.iter().all(|share| share.is_finite());
        is_usable.then(|| Self { corner, shares, normals_local: normals.map(|n| *to_local * (n * side)) })
    }

    /// Unit normals at points of the triangle (object frame, metres), local frame.
    #[inline]
    #[must_use]
    pub fn normals(&self, position_object: Vec3x8) -> Vec3x8 {
        let from_corner = position_object - Vec3x8::splat(self.corner);
        let [u, v] = self.shares.map(|share| from_corner.dot(Vec3x8::splat(share)));
        let [a, b, c] = self.normals_local;
        let along = |a: f32, b: f32, c: f32| u * (b - a) + v * (c - a) + a;
        let n = Vec3x8::new(along(a.x, b.x, c.x), along(a.y, b.y, c.y), along(a.z, b.z, c.z));
        n * (1.0 / n.length_squared().fast_max(F32x8::splat(1e-12)).sqrt())
    }

    /// The normals of the corners, local frame.
    #[must_use]
    pub fn corner_normals(&self) -> [Vec3; 3] {
        self.normals_local
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_those_of_the_corners_and_run_between_them() {
        let corners = [Vec3::new(1.0, 0.5, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(1.5, 2.0, 1.0)];
        let normals = [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
        let turn = Mat3::from_rotation_z(0.7);
        let bend = Bend::new(corners, normals, &turn, 1.0).expect("has an area");
        let place = |i: usize| match i {
            0..3 => corners[i],
            3 => 0.5 * (corners[1] + corners[2]),
            _ => (corners[0] + corners[1] + corners[2]) / 3.0,
        };
        let points = Vec3x8::from_fn(place);
        let got = bend.normals(points);
        for (i, normal) in normals.into_iter().enumerate() {
            assert!((got.lane(i) - turn * normal).length() < 1e-5, "corner {i}: {}", got.lane(i));
        }
        let middle = (turn * (normals[1] + normals[2])).normalize();
        assert!((got.lane(3) - middle).length() < 1e-5);
        assert!((got.lane(4) - (turn * (normals[0] + normals[1] + normals[2])).normalize()).length() < 1e-5);
        let back = Bend::new(corners, normals, &turn, -1.0).expect("has an area");
        assert!((back.normals(points).lane(0) + turn * normals[0]).length() < 1e-5);
        assert!(Bend::new([corners[0]; 3], normals, &turn, 1.0).is_none());
    }
}
