//! The 14 bird's-eye-view classes.

use serde::{Deserialize, Serialize};

/// One class of a BEV mask; the number is its channel where all are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
#[repr(u8)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum BevClass {
    Road = 0,
    Hazard = 1,
    RoadLine = 2,
    Sidewalk = 3,
    Crosswalk = 4,
    TrafficCone = 5,
    Barrier = 6,
    Car = 7,
    Truck = 8,
    Bus = 9,
    Motorcycle = 10,
    Bicycle = 11,
    Rider = 12,
    Pedestrian = 13,
}

impl BevClass {
    /// How many channels there are.
    pub const COUNT: usize = 14;

    /// All classes, by number.
    pub const ALL: [Self; Self::COUNT] = {
        use BevClass::*;
        [
            Road,
            Hazard,
            RoadLine,
            Sidewalk,
            Crosswalk,
            TrafficCone,
            Barrier,
            Car,
            Truck,
            Bus,
            Motorcycle,
            Bicycle,
            Rider,
            Pedestrian,
        ]
    };

    /// Name in tables and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    /// The class of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name() == name)
    }

    /// Colour in pictures of a mask (sRGB).
    #[must_use]
    pub fn rgb(self) -> [u8; 3] {
        RGB[self as usize]
    }
}

impl TryFrom<String> for BevClass {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::from_name(&name).ok_or_else(|| format!("`{name}` is no class of BEV masks"))
    }
}

impl From<BevClass> for &'static str {
    fn from(class: BevClass) -> Self {
        class.name()
    }
}

const NAMES: [&str; BevClass::COUNT] = [
    "road",
    "hazard",
    "road_line",
    "sidewalk",
    "crosswalk",
    "traffic_cone",
    "barrier",
    "car",
    "truck",
    "bus",
    "motorcycle",
    "bicycle",
    "rider",
    "pedestrian",
];

const RGB: [[u8; 3]; BevClass::COUNT] = [
    [196, 80, 196],
    [240, 80, 80],
    [160, 240, 40],
    [240, 196, 240],
    [240, 196, 196],
    [255, 165, 0],
    [200, 128, 128],
    [0, 128, 240],
    [80, 240, 80],
    [0, 144, 0],
    [240, 240, 0],
    [0, 240, 240],
    [240, 144, 0],
    [240, 0, 0],
];
