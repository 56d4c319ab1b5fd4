//! How an actor's joints are turned.

use frames::math::f32::sin_cos;
use glam::{Mat3A, Vec3A};
use people::Bones;
use schema::tables::StateRow;

/// How an actor's joints are turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture {
    /// Steering angle of the front wheels, radians, positive left.
    pub steer_rad: f32,
    /// Rotation of the wheels; of walkers the gait phase, radians.
    pub phase_rad: f32,
    /// The speed that walkers stride at, m/s.
    pub gait_mps: f32,
    /// How far the doors stand open, radians.
    pub door_rad: [f32; 4],
    /// Where the bones are: [`ActorMesh::posed`] says it of actors that have some.
    pub bones: Option<Bones>,
}

impl From<&StateRow> for Posture {
    fn from(state: &StateRow) -> Self {
        Self {
            steer_rad: state.steer_rad,
            phase_rad: state.phase_rad,
            gait_mps: state.gait_mps,
            door_rad: state.door_rad,
            bones: None,
        }
    }
}

pub(crate) fn about_y(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, 0.0, -s), Vec3A::Y, Vec3A::new(s, 0.0, c))
}

pub(crate) fn about_z(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, s, 0.0), Vec3A::new(-s, c, 0.0), Vec3A::Z)
}
