//! Junctions, as the file states them.

use super::{ConnectionKind, ContactPoint, Element, Geometry, JunctionKind, Orientation, RoadLink};

/// Where roads meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Junction {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// Its kind.
    pub kind: JunctionKind,
    /// Ways through it.
    pub connections: Vec<Connection>,
    /// Controllers of its signals.
    pub controllers: Vec<JunctionController>,
    /// The stretch of the road that goes on through it (virtual junctions).
    pub main_road: Option<VirtualStretch>,
    /// Which road has the right of way over which.
    pub priorities: Vec<Priority>,
    /// Ways for pedestrians and cyclists across it (revision 1.8).
    pub cross_paths: Vec<CrossPath>,
    /// The stretches of road that cross in it (crossings, revision 1.8).
    pub crossing: Vec<CrossingStretch>,
    /// Its edge, counter-clockwise (revision 1.8).
    pub boundary: Vec<BoundarySegment>,
    /// Its own reference line (revision 1.8).
    pub plan_view: Vec<Geometry>,
    /// Heights over its reference line (revision 1.8); read and written, not used by any query.
    pub elevation_grid: Option<ElevationGrid>,
    /// Other elements of it (CRG surface, objects, ...), kept as they are.
    pub kept: Vec<Element>,
}

/// A stretch of road that goes on through a virtual junction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VirtualStretch {
    /// Id of the road.
    pub road: String,
    /// Start, metres along the road.
    pub s_start: f64,
    /// End, metres along the road.
    pub s_end: f64,
    /// Traffic that can turn off or in.
    pub orientation: Orientation,
}

/// The right of way of one road over another; an absent side means all other roads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Priority {
    /// Id of the road that goes first.
    pub high: Option<String>,
    /// Id of the road that waits.
    pub low: Option<String>,
}

/// A way for pedestrians or cyclists across a junction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossPath {
    /// Id as written.
    pub id: String,
    /// Id of the road that is the way.
    pub crossing_road: String,
    /// Where it begins.
    pub start: CrossPathEnd,
    /// Where it ends.
    pub end: CrossPathEnd,
}

/// Where a cross path begins or ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossPathEnd {
    /// Id of the road there.
    pub road: String,
    /// Metres along that road.
    pub s: f64,
    /// Lane of that road.
    pub from: i16,
    /// Lane of the crossing road.
    pub to: i16,
}

/// A stretch of road in a crossing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrossingStretch {
    /// Id as written.
    pub id: String,
    /// Id of the road.
    pub road: String,
    /// Start, metres along the road.
    pub s_start: f64,
    /// End, metres along the road.
    pub s_end: f64,
}

/// A piece of a junction's edge.
#[derive(Clone, Debug, PartialEq)]
pub enum BoundarySegment {
    /// Along the outer border of a lane.
    Lane {
        /// Id of the road.
        road: String,
        /// The lane; 0 is the centre lane.
        lane: i16,
        /// Where it begins.
        from: SegmentEnd,
        /// Where it ends; may lie before its beginning.
        to: SegmentEnd,
    },
    /// Straight across the end of a road.
    Joint {
        /// Id of the road.
        road: String,
        /// Which end.
        contact: ContactPoint,
        /// First lane it crosses; all where absent.
        from_lane: Option<i16>,
        /// Last lane it crosses; all where absent.
        to_lane: Option<i16>,
        /// Length over which heights blend into the elevation grid, metres.
        transition_m: f64,
    },
}

/// An end of a boundary segment along a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SegmentEnd {
    /// The road's start.
    Begin,
    /// The road's end.
    End,
    /// A place on the road, metres.
    At(f64),
}

/// Heights on a square grid over a junction's reference line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElevationGrid {
    /// Place of the first row, metres along the reference line.
    pub s_start: f64,
    /// Metres between rows and between the points of a row.
    pub spacing_m: f64,
    /// Rows, each perpendicular to the reference line.
    pub rows: Vec<GridRow>,
}

/// A row of an elevation grid: heights in metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridRow {
    /// On the reference line.
    pub centre_m: f64,
    /// To the left, outwards.
    pub left_m: Vec<f64>,
    /// To the right, outwards.
    pub right_m: Vec<f64>,
}

/// A controller that belongs to a junction.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JunctionController {
    /// Id of the controller.
    pub id: String,
    /// Type as written.
    pub kind: String,
    /// Place in the junction's cycle, if stated.
    pub sequence: Option<u32>,
}

/// A way from one road into a connecting road (direct junctions: into another ordinary road).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Connection {
    /// Id as written.
    pub id: String,
    /// Road it comes from.
    pub incoming_road: String,
    /// Road it leads into.
    pub connecting_road: String,
    /// End of the connecting road that touches the incoming one.
    pub contact: ContactPoint,
    /// Which lane leads to which.
    pub lane_links: Vec<LaneLink>,
    /// Whether a connecting road exists at all.
    pub kind: ConnectionKind,
    /// Where a connection without connecting road comes from.
    pub predecessor: Option<RoadLink>,
    /// Where a connection without connecting road leads.
    pub successor: Option<RoadLink>,
}

/// A pair of lanes that touch in a junction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneLink {
    /// Lane of the incoming road.
    pub from: i16,
    /// Lane of the connecting road.
    pub to: i16,
    /// Metres over which two lanes of a direct junction share their space, if stated.
    pub overlap_m: Option<f64>,
}

/// Junctions that make one node together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JunctionGroup {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// `roundabout`, `complexJunction`, `highwayInterchange`, `unknown`, as written.
    pub kind: String,
    /// Ids of its junctions.
    pub junctions: Vec<String>,
}
