//! What sensors saw of each box.

use crate::{framed, table};

table! {
    /// One row per row of `boxes`, in the same order: what the agent's sensors saw of it.
    ValidBoxRow in "boxes_valid" by "postprocess-valid" {
        /// Frame number.
        frame: u32,
        /// Whose list this is.
        agent: String,
        /// Object id.
        id: u16,
        /// Whether it is the agent's own box, as in `boxes`.
        is_ego: bool,
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
        /// Pixels of the object's parts with one of the box's `semantic_tags`, in the agent's instance
        /// images.
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

framed!(ValidBoxRow);
