//! A road network as the file states it: plain data, nothing derived.

mod furniture;
mod words;

pub use furniture::{
    Bridge, Connection, Controller, Corner, Junction, JunctionController, LaneLink, LaneValidity, Object,
    Outline, Repeat, Signal, SignalReference, Tunnel,
};
pub use words::{
    ContactPoint, JunctionKind, LaneChange, LaneType, MarkChange, MarkColour, MarkType, Orientation,
    SpeedUnit, TrafficRule, TravelDirection, TunnelType,
};

use crate::read::Warning;

/// A whole OpenDRIVE file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// Revision, name, projection, offset.
    pub header: Header,
    /// Roads in file order; other types name a road by its index here.
    pub roads: Vec<Road>,
    /// Junctions in file order.
    pub junctions: Vec<Junction>,
    /// Signal controllers in file order.
    pub controllers: Vec<Controller>,
    /// What the reader found wrong and put up with (empty for a network built in memory).
    pub warnings: Vec<Warning>,
}

/// The file's header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// Major and minor revision of the format.
    pub revision: (u32, u32),
    /// Name of the network.
    pub name: String,
    /// Version of the network.
    pub version: String,
    /// Date as written.
    pub date: String,
    /// Program or company that wrote it.
    pub vendor: String,
    /// Bounds north, south, east, west in metres, as written.
    pub bounds_m: Option<[f64; 4]>,
    /// Projection string, as written, trimmed.
    pub geo_reference: Option<String>,
    /// Moves and turns the whole network.
    pub offset: HeaderOffset,
}

/// Shift of the whole network: first translated, then turned about the inertial z axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeaderOffset {
    /// Metres east.
    pub x_m: f64,
    /// Metres north.
    pub y_m: f64,
    /// Metres up.
    pub z_m: f64,
    /// Counter-clockwise turn, radians.
    pub hdg_rad: f64,
}

/// One road: a reference line and everything that is given along it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Road {
    /// Id as written (not always a number).
    pub id: String,
    /// Name.
    pub name: String,
    /// Length of the reference line, metres.
    pub length_m: f64,
    /// Id of the junction this is a connecting road of.
    pub junction: Option<String>,
    /// Side that traffic keeps to.
    pub rule: TrafficRule,
    /// What touches the road's start.
    pub predecessor: Option<RoadLink>,
    /// What touches the road's end.
    pub successor: Option<RoadLink>,
    /// Road types and speed limits, by s.
    pub types: Vec<RoadType>,
    /// The reference line in plan, by s.
    pub plan_view: Vec<Geometry>,
    /// Height of the reference line, metres, by s.
    pub elevation: Vec<Cubic>,
    /// Roll about the reference line, radians, by s; positive: the left side is higher.
    pub superelevation: Vec<Cubic>,
    /// Height over the superelevated surface, by s, then t.
    pub shape: Vec<Shape>,
    /// Lateral shift of the centre lane, metres, by s.
    pub lane_offset: Vec<Cubic>,
    /// Lane sections, by s.
    pub sections: Vec<LaneSection>,
    /// Objects beside and on the road.
    pub objects: Vec<Object>,
    /// Signals that stand at this road.
    pub signals: Vec<Signal>,
    /// Signals of other roads that apply here.
    pub signal_references: Vec<SignalReference>,
    /// Bridges.
    pub bridges: Vec<Bridge>,
    /// Tunnels.
    pub tunnels: Vec<Tunnel>,
}

/// What touches an end of a road.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RoadLink {
    /// Another road.
    Road {
        /// Its id.
        id: String,
        /// The end that touches.
        contact: ContactPoint,
    },
    /// A junction.
    Junction {
        /// Its id.
        id: String,
    },
}

/// Type of a road from a given s on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadType {
    /// Start, metres along the road.
    pub s: f64,
    /// `town`, `motorway`, `rural`, ...
    pub kind: String,
    /// Speed limit, if one is stated.
    pub speed: Option<Speed>,
}

/// A stated speed limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    /// The number, in `unit`; infinite where the file says `no limit`.
    pub max: f64,
    /// Its unit.
    pub unit: SpeedUnit,
}

impl Speed {
    /// In metres a second.
    #[must_use]
    pub fn mps(self) -> f64 {
        self.max * self.unit.metres_per_second()
    }
}

/// A cubic `a + b d + c d^2 + d d^3` of `d = s - start`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic {
    /// Where it begins: road s, or the offset from the lane section's start for records of a lane.
    pub s: f64,
    /// Constant.
    pub a: f64,
    /// Linear.
    pub b: f64,
    /// Quadratic.
    pub c: f64,
    /// Cubic.
    pub d: f64,
}

impl Cubic {
    /// The same value everywhere.
    #[must_use]
    pub fn constant(a: f64) -> Self {
        Self { a, ..Self::default() }
    }
}

