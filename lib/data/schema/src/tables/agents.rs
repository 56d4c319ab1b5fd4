//! Agents, frame by frame.

use crate::{framed, table};

table! {
    /// One row per agent and frame: where it is.
    AgentRow in "agents" by "simulate-and-log" {
        /// Frame number.
        frame: u32,
        /// Time since frame 0, s.
        time_s: f64,
        /// `vehicle_0`, `rsu_1`, ...
        agent: String,
        /// Its object id in the log and in all images.
        id: u16,
        /// Position of the agent's origin in the world, m.
        xyz_m: [f64; 3],
        /// Orientation in the world: quaternion w, x, y, z.
        quaternion: [f64; 4],
        /// Velocity in the world, m/s.
        velocity_mps: [f64; 3],
        /// Angular velocity in the world, rad/s.
        angular_velocity_radps: [f64; 3],
    }
}

framed!(AgentRow);
