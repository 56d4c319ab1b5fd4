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
        /// Length, width, height of its first box, m; of walkers while they stand.
        size_m: [f64; 3],
        /// First frame in any agent's list.
        first_frame: u32,
        /// Last frame in any agent's list.
        last_frame: u32,
        /// Frames in some agent's list.
        frames: u32,
        /// Frames in which some agent saw it.
        valid_frames: u32,
        /// The first of them; null where nobody ever saw it.
        first_valid_frame: Option<i32>,
        /// The last of them.
        last_valid_frame: Option<i32>,
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
    /// One row per object and agent that had it in its list: when this agent saw it.
    SightingRow in "tracks_agents" by "merge-tracks" {
        /// Object id: the track's id.
        id: u16,
        /// The agent.
        agent: String,
        /// First frame in the agent's list.
        first_frame: u32,
        /// Last frame in the agent's list.
        last_frame: u32,
        /// Frames in the agent's list.
        frames: u32,
        /// First frames of the spans in which the agent saw it without a break.
        seen_from: Vec<u32>,
        /// Last frames of these spans.
        seen_to: Vec<u32>,
        /// Lidar points of the agent.
        num_lidar_pts: u64,
        /// Radar points of the agent.
        num_radar_pts: u64,
        /// Least distance from the agent, m.
        min_distance_m: f64,
    }
}

table! {
    /// One row per object that may move and moment at which it was in some agent's list: where it came from
    /// and where it goes, at the steps of `tracks.step_s`. Columns of places hold x, y, z for each step, the
    /// earliest first; where the object was in no list they hold zeros and the mask 0.
    WindowRow in "tracks_windows" by "merge-tracks" {
        /// Frame number of the present.
        frame: u32,
        /// Object id: the track's id.
        id: u16,
        /// Detection class.
        class: String,
        /// Length, width, height, m; of walkers while they stand.
        size_m: [f64; 3],
        /// Whether any agent saw it at present.
        valid_flag: bool,
        /// Centre of its box at present, world, m.
        center_m: [f64; 3],
        /// Heading at present, world, rad.
        yaw_rad: f64,
        /// Velocity at present, world, m/s.
        velocity_mps: [f32; 3],
        /// Centres in the past, without the present, m.
        past_center_m: Vec<f64>,
        /// Headings in the past, rad.
        past_yaw_rad: Vec<f64>,
        /// Whether it was in a list then, 1 or 0.
        past_mask: Vec<u8>,
        /// Whether some agent saw it then, 1 or 0.
        past_valid: Vec<u8>,
        /// Centres in the future, m.
        future_center_m: Vec<f64>,
        /// Headings in the future, rad.
        future_yaw_rad: Vec<f64>,
        /// Whether it will be in a list then, 1 or 0.
        future_mask: Vec<u8>,
        /// Whether some agent will see it then, 1 or 0.
        future_valid: Vec<u8>,
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

framed!(TrackFrameRow, WindowRow);
