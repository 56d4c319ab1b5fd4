//! The shifted origin that lets geometry near an agent be `f32`.

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use nalgebra::Vector3;

use crate::{Frame, Pose, World};

/// A world point that serves as origin for `f32` geometry. Axes stay the world's.
///
/// Maps reach 20 km; `f32` there resolves 2 mm. Relative to an origin within a kilometre it resolves
/// 0.06 mm.
///
/// ```
/// use frames::LocalOrigin;
///
/// let origin = LocalOrigin::near([1000.4, 2000.0, 30.0]);
/// assert_eq!(origin.world_xyz(), [1000.0, 2000.0, 30.0]);
/// assert_eq!(origin.local_from_world([1001.5, 2000.0, 30.0]).x, 1.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalOrigin {
    world_m: DVec3,
}

impl LocalOrigin {
    /// The whole-metre point nearest to a world position: whole metres subtract exactly.
    #[must_use]
    pub fn near(world_xyz_m: [f64; 3]) -> Self {
        Self { world_m: DVec3::from_array(world_xyz_m).round() }
    }

    /// Where this origin is in the world, metres.
    #[must_use]
    pub fn world_xyz(&self) -> [f64; 3] {
        self.world_m.to_array()
    }

    /// A world point, relative to this origin.
    #[must_use]
    pub fn local_from_world(&self, world_xyz_m: [f64; 3]) -> Vec3 {
        (DVec3::from_array(world_xyz_m) - self.world_m).as_vec3()
    }

    /// A local point, back in the world.
    #[must_use]
    pub fn world_from_local(&self, local_m: Vec3) -> [f64; 3] {
        (self.world_m + local_m.as_dvec3()).to_array()
    }

    /// A body's pose, relative to this origin.
    #[must_use]
    pub fn local_from_body<B: Frame>(&self, world_from_body: &Pose<World, B>) -> Affine3A {
        let [w, x, y, z] = world_from_body.wxyz();
        let rotation = Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32).normalize();
        let t: Vector3<f64> = world_from_body.translation();
        Affine3A {
            matrix3: Mat3A::from_quat(rotation),
            translation: Vec3A::from(self.local_from_world([t.x, t.y, t.z])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Object;

    #[test]
    fn a_millimetre_survives_far_from_the_map_origin() {
        let origin = LocalOrigin::near([19_000.3, -8_000.7, 790.2]);
        let a = origin.local_from_world([19_100.001, -8_000.0, 790.0]);
        let b = origin.local_from_world([19_100.002, -8_000.0, 790.0]);
        assert!(((b - a).x - 0.001).abs() < 1e-5);
    }

    #[test]
    fn bodies_keep_their_heading() {
        let origin = LocalOrigin::near([100.0, 0.0, 0.0]);
        let pose = Pose::<World, Object>::from_xyz_rpy([101.0, 2.0, 0.0], [0.0, 0.0, crate::deg(90.0)]);
        let p = origin.local_from_body(&pose).transform_point3(Vec3::X);
        assert!((p - Vec3::new(1.0, 3.0, 0.0)).length() < 1e-6);
    }
}
