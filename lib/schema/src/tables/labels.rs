//! Annotations: agents, boxes, HD map, tracks.

use crate::table;

table! {
    /// One row per agent and frame: where it is.
    AgentRow in "agents" {
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

table! {
    /// One row per agent, frame and object within the annotation radius: the raw 3-D boxes.
    BoxRow in "boxes" {
        /// Frame number.
        frame: u32,
        /// Whose list this is.
        agent: String,
        /// Object id.
        id: u16,
        /// Detection class.
        class: String,
        /// Model name.
        model: String,
        /// Semantic tags.
        semantic_tags: Vec<u8>,
        /// Eight corners in the world, m, x y z each: 0 to 4 is the length, 0 to 2 the width (0 is left), 0 to 1 the height.
        corners_m: [f64; 24],
        /// Centre of the box in the world, m.
        center_m: [f64; 3],
        /// Length, width, height, m.
        size_m: [f64; 3],
        /// Roll, pitch, yaw in the world, rad.
        rpy_rad: [f64; 3],
        /// Velocity in the world, m/s.
        velocity_mps: [f32; 3],
        /// Angular velocity in the world, rad/s.
        angular_velocity_radps: [f32; 3],
        /// 3-D distance from the agent's origin to the object's origin, m.
        distance_m: f64,
        /// Angle from the agent's forward axis to the object, rad, positive left; null for the agent itself.
        angle_rad: Option<f64>,
        /// State of a traffic light, else null.
        signal_state: Option<String>,
        /// Further facts of the object as JSON, as in `log/actors`.
        attributes: String,
    }
}

table! {
    /// One row per agent and frame: the lane the agent is in (an RSU: the nearest driving lane).
    HdMapRow in "hd_map" {
        /// Frame number.
        frame: u32,
        /// Whose record this is.
        agent: String,
        /// Number of the lane in `maps/NAME.vector.parquet`.
        lane: u32,
        /// OpenDRIVE road id.
        road_id: String,
        /// Number of the lane section in its road, from 0.
        section_id: u32,
        /// OpenDRIVE lane id (negative right of the reference line).
        lane_id: i32,
        /// Road coordinate along the reference line, m.
        s_m: f64,
        /// Lane type.
        lane_type: String,
        /// Lane width, m.
        lane_width_m: f64,
        /// Lane changes the marks allow: `NONE`, `Left`, `Right`, `Both`.
        lane_change: String,
        /// Whether the road lies in a junction.
        is_junction: bool,
        /// OpenDRIVE junction id.
        junction_id: Option<String>,
        /// Speed limit, m/s.
        speed_limit_mps: Option<f64>,
        /// Point on the lane's centre nearest to the agent, in the world, m.
        xyz_m: [f64; 3],
        /// Lane orientation there: roll, pitch, yaw, rad, in travel direction.
        rpy_rad: [f64; 3],
        /// Type of the mark left of the lane in travel direction.
        left_marking_type: String,
        /// Its width, m.
        left_marking_width_m: f64,
        /// Its colour.
        left_marking_color: String,
        /// Lane changes it allows.
        left_marking_lane_change: String,
        /// Type of the mark right of the lane in travel direction.
        right_marking_type: String,
        /// Its width, m.
        right_marking_width_m: f64,
        /// Its colour.
        right_marking_color: String,
        /// Lane changes it allows.
        right_marking_lane_change: String,
        /// Lane id of the left neighbour, of any type; null when there is none.
        left_lane_id: Option<i32>,
        /// Its type.
        left_lane_type: Option<String>,
        /// Its width, m.
        left_lane_width_m: Option<f64>,
        /// Lane changes its marks allow.
        left_lane_change: Option<String>,
        /// Lane id of the right neighbour, of any type; null when there is none.
        right_lane_id: Option<i32>,
        /// Its type.
        right_lane_type: Option<String>,
        /// Its width, m.
        right_lane_width_m: Option<f64>,
        /// Lane changes its marks allow.
        right_lane_change: Option<String>,
        /// Offset of the agent's origin from the lane's centre, m, positive left in travel direction.
        lane_offset_m: f64,
        /// OpenDRIVE id of the next junction ahead (inside a junction the one after it); null when there is none within 500 m of way. Ways follow the lane graph without lane changes; of all branches the shortest counts.
        next_junction_id: Option<String>,
        /// Way along the lanes from the point above to where that junction begins, m.
        next_junction_m: Option<f64>,
        /// OpenDRIVE ids of the lights and stop signs that hold traffic at the next stop line ahead; empty when there is none within 500 m.
        signal_ids: Vec<String>,
        /// Way to that stop line, m.
        stop_line_m: Option<f64>,
        /// OpenDRIVE id of the next crosswalk ahead; null when there is none within 500 m.
        crosswalk_id: Option<String>,
        /// Way to it, m; 0 on it.
        crosswalk_m: Option<f64>,
        /// Distance from the agent's origin to the nearest sidewalk, m; 0 on it, null when there is none within 50 m.
        sidewalk_m: Option<f64>,
    }
}

table! {
    /// One row per row of `boxes`, in the same order: what the agent's sensors saw of it.
    ValidBoxRow in "boxes_valid" {
        /// Frame number.
        frame: u32,
        /// Whose list this is.
        agent: String,
        /// Object id.
        id: u16,
        /// Detection class.
        class: String,
        /// Lidar points inside the box.
        num_lidar_pts: u32,
        /// Radar points inside the box.
        num_radar_pts: u32,
        /// Whether the agent saw it: by a point, or in an instance image.
        valid_flag: bool,
        /// `easy`, `medium` or `hard`.
        difficulty: String,
        /// Pixels of the object's parts with one of the box's `semantic_tags`, in the agent's instance images.
        num_pixels: u32,
        /// Box in the world as eight corners, m, as in `boxes`.
        corners_m: [f64; 24],
        /// Velocity in the world, m/s.
        velocity_mps: [f32; 3],
        /// Distance from the agent, m.
        distance_m: f64,
        /// Angle from the agent's forward axis, rad, positive left; null for the agent itself.
        angle_rad: Option<f64>,
    }
}

table! {
    /// One row per object of a scene that some agent had in its list: its track.
    TrackRow in "tracks" {
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
    TrackFrameRow in "tracks_frames" {
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
        signal_state: Option<String>,
        /// Further facts of the object as JSON, as in `log/actors`.
        attributes: String,
    }
}
