//! OpenDRIVE road networks: read, write, geometry, lane graph, queries.
//!
//! [`Network`] is a file's content as plain data: parse one with [`Network::parse`], or build one in memory, and
//! turn it back into a file with [`write()`]. [`Map`] is a network made ready for questions: where is a
//! lane, what follows it, which lane is nearest, what is painted, which signal holds for it.
//!
//! All positions are in the world frame: metres, x east, y north, z up (the file's inertial frame, with
//! the header's offset applied).

mod geometry;
mod map;
mod model;
mod read;
mod write;

pub use map::{
    Crosswalk, GroupController, JunctionInfo, LaneBounds, LaneHit, LaneId, LaneInfo, LanePoint, LanePolyline,
    LanePos, Map, Marking, ObjectInfo, OutlineInfo, SignalGroup, SignalInfo, Stripe, StripeStrip,
};
pub use model::{
    Bridge, Connection, ContactPoint, Controller, Corner, Cubic, Curve, Geometry, Header, HeaderOffset,
    Junction, JunctionController, JunctionKind, Lane, LaneChange, LaneHeight, LaneLink, LaneSection,
    LaneSpeed, LaneType, LaneValidity, MarkChange, MarkColour, MarkLine, MarkType, Network, Object,
    Orientation, Outline, Repeat, Road, RoadLink, RoadMark, RoadType, Shape, Signal, SignalReference, Speed,
    SpeedUnit, TrafficRule, TravelDirection, Tunnel, TunnelType,
};
pub use read::{ReadError, Warning, read_bytes};
pub use write::write;
