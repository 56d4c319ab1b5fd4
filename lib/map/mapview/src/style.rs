//! What things look like.

use opendrive::{LaneType, MarkColour};

use crate::picture::Colour;

pub(crate) const PAPER: Colour = [253, 253, 251, 255];
pub(crate) const INK: Colour = [52, 52, 56, 255];
pub(crate) const FAINT_INK: Colour = [110, 110, 114, 255];
/// Open country.
pub(crate) const GROUND: Colour = [226, 234, 210, 255];
/// Land along streets with sidewalks.
pub(crate) const BUILT_UP: Colour = [240, 235, 224, 255];
pub(crate) const WATER: Colour = [168, 207, 229, 255];
pub(crate) const SHORE: Colour = [126, 172, 200, 255];
pub(crate) const BUILDING: Colour = [205, 193, 180, 255];
pub(crate) const GREENERY: Colour = [134, 174, 107, 255];
pub(crate) const BARRIER: Colour = [96, 92, 88, 255];
pub(crate) const ISLAND: Colour = [206, 200, 188, 255];
pub(crate) const KERB: Colour = [178, 170, 158, 255];
/// Edges of decks, and what they throw on the ground.
pub(crate) const PARAPET: Colour = [66, 62, 60, 255];
pub(crate) const SHADOW: Colour = [30, 30, 40, 70];
/// Roads underground.
pub(crate) const TUNNEL: Colour = [205, 202, 196, 255];
pub(crate) const TUNNEL_EDGE: Colour = [110, 106, 102, 255];
pub(crate) const RAIL: Colour = [74, 66, 62, 255];
pub(crate) const SLEEPER: Colour = [132, 116, 100, 255];
pub(crate) const RED: Colour = [200, 38, 38, 255];
pub(crate) const AMBER: Colour = [240, 176, 40, 255];
pub(crate) const GO: Colour = [46, 160, 84, 255];
pub(crate) const BLUE: Colour = [44, 92, 170, 255];
pub(crate) const WHITE: Colour = [255, 255, 255, 255];
pub(crate) const PARKING_LINE: Colour = [226, 229, 236, 255];

/// Surfaces, in painting order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    Verge,
    /// Ballast: at level crossings the road lies over it.
    Rail,
    Sidewalk,
    Median,
    Shoulder,
    Restricted,
    Parking,
    Bike,
    Asphalt,
    Junction,
    Bus,
}

impl Class {
    pub(crate) fn of(lane_type: LaneType, in_junction: bool) -> Self {
        match lane_type {
            LaneType::None => Self::Verge,
            LaneType::Sidewalk | LaneType::Walking => Self::Sidewalk,
            LaneType::Median => Self::Median,
            LaneType::Shoulder | LaneType::Stop | LaneType::Border | LaneType::Curb => Self::Shoulder,
            LaneType::Restricted | LaneType::RoadWorks => Self::Restricted,
            LaneType::Parking => Self::Parking,
            LaneType::Biking => Self::Bike,
            LaneType::Bus | LaneType::Taxi | LaneType::Hov => Self::Bus,
            track if track.is_track() => Self::Rail,
            _ if in_junction => Self::Junction,
            _ => Self::Asphalt,
        }
    }

    pub(crate) fn colour(self) -> Colour {
        let [r, g, b] = match self {
            Self::Verge => [203, 217, 178],
            Self::Sidewalk => [217, 208, 194],
            Self::Median => [178, 203, 146],
            Self::Shoulder => [148, 148, 148],
            Self::Restricted => [136, 136, 132],
            Self::Parking => [139, 147, 163],
            Self::Bike => [176, 112, 100],
            Self::Asphalt => [118, 118, 124],
            Self::Junction => [126, 126, 131],
            Self::Bus => [140, 108, 104],
            Self::Rail => [186, 176, 160],
        };
        [r, g, b, 255]
    }

    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Verge => "Verge",
            Self::Sidewalk => "Sidewalk",
            Self::Median => "Median",
            Self::Shoulder => "Shoulder, gutter",
            Self::Restricted => "Closed area",
            Self::Parking => "Parking",
            Self::Bike => "Bike lane",
            Self::Asphalt => "Road",
            Self::Junction => "Junction",
            Self::Bus => "Bus lane",
            Self::Rail => "Railway",
        }
    }
}

pub(crate) fn paint_colour(colour: MarkColour) -> Colour {
    match colour {
        MarkColour::Yellow => [246, 200, 60, 255],
        MarkColour::Red => [214, 68, 60, 255],
        MarkColour::Blue => [80, 130, 220, 255],
        MarkColour::Green => [90, 180, 100, 255],
        MarkColour::Orange => [240, 150, 50, 255],
        MarkColour::Black => [30, 30, 30, 255],
        MarkColour::Violet => [160, 100, 200, 255],
        MarkColour::Standard | MarkColour::White => WHITE,
    }
}

/// Roads on small scales, in painting order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum RoadClass {
    Rail,
    Street,
    Rural,
    Motorway,
}

impl RoadClass {
    /// Fill and casing.
    pub(crate) fn colours(self) -> [Colour; 2] {
        match self {
            Self::Rail => [WHITE, RAIL],
            Self::Street => [WHITE, [160, 154, 146, 255]],
            Self::Rural => [[250, 219, 132, 255], [186, 150, 60, 255]],
            Self::Motorway => [[235, 142, 92, 255], [158, 82, 44, 255]],
        }
    }

    /// Least width on the sheet, pixels.
    pub(crate) fn least_px(self) -> f64 {
        match self {
            Self::Rail => 1.8,
            Self::Street => 1.7,
            Self::Rural => 2.6,
            Self::Motorway => 3.0,
        }
    }

    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Rail => "Railway",
            Self::Street => "Street",
            Self::Rural => "Country road",
            Self::Motorway => "Motorway",
        }
    }
}

/// An entry of the legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    Road(RoadClass),
    Surface(Class),
    Water,
    Building,
    Greenery,
    Bridge,
    Tunnel,
    Crosswalk,
    Light,
    Stop,
    Yield,
    Speed,
    RailCross,
    Sign,
}
