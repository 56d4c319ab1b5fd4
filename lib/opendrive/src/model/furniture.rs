//! Signals, objects, bridges, junctions and controllers, as the file states them.

use super::{ContactPoint, JunctionKind, Orientation, SpeedUnit, TunnelType};

/// A traffic light or sign.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signal {
    /// Id as written (some files repeat one).
    pub id: String,
    /// Name.
    pub name: String,
    /// Metres along the road.
    pub s: f64,
    /// Metres to the left of the reference line.
    pub t: f64,
    /// Metres above the road surface.
    pub z_offset_m: f64,
    /// Turn from the direction that `orientation` gives, radians.
    pub h_offset_rad: f64,
    /// Pitch, radians.
    pub pitch_rad: f64,
    /// Roll, radians.
    pub roll_rad: f64,
    /// Traffic it is for.
    pub orientation: Orientation,
    /// Whether its state changes (a light) or not (a sign).
    pub dynamic: bool,
    /// Country whose catalogue `kind` refers to.
    pub country: String,
    /// Type in the catalogue.
    pub kind: String,
    /// Subtype in the catalogue.
    pub subtype: String,
    /// Value, for instance a speed.
    pub value: Option<f64>,
    /// Unit of the value, when it is a speed.
    pub unit: Option<SpeedUnit>,
    /// Text on it.
    pub text: String,
    /// Height, metres.
    pub height_m: Option<f64>,
    /// Width, metres.
    pub width_m: Option<f64>,
    /// Lanes it applies to; none stated means all, `0..0` means none of this road.
    pub validity: Vec<LaneValidity>,
}

/// Says that a signal of another road applies to this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalReference {
    /// Id of the signal.
    pub id: String,
    /// Metres along the road where it applies.
    pub s: f64,
    /// Metres to the left.
    pub t: f64,
    /// Traffic it is for.
    pub orientation: Orientation,
    /// Lanes it applies to.
    pub validity: Vec<LaneValidity>,
}

/// A range of lane ids, both ends included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneValidity {
    /// First.
    pub from: i16,
    /// Last.
    pub to: i16,
}

impl LaneValidity {
    /// Whether a lane is in the range, whichever way round it was written.
    #[must_use]
    pub fn contains(self, lane: i16) -> bool {
        lane != 0 && lane >= self.from.min(self.to) && lane <= self.from.max(self.to)
    }
}

/// Anything beside or on the road.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Object {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// `crosswalk`, `pole`, `parkingSpace`, ... or empty.
    pub kind: String,
    /// Subtype.
    pub subtype: String,
    /// Metres along the road.
    pub s: f64,
    /// Metres to the left of the reference line (the lane offset has no part in it).
    pub t: f64,
    /// Metres above the road surface.
    pub z_offset_m: f64,
    /// Heading relative to the road, radians.
    pub hdg_rad: f64,
    /// Pitch, radians.
    pub pitch_rad: f64,
    /// Roll, radians.
    pub roll_rad: f64,
    /// Traffic it is for.
    pub orientation: Orientation,
    /// Length along its own x, metres.
    pub length_m: Option<f64>,
    /// Width along its own y, metres.
    pub width_m: Option<f64>,
    /// Height, metres.
    pub height_m: Option<f64>,
    /// Radius, for round things, metres.
    pub radius_m: Option<f64>,
    /// Outlines.
    pub outlines: Vec<Outline>,
    /// Rows of copies.
    pub repeats: Vec<Repeat>,
    /// Lanes it applies to.
    pub validity: Vec<LaneValidity>,
}

/// A ring or chain of corners.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Whether the last corner joins the first.
    pub closed: bool,
    /// Corners as written (some writers repeat the first at the end).
    pub corners: Vec<Corner>,
}

impl Default for Outline {
    fn default() -> Self {
        Self { closed: true, corners: Vec::new() }
    }
}

/// A corner of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corner {
    /// In the object's own coordinates.
    Local {
        /// Metres along its x.
        u_m: f64,
        /// Metres along its y.
        v_m: f64,
        /// Metres along its z.
        z_m: f64,
        /// Height of the object here, metres.
        height_m: f64,
    },
    /// In road coordinates.
    Road {
        /// Metres along the road.
        s: f64,
        /// Metres to the left of the reference line.
        t: f64,
        /// Metres above the road surface.
        dz_m: f64,
        /// Height of the object here, metres.
        height_m: f64,
    },
}

/// A row of copies of an object, or with `distance_m` 0 one object stretched along the road.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Repeat {
    /// Start of the row, metres along the road.
    pub s: f64,
    /// Length of the row, metres.
    pub length_m: f64,
    /// Between two copies, metres.
    pub distance_m: f64,
    /// Lateral position at the start and at the end, metres to the left.
    pub t_m: [f64; 2],
    /// Height above the road at the start and at the end, metres.
    pub z_offset_m: [f64; 2],
    /// Height of the object at the start and at the end, if stated, metres.
    pub height_m: Option<[f64; 2]>,
    /// Width of the object at the start and at the end, if stated, metres.
    pub width_m: Option<[f64; 2]>,
}

/// A stretch of road that is a bridge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bridge {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// `concrete`, `steel`, `wood`, `brick`.
    pub kind: String,
    /// Start, metres along the road.
    pub s: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Lanes that it carries; none stated means all.
    pub validity: Vec<LaneValidity>,
}

/// A stretch of road that is a tunnel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tunnel {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// Closed all round, or open to daylight at its sides.
    pub kind: TunnelType,
    /// Start, metres along the road.
    pub s: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Degree of artificial light from 0 to 1, if stated.
    pub lighting: Option<f64>,
    /// Degree of daylight that comes in from 0 to 1, if stated.
    pub daylight: Option<f64>,
    /// Lanes that it holds; none stated means all.
    pub validity: Vec<LaneValidity>,
}

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
}

/// A pair of lanes that touch in a junction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneLink {
    /// Lane of the incoming road.
    pub from: i16,
    /// Lane of the connecting road.
    pub to: i16,
}

/// A group of signals that always show the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Controller {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// Place in the order of controllers, if stated.
    pub sequence: Option<u32>,
    /// Ids of its signals, each once.
    pub signals: Vec<String>,
}
