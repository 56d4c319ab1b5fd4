//! OpenDRIVE road networks: read, write, geometry, lane graph, queries.
//!
//! [`Network`] is a file's content as plain data: parse one with [`Network::parse`], or build one in memory, and
//! turn it back into a file with [`write()`]. `docs/opendrive-coverage.md` lists what is read, and used for what. [`Map`] is a network made ready for questions: where is a
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
    Ahead, Area, Crosswalk, CrosswalkSpan, GroupController, JunctionInfo, LaneBounds, LaneHit, LaneId,
    LaneInfo, LanePoint, LanePolyline, LanePos, Map, Marking, ObjectInfo, OutlineInfo, Sidewalk, SignalGroup,
    SignalInfo, StopLine, StopLineSource, Stripe, StripeStrip, VEHICLE_LANE_WIDTH_M,
};
pub use model::{
    AccessRule, BoundarySegment, BoxSide, Bridge, Connection, ConnectionKind, ContactPoint, Controller,
    Corner, CornerReference, CrossPath, CrossPathEnd, Crossfall, CrossingStretch, Cubic, Curve, Element,
    ElementReference, ElevationGrid, Geometry, GridRow, Header, HeaderOffset, Junction, JunctionController,
    JunctionGroup, JunctionKind, Lane, LaneAccess, LaneAdvisory, LaneChange, LaneHeight, LaneLink,
    LaneMaterial, LaneRule, LaneSection, LaneSpeed, LaneType, LaneValidity, LineRule, MarkChange, MarkColour,
    MarkLine, MarkStroke, MarkType, Neighbour, NeighbourDirection, Network, Object, ObjectBorder,
    ObjectMarking, ObjectMaterial, ObjectReference, Orientation, Outline, ParkingSpace, Platform,
    PlatformSegment, Priority, Repeat, Road, RoadLink, RoadMark, RoadSide, RoadType, SegmentEnd, Shape,
    Signal, SignalDependency, SignalPosition, SignalReference, SkeletonLine, SkeletonVertex, Speed,
    SpeedUnit, Station, Switch, SwitchPosition, SwitchTrack, TrackDirection, TrafficRule, TravelDirection,
    Tunnel, TunnelType, UnknownElement, VirtualStretch, Warning,
};
pub use read::{ReadError, read_bytes};
pub use write::write;
