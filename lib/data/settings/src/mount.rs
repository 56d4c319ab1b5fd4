//! Where a sensor sits on its agent.

use frames::{Agent, Pose, Sensor, deg};

use crate::key::settings;

settings! {
    /// Where a sensor sits on its agent.
    #[derive(Copy)]
    pub struct Mount {
        /// Position on the agent: forward, left, up, m.
        xyz_m: [f64; 3] = [0.0; 3];
        /// Roll, pitch (nose down), yaw (left).
        rpy_rad: [f64; 3] = [0.0; 3], named("rpy_deg"), degrees_each();
    }
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