/// Height profile across the road: a cubic of t from `t` on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Road s.
    pub s: f64,
    /// Where the cubic begins, metres to the left.
    pub cubic_of_t: Cubic,
}

/// One piece of the reference line in plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geometry {
    /// Start, metres along the road.
    pub s: f64,
    /// Start, metres east.
    pub x_m: f64,
    /// Start, metres north.
    pub y_m: f64,
    /// Heading at the start, radians from east, counter-clockwise.
    pub hdg_rad: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Its curve.
    pub curve: Curve,
}

/// The curve of a piece, in its own coordinates: u along the start heading, v to the left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Curve {
    /// Straight.
    #[default]
    Line,
    /// Of constant curvature, 1/m; positive turns left.
    Arc {
        /// 1/m.
        curvature: f64,
    },
    /// Of curvature linear in length (clothoid).
    Spiral {
        /// At the start, 1/m.
        curvature_start: f64,
        /// At the end, 1/m.
        curvature_end: f64,
    },
    /// `v = a + b u + c u^2 + d u^3`.
    Poly3 {
        /// `a, b, c, d`.
        v: [f64; 4],
    },
    /// `u(p), v(p)`, both cubic.
    ParamPoly3 {
        /// Coefficients of u.
        u: [f64; 4],
        /// Coefficients of v.
        v: [f64; 4],
        /// Whether p runs to 1 instead of to the piece's length.
        normalised: bool,
    },
}

/// A stretch of road with a fixed set of lanes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaneSection {
    /// Start, metres along the road.
    pub s: f64,
    /// Lanes left of the centre, from the inside out: ids 1, 2, 3, ...
    pub left: Vec<Lane>,
    /// The centre lane, id 0, without width; only its markings matter.
    pub centre: Lane,
    /// Lanes right of the centre, from the inside out: ids -1, -2, -3, ...
    pub right: Vec<Lane>,
}

impl LaneSection {
    /// All lanes but the centre, by ascending id (from the right edge to the left edge).
    pub fn lanes(&self) -> impl Iterator<Item = &Lane> {
        self.right.iter().rev().chain(&self.left)
    }

    /// The lane with an id (0 is the centre lane).
    #[must_use]
    pub fn lane(&self, id: i16) -> Option<&Lane> {
        match id {
            0 => Some(&self.centre),
            1.. => self.left.iter().find(|l| l.id == id),
            _ => self.right.iter().find(|l| l.id == id),
        }
    }
}

/// One lane of a section.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lane {
    /// Positive left of the centre, negative right, counted outwards.
    pub id: i16,
    /// What it is for.
    pub lane_type: LaneType,
    /// Whether it stays level where the road is superelevated.
    pub level: bool,
    /// Direction of travel (revision 1.8).
    pub direction: TravelDirection,
    /// Width in metres, by offset from the section's start.
    pub widths: Vec<Cubic>,
    /// Outer border in metres from the centre lane, used where there are no widths.
    pub borders: Vec<Cubic>,
    /// Markings on the outer border (centre lane: on itself), by offset.
    pub marks: Vec<RoadMark>,
    /// Speed limits, by offset.
    pub speeds: Vec<LaneSpeed>,
    /// Height over the road surface, by offset (kerbs).
    pub heights: Vec<LaneHeight>,
    /// Ids of the lanes that touch it at the section's start (in the section or road before).
    pub predecessors: Vec<i16>,
    /// Ids of the lanes that touch it at the section's end.
    pub successors: Vec<i16>,
}

/// A lane's own speed limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneSpeed {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// The limit.
    pub speed: Speed,
}

/// How far a lane is raised over the road surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneHeight {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// At the border near the centre, metres.
    pub inner_m: f64,
    /// At the other border, metres.
    pub outer_m: f64,
}

/// A marking along a lane's outer border.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadMark {
    /// Metres after the section's start.
    pub s_offset: f64,
    /// Its kind.
    pub mark_type: MarkType,
    /// Its colour.
    pub colour: MarkColour,
    /// Bold instead of ordinary weight.
    pub bold: bool,
    /// Width of a line, metres, if stated.
    pub width_m: Option<f64>,
    /// Height over the road, metres, if stated.
    pub height_m: Option<f64>,
    /// Lane changes across it, if stated.
    pub lane_change: Option<MarkChange>,
    /// Lines it consists of, if stated.
    pub lines: Vec<MarkLine>,
}

/// One line of a detailed marking.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkLine {
    /// Visible stretch, metres.
    pub length_m: f64,
    /// Gap between two stretches, metres; 0 is continuous.
    pub space_m: f64,
    /// Shift to the left from the border, metres.
    pub t_offset_m: f64,
    /// Start after the marking's start, metres.
    pub s_offset: f64,
    /// Width, metres, if stated.
    pub width_m: Option<f64>,
    /// Colour, if stated.
    pub colour: Option<MarkColour>,
}
