//! A network made ready for questions.

mod area;
mod crossings;
mod furniture;
mod graph;
mod junctions;
mod lanes;
mod links;
mod marks;
mod nearest;
mod prepared;
mod route;
mod sampling;
mod sections;
mod signals;
mod spawn;
mod stop_lines;
mod symbols;
mod tree;
mod types;
mod union;

pub use area::{Area, Sidewalk};
pub use crossings::{CrosswalkAxis, CrosswalkSpan};
pub use prepared::Map;
pub use route::Ahead;
pub use spawn::VEHICLE_LANE_WIDTH_M;
pub use stop_lines::{StopLine, StopLineSource};
pub use symbols::RoadSymbol;
pub use types::{
    Crosswalk, GroupController, JunctionInfo, LaneBounds, LaneHit, LaneId, LaneInfo, LanePoint, LanePolyline,
    LanePos, Marking, ObjectInfo, OutlineInfo, SignalGroup, SignalInfo, Stripe, StripeStrip,
};

use crate::model::Network;

impl Map {
    /// Prepares a network: surfaces, lane list, graph, spatial index, markings, signals.
    ///
    /// Lane sections that the network leaves implicit become explicit first: one-sided ones
    /// ([`LaneSection::single_side`](crate::LaneSection::single_side)) get their other side, and a road that
    /// goes on through a virtual junction gets a section boundary where other roads join it.
    #[must_use]
    pub fn new(mut network: Network) -> Self {
        sections::settle(&mut network);
        let mut map = Self::bare(network);
        // Each step uses what the steps before it have filled in.
        map.build_lanes();
        map.graph = links::graph(&map);
        map.inherit_speed_limits();
        map.index = nearest::index(&mut map);
        map.drivable_index = map.index.drivable(&map.lanes);
        map.build_stripes();
        map.build_objects();
        map.build_junctions();
        map.build_signals();
        map
    }
}
