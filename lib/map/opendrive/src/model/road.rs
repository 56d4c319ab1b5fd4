//! Roads, and what is given along them.

use super::{
    Bridge, ContactPoint, Crossfall, Cubic, Element, Geometry, LaneSection, NeighbourDirection, Object,
    ObjectReference, RoadSide, Shape, Signal, SignalReference, Speed, Switch, TrackDirection, TrafficRule,
    Tunnel,
};

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
