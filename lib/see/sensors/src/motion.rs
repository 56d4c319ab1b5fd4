//! How agents move.

use frames::{Agent, Pose, World};
use nalgebra::Vector3;
use schema::tables::AgentRow;

/// How an agent moves at one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where it is.
    pub world_from_agent: Pose<World, Agent>,
    /// Velocity in the world, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Angular velocity in the world, rad/s.
    pub angular_velocity_radps: Vector3<f64>,
}

impl Motion {
    /// The motion that a table row tells.
    #[must_use]
    pub fn from_row(row: &AgentRow) -> Self {
        Self {
            world_from_agent: Pose::from_xyz_wxyz(row.xyz_m, row.quaternion),
            velocity_mps: row.velocity_mps.into(),
            angular_velocity_radps: row.angular_velocity_radps.into(),
        }
    }

    /// Velocity of a point of the body, m/s, world.
    pub(crate) fn velocity_at(&self, agent_point_m: Vector3<f64>) -> Vector3<f64> {
        self.velocity_mps + self.angular_velocity_radps.cross(&self.world_from_agent.rotate(agent_point_m))
    }
}
