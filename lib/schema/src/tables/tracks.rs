//! Objects over all agents.

use crate::{Attributes, SignalState, framed, table};

table! {
    /// One row per object of a scene that some agent had in its list: its track.
    TrackRow in "tracks" by "merge-tracks" {
        /// Object id: the track's id.
        id: u16,
        /// Detection class.
        class: String,
        /// Model name.
        model: String,
        /// First frame in any agent's list.
        first_frame: u32,
        /// Last frame in any agent's list.
        last_frame: u32,
        /// Frames in some agent's list.
        frames: u32,
        /// Frames in which some agent saw it.
        valid_frames: u32,
        /// Lidar points over all agents and frames.
        num_lidar_pts: u64,
        /// Radar points over all agents and frames.
        num_radar_pts: u64,
        /// Way covered while in a list, m.
        path_m: f64,
        /// Greatest speed, m/s.
        max_speed_mps: f64,
        /// Agents that saw it in some frame.
        seen_by: Vec<String>,
    }
}

table! {
    /// One row per frame and object in some agent's list: the merged boxes.
    TrackFrameRow in "tracks_frames" by "merge-tracks" {
        /// Frame number.
        frame: u32,
        /// Object id: the track's id.
        id: u16,
        /// Detection class.
        class: String,
        /// Semantic tags.
        semantic_tags: Vec<u8>,
        /// Box in the world as eight corners, m, as in `boxes`.
        corners_m: [f64; 24],
        /// Centre in the world, m.
        center_m: [f64; 3],
        /// Length, width, height, m.
        size_m: [f64; 3],
        /// Roll, pitch, yaw in the world, rad.
        rpy_rad: [f64; 3],
        /// Velocity in the world, m/s.
        velocity_mps: [f32; 3],
        /// Angular velocity in the world, rad/s.
        angular_velocity_radps: [f32; 3],
        /// Lidar points of all agents.
        num_lidar_pts: u32,
        /// Radar points of all agents.
        num_radar_pts: u32,
        /// Whether any agent saw it.
        valid_flag: bool,
        /// Difficulty by points alone.
        difficulty: String,
        /// Agents that saw it.
        seen_by: Vec<String>,
        /// State of a traffic light, else null.
        signal_state: Option<SignalState>,
        /// Further facts of the object as JSON, as in `log/actors`.
        attributes: Attributes,
    }
}

framed!(TrackFrameRow);
