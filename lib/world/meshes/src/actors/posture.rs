//! How an actor's joints are turned.

use crate::people::Bones;
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
    /// Height of the seat that a walker sits on, metres; 0 for a walker who does not sit.
    pub seat_m: f32,
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
            seat_m: state.seat_m,
            door_rad: state.door_rad,
            bones: None,
        }
    }
}
