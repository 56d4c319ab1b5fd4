//! The file as a whole.

use std::collections::BTreeMap;

use super::{Controller, Element, Junction, JunctionGroup, Road, Station, UnknownElement, Warning};

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
    /// What the reader does not understand: how often each element occurs, by its path below the root, such
    /// as `road/lanes/laneSection/left/lane/foo` (empty for a network built in memory).
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
