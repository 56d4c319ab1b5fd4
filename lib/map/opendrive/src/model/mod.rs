//! A road network as the file states it: plain data, nothing derived.

mod element;
mod junctions;
mod lanes;
mod network;
mod objects;
mod records;
mod road;
mod signals;
mod structures;
mod warning;
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
pub use network::{Header, HeaderOffset, Network};
pub use objects::{
    Corner, CornerReference, Object, ObjectBorder, ObjectMarking, ObjectMaterial, ObjectReference, Outline,
    ParkingSpace, Repeat, SkeletonLine, SkeletonVertex,
};
pub use records::{Crossfall, Cubic, Curve, Geometry, Shape, Speed};
pub use road::{Neighbour, Road, RoadLink, RoadType};
pub use signals::{
    Controller, ElementReference, LaneValidity, Signal, SignalDependency, SignalPosition, SignalReference,
};
pub use structures::{Bridge, Platform, PlatformSegment, Station, Switch, SwitchTrack, Tunnel};
pub use warning::Warning;
pub use words::{
    AccessRule, BoxSide, ConnectionKind, ContactPoint, JunctionKind, LaneAdvisory, LaneChange, LaneType,
    LineRule, MarkChange, MarkColour, MarkType, NeighbourDirection, Orientation, RoadSide, SpeedUnit,
    SwitchPosition, TrackDirection, TrafficRule, TravelDirection, TunnelType,
};
