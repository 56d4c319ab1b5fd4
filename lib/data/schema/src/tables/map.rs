//! The vector map: a road network as lines and polygons.

use crate::table;

/// Kinds of a vector map's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VectorKind {
    /// A lane, as its centre line in the direction of travel.
    LaneCentreline,
    /// The border between two lanes, or of a lane and what is no lane, painted or not.
    LaneBoundary,
    /// A traffic light or sign, as a point.
    Signal,
    /// A painted line along the road.
    Divider,
    /// A kerb that the map states as a marking.
    Kerb,
    /// A pedestrian crossing.
    Crosswalk,
    /// A line at which traffic must stop.
    StopLine,
    /// A walk for pedestrians.
    Sidewalk,
    /// The paved ground of a junction.
    Junction,
}

impl VectorKind {
    /// Every kind, in the order of the rows.
    pub const ALL: [Self; 9] = [
        Self::LaneCentreline,
        Self::LaneBoundary,
        Self::Signal,
        Self::Divider,
        Self::Kerb,
        Self::Crosswalk,
        Self::StopLine,
        Self::Sidewalk,
        Self::Junction,
    ];

    /// Its name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LaneCentreline => "lane_centreline",
            Self::LaneBoundary => "lane_boundary",
            Self::Signal => "signal",
            Self::Divider => "divider",
            Self::Kerb => "kerb",
            Self::Crosswalk => "crosswalk",
            Self::StopLine => "stop_line",
            Self::Sidewalk => "sidewalk",
            Self::Junction => "junction",
        }
    }
}

table! {
    /// One row per element of a map: lines and polygons in the world, with the lane graph. Chords stay within
    /// 2 cm of the true curves.
    VectorMapRow in "maps/NAME.vector" by "spawn-planner" {
        /// Number of the element: its row, from 0. Lanes come first: `hd_map.lane` is a lane's number here.
        id: u32,
        /// `lane_centreline`, `lane_boundary`, `signal` (a point), `divider` (a painted line), `kerb`,
        /// `crosswalk`, `stop_line`, `sidewalk`, `junction`; polygons are the crosswalks, sidewalks and
        /// junctions.
        kind: String,
        /// World x of its points, m. Lanes run in the direction of travel, boundaries, dividers and kerbs
        /// with the road's s, stop lines from left to right seen by the held traffic.
        x_m: Vec<f64>,
        /// World y of its points, m.
        y_m: Vec<f64>,
        /// World z of its points, m: the road's surface, kerb heights left out (signals: their origin).
        z_m: Vec<f64>,
        /// Polygons: index of each ring's first point. The first ring is the outline, counter-clockwise,
        /// others are holes, clockwise; each ring repeats its first point at its end. Lines and points:
        /// empty.
        rings: Vec<u32>,
        /// OpenDRIVE id of its road.
        road_id: Option<String>,
        /// Number of its lane section in the road, from 0.
        section_id: Option<i32>,
        /// OpenDRIVE lane id; of boundaries, dividers and kerbs the lane whose outer border it lies on (0:
        /// the centre line).
        lane_id: Option<i32>,
        /// OpenDRIVE id of the crosswalk, stop line, junction or signal itself.
        opendrive_id: Option<String>,
        /// Lanes, boundaries, dividers, kerbs: road coordinate s of each point, m.
        s_m: Vec<f64>,
        /// Lanes: type, as in `hd_map`.
        lane_type: Option<String>,
        /// Lanes: direction of travel relative to the road's s: `forward`, `backward`, or `both` (then points
        /// run in the direction its side suggests).
        travel: Option<String>,
        /// Lanes: mean width, m. Dividers, kerbs, stop lines: width of the line, m.
        width_m: Option<f64>,
        /// Lanes: speed limit at the middle, m/s.
        speed_limit_mps: Option<f64>,
        /// Whether it belongs to a connecting road of a junction.
        is_junction: bool,
        /// OpenDRIVE id of the junction it belongs to.
        junction_id: Option<String>,
        /// Lanes: numbers of the lanes that travel may go on to at its end.
        successors: Vec<u32>,
        /// Lanes: numbers of the lanes that travel may come from at its beginning.
        predecessors: Vec<u32>,
        /// Lanes: number of the lane to the left in the direction of travel, of whatever type and direction.
        left: Vec<u32>,
        /// Lanes: number of the lane to the right, likewise.
        right: Vec<u32>,
        /// Lanes: numbers of its left and right boundary, in the direction of travel.
        boundaries: Vec<u32>,
        /// Numbers of the lanes it belongs to, ascending: beside a boundary or divider, held by a stop line
        /// or signal, under a crosswalk, in a sidewalk or junction.
        lanes: Vec<u32>,
        /// Lanes, stop lines: numbers of the signals that hold for it.
        signals: Vec<u32>,
        /// Boundaries: type of the marking at the middle. Dividers, kerbs: its type. As in `hd_map`.
        mark_type: Option<String>,
        /// Its colour.
        mark_color: Option<String>,
        /// Dividers: painted and unpainted length of a dashed line, m; empty for a continuous one.
        dash_m: Vec<f64>,
        /// Boundaries outside junctions: whether the ground for vehicles ends here.
        is_edge: bool,
        /// Stop lines: whether it is derived from a light or sign because the map has no line there.
        is_derived: bool,
        /// Signals: `traffic_light` where its state changes, `stop`, `yield`, else the type in its country's
        /// catalogue.
        signal_type: Option<String>,
        /// Signals: heading of the traffic it is for, rad.
        heading_rad: Option<f64>,
    }
}
