//! Routes that the user gave.

use crate::{AgentId, table};

table! {
    /// One row per place that a data-collection vehicle is to pass on its given route, in order; there is
    /// none without `agents.routes`.
    PlanRouteRow in "plan/routes" by "spawn-planner" {
        /// Scene number.
        scene: u32,
        /// Whose route it is.
        agent: AgentId,
        /// Number of the place on the route, from 0, where the vehicle starts.
        number: u32,
        /// OpenDRIVE id of its road.
        road: String,
        /// OpenDRIVE id of its lane.
        lane: i32,
        /// Road coordinate s, m.
        s_m: f64,
        /// The place on the centre line of the lane, m.
        xyz_m: [f64; 3],
    }
}
