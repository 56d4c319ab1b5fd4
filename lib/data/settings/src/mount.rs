//! Where a sensor sits on its agent.

use frames::{Agent, Pose, Sensor, deg};
use serde::Serialize;

/// Where a sensor sits on its agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mount {
    /// Position in the agent's frame (FLU), metres.
    pub xyz_m: [f64; 3],
    /// Roll, pitch (positive nose down), yaw (positive left), radians.
    pub rpy_rad: [f64; 3],
}

impl Mount {
    /// Upright at a position, turned to the left by an angle in degrees.
    #[must_use]
    pub fn upright(xyz_m: [f64; 3], yaw_deg: f64) -> Self {
        Self { xyz_m, rpy_rad: [0.0, 0.0, deg(yaw_deg)] }
    }

    /// The mount as a transform.
    #[must_use]
    pub fn agent_from_sensor(&self) -> Pose<Agent, Sensor> {
        Pose::from_xyz_rpy(self.xyz_m, self.rpy_rad)
    }
}
