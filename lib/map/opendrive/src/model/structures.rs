//! Bridges, tunnels, railway switches and stations, as the file states them.

use super::{LaneValidity, RoadSide, SwitchPosition, TrackDirection, TunnelType};

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

/// A railway switch: where a side track leaves the main track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Switch {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// Whether it moves.
    pub position: SwitchPosition,
    /// The track that goes on.
    pub main: SwitchTrack,
    /// The track that leaves it.
    pub side: SwitchTrack,
    /// The switch at the side track's other end, if there is one: its name and id.
    pub partner: Option<(String, String)>,
}

/// A place on a track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SwitchTrack {
    /// Id of the track, which is a road.
    pub road: String,
    /// Metres along it.
    pub s: f64,
    /// Direction in which trains leave the switch on it.
    pub direction: TrackDirection,
}

/// A railway station or a bus stop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Station {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// `small`, `medium`, `large`, or empty.
    pub kind: String,
    /// Its platforms.
    pub platforms: Vec<Platform>,
}

/// A platform of a station.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Platform {
    /// Id as written.
    pub id: String,
    /// Name.
    pub name: String,
    /// The stretches of road it lies beside.
    pub segments: Vec<PlatformSegment>,
}

/// A stretch of road beside a platform.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlatformSegment {
    /// Id of the road.
    pub road: String,
    /// Start, metres along the road.
    pub s_start: f64,
    /// End, metres along the road.
    pub s_end: f64,
    /// Side of the road on which the platform is.
    pub side: RoadSide,
}
