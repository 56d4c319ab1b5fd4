//! Oriented boxes with the dataset's corner order.

use nalgebra::{Point3, Vector3};

use crate::{Object, Pose, World};

/// Signs of the corners along the object's own x (forward), y (left), z (up), in the dataset's order:
/// 0 to 4 is the length, 0 to 2 the width, 0 to 1 the height; even corners are at the bottom.
pub const CORNER_SIGNS: [[f64; 3]; 8] = [
    [-1.0, 1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, -1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0],
    [1.0, -1.0, 1.0],
];

/// Corners that go once around the footprint.
pub const FOOTPRINT_LOOP: [usize; 4] = [0, 2, 6, 4];

/// A box with any orientation, in the world.
///
/// ```
/// use frames::{OrientedBox, Pose};
/// use nalgebra::Point3;
///
/// // A car at the origin that looks north.
/// let at = Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, frames::deg(90.0)]);
/// let car = OrientedBox::standing(at, 4.6, 1.8, 1.4);
/// assert!(car.contains(Point3::new(0.5, 2.0, 0.7)) && !car.contains(Point3::new(2.0, 0.5, 0.7)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Takes box coordinates (origin at the box's centre, FLU) to the world.
    pub world_from_box: Pose<World, Object>,
    /// Half length, half width, half height, metres.
    pub half_m: Vector3<f64>,
}

impl OrientedBox {
    /// The box of an object whose origin is at the centre of its footprint.
    #[must_use]
    pub fn standing(
        world_from_object: Pose<World, Object>,
        length_m: f64,
        width_m: f64,
        height_m: f64,
    ) -> Self {
        let up = Pose::<Object, Object>::from_xyz_rpy([0.0, 0.0, 0.5 * height_m], [0.0; 3]);
        Self {
            world_from_box: world_from_object * up,
            half_m: 0.5 * Vector3::new(length_m, width_m, height_m),
        }
    }

    /// The eight corners in the world, in [`CORNER_SIGNS`] order.
    #[must_use]
    pub fn corners(&self) -> [Point3<f64>; 8] {
        CORNER_SIGNS.map(|s| {
            self.world_from_box
                * Point3::new(s[0] * self.half_m.x, s[1] * self.half_m.y, s[2] * self.half_m.z)
        })
    }

    /// Centre in the world.
    #[must_use]
    pub fn centre(&self) -> Point3<f64> {
        Point3::from(self.world_from_box.translation())
    }

    /// Whether a world point lies inside or on the box.
    #[must_use]
    pub fn contains(&self, point_in_world: Point3<f64>) -> bool {
        let p = self.world_from_box.inverse() * point_in_world;
        p.x.abs() <= self.half_m.x && p.y.abs() <= self.half_m.y && p.z.abs() <= self.half_m.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn corner_edges_have_the_right_lengths_and_sides() {
        let at = Pose::from_xyz_rpy([5.0, 6.0, 0.0], [0.0, 0.0, 0.0]);
        let c = OrientedBox::standing(at, 4.0, 2.0, 1.5).corners();
        assert_eq!(c[0], Point3::new(3.0, 7.0, 0.0)); // rear left bottom
        assert!(((c[4] - c[0]).norm() - 4.0).abs() < 1e-12);
        assert!(((c[2] - c[0]).norm() - 2.0).abs() < 1e-12);
        assert!(((c[1] - c[0]).norm() - 1.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn a_box_holds_its_shrunken_corners(yaw in -3.0..3.0f64, pitch in -0.5..0.5f64, l in 0.1..20.0f64) {
            let at = Pose::from_xyz_rpy([-50.0, 20.0, 3.0], [0.1, pitch, yaw]);
            let b = OrientedBox::standing(at, l, 2.0, 1.5);
            let centre = b.centre();
            for corner in b.corners() {
                prop_assert!(b.contains(centre + (corner - centre) * 0.999));
                prop_assert!(!b.contains(centre + (corner - centre) * 1.001));
            }
        }
    }
}
