//! OpenDRIVE road networks: read, write, geometry, lane graph, queries.
//!
//! [`Network`] is a file's content as plain data: parse one with [`Network::parse`], or build one in memory,
//! and turn it back into a file with [`write()`]. `docs/opendrive-coverage.md` lists what is read, and used
//! for what. [`Map`] is a network made ready for questions: where is a lane, what follows it, which lane is
//! nearest, what is painted, which signal holds for it.
//!
//! All positions are in the world frame: metres, x east, y north, z up (the file's inertial frame, with
//! the header's offset applied).
//!
//! ```
//! use nalgebra::Point3;
//! use opendrive::{Map, Network, write};
//!
//! let network = Network::parse(
//!     r#"<OpenDRIVE><header revMajor="1" revMinor="7"/>
//!     <road id="1" length="100" junction="-1">
//!     <planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
//!     <lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>
//!     <lane id="-1" type="driving"><width sOffset="0" a="3.5"/></lane>
//!     </right></laneSection></lanes>
//!     </road></OpenDRIVE>"#,
//! )?;
//! assert!(network.warnings.is_empty());
//! // What is written reads back the same.
//! assert_eq!(Network::parse(&write(&network))?, network);
//!
//! let map = Map::new(network);
//! let hit = map.nearest_driving_lane(Point3::new(40.0, -2.0, 0.0)).expect("a lane");
//! // The lane's middle is at y = -1.75: the point is a quarter of a metre to the right of it.
//! assert!(hit.lane.lane == -1 && hit.is_inside());
//! assert!((hit.s - 40.0).abs() < 1e-6 && (hit.t_m + 0.25).abs() < 1e-6);
//! # Ok::<(), opendrive::ReadError>(())
//! ```

mod geometry;
mod map;
mod model;
mod read;
mod write;

pub use map::{
    Ahead, Area, Crosswalk, CrosswalkAxis, CrosswalkSpan, GroupController, JunctionInfo, LaneBounds, LaneHit,
    LaneId, LaneInfo, LanePoint, LanePolyline, LanePos, Map, Marking, ObjectInfo, OutlineInfo, RoadSymbol,
    Sidewalk, SignalGroup, SignalInfo, StopLine, StopLineSource, Stripe, StripeStrip, VEHICLE_LANE_WIDTH_M,
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
