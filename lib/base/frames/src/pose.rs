//! Rigid transforms that know which frames they connect.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Mul;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// A coordinate frame, as a type.
pub trait Frame: Copy + 'static {
    /// The frame's name in messages.
    const NAME: &'static str;
}

macro_rules! frame {
    ($(#[$doc:meta])* $name:ident, $text:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $name;
        impl Frame for $name {
            const NAME: &'static str = $text;
        }
    };
}

frame!(
    /// The map's inertial frame: x east, y north, z up.
    World, "world"
);
frame!(
    /// A data-collection vehicle or RSU (FLU).
    Agent, "agent"
);
frame!(
    /// A sensor mounted on an agent (FLU).
    Sensor, "sensor"
);
frame!(
    /// A camera's optical frame: x right, y down, z forward.
    Optical, "optical"
);
frame!(
    /// Any object: actor, prop, building (FLU).
    Object, "object"
);

/// A rigid transform `to_from_from`: takes points in frame `From` to frame `To`.
pub struct Pose<To, From> {
    isometry: Isometry3<f64>,
    frames: PhantomData<(To, From)>,
}

impl<To: Frame, From: Frame> Pose<To, From> {
    /// The transform between two frames that coincide.
    #[must_use]
    pub fn identity() -> Self {
        Self::from_isometry(Isometry3::identity())
    }

    /// Wraps an isometry.
    #[must_use]
    pub fn from_isometry(isometry: Isometry3<f64>) -> Self {
        Self { isometry, frames: PhantomData }
    }

    /// From a position in metres and roll, pitch, yaw in radians, composed `Rz(yaw) Ry(pitch) Rx(roll)`.
    /// Positive pitch is nose down, positive yaw counter-clockwise seen from above.
    #[must_use]
    pub fn from_xyz_rpy(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Self {
        let rotation = UnitQuaternion::from_euler_angles(rpy_rad[0], rpy_rad[1], rpy_rad[2]);
        Self::from_isometry(Isometry3::from_parts(Translation3::new(xyz_m[0], xyz_m[1], xyz_m[2]), rotation))
    }

    /// From a position in metres and a quaternion `w, x, y, z` (normalised here).
    #[must_use]
    pub fn from_xyz_wxyz(xyz_m: [f64; 3], wxyz: [f64; 4]) -> Self {
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(wxyz[0], wxyz[1], wxyz[2], wxyz[3]));
        Self::from_isometry(Isometry3::from_parts(Translation3::new(xyz_m[0], xyz_m[1], xyz_m[2]), rotation))
    }

    /// The wrapped isometry.
    #[must_use]
    pub fn isometry(&self) -> &Isometry3<f64> {
        &self.isometry
    }

    /// Origin of `From`, in `To`, metres.
    #[must_use]
    pub fn translation(&self) -> Vector3<f64> {
        self.isometry.translation.vector
    }

    /// Origin of `From`, in `To`, metres, as an array.
    #[must_use]
    pub fn xyz(&self) -> [f64; 3] {
        self.isometry.translation.vector.into()
    }

    /// Rotation as a unit quaternion `w, x, y, z`.
    #[must_use]
    pub fn wxyz(&self) -> [f64; 4] {
        let q = self.isometry.rotation.quaternion();
        [q.w, q.i, q.j, q.k]
    }

    /// Roll, pitch, yaw in radians (the inverse of [`Pose::from_xyz_rpy`]).
    #[must_use]
    pub fn rpy(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.isometry.rotation.euler_angles();
        [roll, pitch, yaw]
    }

    /// Yaw in radians.
    #[must_use]
    pub fn yaw(&self) -> f64 {
        self.rpy()[2]
    }

    /// The `From` frame's x axis (forward, for a body), in `To`.
    #[must_use]
    pub fn forward(&self) -> Vector3<f64> {
        self.isometry.rotation * Vector3::x()
    }

    /// The `From` frame's z axis (up, for a body), in `To`.
    #[must_use]
    pub fn up(&self) -> Vector3<f64> {
        self.isometry.rotation * Vector3::z()
    }

    /// `from_from_to`: the other way round.
    #[must_use]
    pub fn inverse(&self) -> Pose<From, To> {
        Pose::from_isometry(self.isometry.inverse())
    }

    /// Rotates a direction, without moving it.
    #[must_use]
    pub fn rotate(&self, v: Vector3<f64>) -> Vector3<f64> {
        self.isometry.rotation * v
    }
}

impl<A: Frame, B: Frame, C: Frame> Mul<Pose<B, C>> for Pose<A, B> {
    type Output = Pose<A, C>;
    fn mul(self, right: Pose<B, C>) -> Pose<A, C> {
        Pose::from_isometry(self.isometry * right.isometry)
    }
}

impl<To: Frame, From: Frame> Mul<Point3<f64>> for Pose<To, From> {
    type Output = Point3<f64>;
    fn mul(self, point_in_from: Point3<f64>) -> Point3<f64> {
        self.isometry * point_in_from
    }
}

impl<To, From> Clone for Pose<To, From> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<To, From> Copy for Pose<To, From> {}

impl<To, From> PartialEq for Pose<To, From> {
    fn eq(&self, other: &Self) -> bool {
        self.isometry == other.isometry
    }
}

impl<To: Frame, From: Frame> fmt::Debug for Pose<To, From> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}_from_{} {:?} {:?}", To::NAME, From::NAME, self.xyz(), self.wxyz())
    }
}

/// The fixed rotation from a camera's optical frame to the FLU frame of its mount: the one place where
/// the two conventions meet. Quaternion `0.5, -0.5, 0.5, -0.5`.
#[must_use]
pub fn flu_from_optical() -> Pose<Sensor, Optical> {
    Pose::from_xyz_wxyz([0.0; 3], [0.5, -0.5, 0.5, -0.5])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn optical_axes_map_to_flu() {
        let flu = flu_from_optical();
        let near = |v: Vector3<f64>, w: Vector3<f64>| assert!((v - w).norm() < 1e-12, "{v} {w}");
        near(flu.rotate(Vector3::z()), Vector3::x());
        near(flu.rotate(Vector3::x()), -Vector3::y());
        near(flu.rotate(Vector3::y()), -Vector3::z());
    }

    #[test]
    fn positive_pitch_is_nose_down() {
        let pose = Pose::<World, Agent>::from_xyz_rpy([0.0; 3], [0.0, 0.1, 0.0]);
        assert!(pose.forward().z < 0.0);
    }

    proptest! {
        #[test]
        fn inverse_undoes(x in -1e4..1e4f64, y in -1e4..1e4f64, z in -800.0..800.0f64,
                          roll in -3.0..3.0f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64) {
            let pose = Pose::<World, Agent>::from_xyz_rpy([x, y, z], [roll, pitch, yaw]);
            let point = Point3::new(3.0, -2.0, 1.0);
            let back = pose.inverse() * (pose * point);
            prop_assert!((back - point).norm() < 1e-9);
            let rpy = pose.rpy();
            for (got, want) in rpy.iter().zip([roll, pitch, yaw]) {
                prop_assert!((got - want).abs() < 1e-9);
            }
        }

        #[test]
        fn wrap_is_in_range_and_congruent(angle in -50.0..50.0f64) {
            let w = crate::wrap_pi(angle);
            prop_assert!(w > -std::f64::consts::PI && w <= std::f64::consts::PI);
            let turns = (angle - w) / std::f64::consts::TAU;
            prop_assert!((turns - turns.round()).abs() < 1e-9);
        }
    }
}
