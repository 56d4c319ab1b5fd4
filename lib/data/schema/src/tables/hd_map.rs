//! Where on the map every agent is.

use crate::{framed, table};

table! {
    /// One row per agent and frame: the lane the agent is in (an RSU: the nearest driving lane).
    HdMapRow in "hd_map" by "simulate-and-log" {
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
        /// OpenDRIVE id of the next junction ahead (inside a junction the one after it); null when there is
        /// none within 500 m of way. Ways follow the lane graph without lane changes; of all branches the
        /// shortest counts.
        next_junction_id: Option<String>,
        /// Way along the lanes from the point above to where that junction begins, m.
        next_junction_m: Option<f64>,
        /// OpenDRIVE ids of the lights and stop signs that hold traffic at the next stop line ahead; empty
        /// when there is none within 500 m.
        signal_ids: Vec<String>,
        /// Way to that stop line, m.
        stop_line_m: Option<f64>,
        /// OpenDRIVE id of the next crosswalk ahead; null when there is none within 500 m.
        crosswalk_id: Option<String>,
        /// Way to it, m; 0 on it.
        crosswalk_m: Option<f64>,
        /// Distance from the agent's origin to the nearest sidewalk, m; 0 on it, null when there is none
        /// within 50 m.
        sidewalk_m: Option<f64>,
    }
}

framed!(HdMapRow);
