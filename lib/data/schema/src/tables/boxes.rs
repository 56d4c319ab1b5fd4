//! Raw boxes of every agent.

use crate::{Attributes, SignalState, framed, table};

table! {
    /// One row per agent, frame and object within the annotation radius: the raw 3-D boxes.
    BoxRow in "boxes" by "simulate-and-log" {
        /// Frame number.
        frame: u32,
        /// Whose list this is.
        agent: String,
        /// Object id.
        id: u16,
        /// Whether it is the agent's own box: what the agent is, not what it sees.
        is_ego: bool,
        /// Detection class.
        class: String,
        /// Model name.
        model: String,
        /// Semantic tags.
        semantic_tags: Vec<u8>,
        /// Eight corners in the world, m, x y z each: 0 to 4 is the length, 0 to 2 the width (0 is left), 0
        /// to 1 the height.
        corners_m: [f64; 24],
        /// Centre of the box in the world, m.
        center_m: [f64; 3],
        /// Length, width, height, m; of walkers those of their pose.
        size_m: [f64; 3],
        /// Roll, pitch, yaw in the world, rad.
        rpy_rad: [f64; 3],
        /// Velocity in the world, m/s.
        velocity_mps: [f32; 3],
        /// Angular velocity in the world, rad/s.
        angular_velocity_radps: [f32; 3],
        /// 3-D distance from the agent's origin to the object's, m: the middle of its footprint, of people
        /// that of the body.
        distance_m: f64,
        /// Angle from the agent's forward axis to the object, rad, positive left; null for the agent itself.
        angle_rad: Option<f64>,
        /// State of a traffic light, else null.
        signal_state: Option<SignalState>,
        /// Whether it is an actor; scenery is none.
        is_alive: bool,
        /// Whether it is an actor that is simulated at this frame.
        is_active: bool,
        /// Whether it is an actor that is not simulated at this frame, as all agents are far away.
        is_dormant: bool,
        /// OpenDRIVE id of its signal or object.
        opendrive_id: Option<String>,
        /// Further facts of the object, as in `log/actors`: see [Attributes](#attributes).
        attributes: Attributes,
    }
}

framed!(BoxRow);
