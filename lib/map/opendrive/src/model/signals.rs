//! Signals and their controllers, as the file states them.

use std::collections::BTreeMap;

use super::{Element, Orientation, SpeedUnit};

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
    /// Edition of that catalogue.
    pub country_revision: String,
    /// Type in the catalogue.
    pub kind: String,
    /// Subtype in the catalogue.
    pub subtype: String,
    /// Value, for instance a speed.
    pub value: Option<f64>,
    /// Unit of the value, when it is a speed.
    pub unit: Option<SpeedUnit>,
    /// Unit of the value as written, when it is none of speed (`m`, `t`, `%`, ...).
    pub other_unit: String,
    /// Text on it.
    pub text: String,
    /// Height, metres.
    pub height_m: Option<f64>,
    /// Width, metres.
    pub width_m: Option<f64>,
    /// Thickness, metres.
    pub length_m: Option<f64>,
    /// Lanes it applies to; none stated means all, `0..0` means none of this road.
    pub validity: Vec<LaneValidity>,
    /// Signals whose meaning depends on this one, or it on them.
    pub dependencies: Vec<SignalDependency>,
    /// Objects and signals that belong to it.
    pub references: Vec<ElementReference>,
    /// Where it really stands, when `s` and `t` only say where it holds.
    pub position: Option<SignalPosition>,
    /// Other elements of it (boards, semantics, ...), kept as they are.
    pub kept: Vec<Element>,
}

/// Says that a signal depends on another, as a light on its supplementary sign.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignalDependency {
    /// Id of the other signal.
    pub id: String,
    /// Kind of the dependency, as written.
    pub kind: String,
}

/// Says that an object or another signal belongs to a signal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ElementReference {
    /// `object` or `signal`.
    pub element: String,
    /// Its id.
    pub id: String,
    /// Kind of the relation, as written.
    pub kind: String,
}

/// Where a signal really stands.
#[derive(Clone, Debug, PartialEq)]
pub enum SignalPosition {
    /// In the file's inertial frame.
    Inertial {
        /// Metres east, north, up.
        xyz_m: [f64; 3],
        /// Heading, radians from east.
        hdg_rad: f64,
        /// Pitch, radians.
        pitch_rad: f64,
        /// Roll, radians.
        roll_rad: f64,
    },
    /// At a road.
    Road {
        /// Id of the road.
        road: String,
        /// Metres along it.
        s: f64,
        /// Metres to the left of its reference line.
        t: f64,
        /// Metres above its surface.
        z_offset_m: f64,
        /// Turn from the road's direction, radians.
        h_offset_rad: f64,
        /// Pitch, radians.
        pitch_rad: f64,
        /// Roll, radians.
        roll_rad: f64,
    },
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
    /// Type of control of those signals for which one is stated, by their ids.
    pub control_types: BTreeMap<String, String>,
}
