//! A road network as the file states it: plain data, nothing derived.

mod element;
mod junctions;
mod lanes;
mod objects;
mod signals;
mod structures;
mod words;

pub use element::{Element, UnknownElement};
pub use junctions::{
    BoundarySegment, Connection, CrossPath, CrossPathEnd, CrossingStretch, ElevationGrid, GridRow, Junction,
    JunctionController, JunctionGroup, LaneLink, Priority, SegmentEnd, VirtualStretch,
};
pub use lanes::{
    Lane, LaneAccess, LaneHeight, LaneMaterial, LaneRule, LaneSection, LaneSpeed, MarkLine, MarkStroke,
    RoadMark,
};
pub use objects::{
    Corner, CornerReference, Object, ObjectBorder, ObjectMarking, ObjectMaterial, ObjectReference, Outline,
    ParkingSpace, Repeat, SkeletonLine, SkeletonVertex,
};
pub use signals::{
    Controller, ElementReference, LaneValidity, Signal, SignalDependency, SignalPosition, SignalReference,
};
pub use structures::{Bridge, Platform, PlatformSegment, Station, Switch, SwitchTrack, Tunnel};
pub use words::{
    AccessRule, BoxSide, ConnectionKind, ContactPoint, JunctionKind, LaneAdvisory, LaneChange, LaneType,
    LineRule, MarkChange, MarkColour, MarkType, NeighbourDirection, Orientation, RoadSide, SpeedUnit,
    SwitchPosition, TrackDirection, TrafficRule, TravelDirection, TunnelType,
};

use std::collections::BTreeMap;

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
    /// Junctions that make one node together, such as a roundabout.
    pub junction_groups: Vec<JunctionGroup>,
    /// Railway stations and bus stops.
    pub stations: Vec<Station>,
    /// Other elements beside the roads, kept as they are.
    pub kept: Vec<Element>,
    /// What the reader does not understand: how often each element occurs, by its path below the root, such as
    /// `road/lanes/laneSection/left/lane/foo` (empty for a network built in memory).
    pub unknown_elements: BTreeMap<String, UnknownElement>,
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
    /// Other elements of it (licence, default regulations, ...), kept as they are.
    pub kept: Vec<Element>,
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
    /// Roads that run beside it (revision 1.4 and older).
    pub neighbours: Vec<Neighbour>,
    /// Road types and speed limits, by s.
    pub types: Vec<RoadType>,
    /// The reference line in plan, by s.
    pub plan_view: Vec<Geometry>,
    /// Height of the reference line, metres, by s.
    pub elevation: Vec<Cubic>,
    /// Roll about the reference line, radians, by s; positive: the left side is higher.
    pub superelevation: Vec<Cubic>,
    /// Inclination to the outside on either side, by s (revision 1.3 and older).
    pub crossfall: Vec<Crossfall>,
    /// Height over the superelevated surface, by s, then t.
    pub shape: Vec<Shape>,
    /// The surface in strips (revision 1.8), kept as it is: no query looks at it.
    pub cross_section_surface: Vec<Element>,
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
    /// Objects of other roads that matter here, too.
    pub object_references: Vec<ObjectReference>,
    /// Railway switches.
    pub switches: Vec<Switch>,
    /// Other elements of it (CRG surfaces, ...), kept as they are.
    pub kept: Vec<Element>,
}

/// What touches an end of a road.
#[derive(Clone, Debug, PartialEq)]
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
    /// A place along another road, which goes on there (in virtual junctions).
    Along {
        /// Its id.
        id: String,
        /// The place, metres along it.
        s: f64,
        /// Direction, relative to its s, in which the joined traffic travels on it.
        direction: TrackDirection,
    },
}

/// A road that runs beside another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Neighbour {
    /// Which side it is on.
    pub side: RoadSide,
    /// Its id.
    pub id: String,
    /// Whether it runs the same way.
    pub direction: NeighbourDirection,
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
    /// Country whose rules hold, as written.
    pub country: String,
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

/// Inclination of the surface to the outside, as an angle from the t axis: positive where the surface falls from
/// the reference line outwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossfall {
    /// Where it applies.
    pub side: RoadSide,
    /// Radians, by s.
    pub angle_rad: Cubic,
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
