//! The 32 semantic tags.

/// What a surface is. The number is the one in images, semantic lidar and voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Tag {
    #[default]
    Unlabeled = 0,
    Road = 1,
    Sidewalk = 2,
    Building = 3,
    Wall = 4,
    Fence = 5,
    Pole = 6,
    TrafficLight = 7,
    TrafficSign = 8,
    Vegetation = 9,
    Terrain = 10,
    Sky = 11,
    Pedestrian = 12,
    Rider = 13,
    Car = 14,
    Truck = 15,
    Bus = 16,
    Train = 17,
    Motorcycle = 18,
    Bicycle = 19,
    Static = 20,
    Dynamic = 21,
    Other = 22,
    Water = 23,
    RoadLine = 24,
    Ground = 25,
    Bridge = 26,
    RailTrack = 27,
    GuardRail = 28,
    Rock = 29,
    TrafficCone = 30,
    Barrier = 31,
}

impl Tag {
    /// How many tags there are.
    pub const COUNT: usize = 32;

    /// All tags, by number.
    pub const ALL: [Self; Self::COUNT] = {
        use Tag::*;
        [
            Unlabeled,
            Road,
            Sidewalk,
            Building,
            Wall,
            Fence,
            Pole,
            TrafficLight,
            TrafficSign,
            Vegetation,
            Terrain,
            Sky,
            Pedestrian,
            Rider,
            Car,
            Truck,
            Bus,
            Train,
            Motorcycle,
            Bicycle,
            Static,
            Dynamic,
            Other,
            Water,
            RoadLine,
            Ground,
            Bridge,
            RailTrack,
            GuardRail,
            Rock,
            TrafficCone,
            Barrier,
        ]
    };

    /// The tag with a number, if there is one.
    #[must_use]
    pub fn from_u8(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Name in tables and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    /// Colour in semantic images (sRGB).
    #[must_use]
    pub fn camera_rgb(self) -> [u8; 3] {
        CAMERA_RGB[self as usize]
    }

    /// Colour in point-cloud and voxel pictures (sRGB).
    #[must_use]
    pub fn viewer_rgb(self) -> [u8; 3] {
        match self {
            Self::Unlabeled => [255, 255, 255],
            Self::RoadLine => [227, 227, 227],
            other => other.camera_rgb(),
        }
    }

    /// Which label a voxel takes when several surfaces meet in it: the greater wins; 0 never writes.
    #[must_use]
    pub fn voxel_priority(self) -> u8 {
        use Tag::*;
        match self {
            Unlabeled => 0,
            RoadLine => 8,
            Road | Sidewalk => 7,
            Pedestrian | Rider => 6,
            Motorcycle | Bicycle => 5,
            Car => 4,
            Truck | Bus => 3,
            TrafficLight | TrafficSign | TrafficCone | Barrier => 2,
            _ => 1,
        }
    }
}

const NAMES: [&str; Tag::COUNT] = [
    "unlabeled",
    "road",
    "sidewalk",
    "building",
    "wall",
    "fence",
    "pole",
    "traffic_light",
    "traffic_sign",
    "vegetation",
    "terrain",
    "sky",
    "pedestrian",
    "rider",
    "car",
    "truck",
    "bus",
    "train",
    "motorcycle",
    "bicycle",
    "static",
    "dynamic",
    "other",
    "water",
    "road_line",
    "ground",
    "bridge",
    "rail_track",
    "guard_rail",
    "rock",
    "traffic_cone",
    "barrier",
];

const CAMERA_RGB: [[u8; 3]; Tag::COUNT] = [
    [0, 0, 0],
    [128, 64, 128],
    [244, 35, 232],
    [70, 70, 70],
    [102, 102, 156],
    [190, 153, 153],
    [153, 153, 153],
    [250, 170, 30],
    [220, 220, 0],
    [107, 142, 35],
    [152, 251, 152],
    [70, 130, 180],
    [220, 20, 60],
    [255, 0, 0],
    [0, 0, 142],
    [0, 0, 70],
    [0, 60, 100],
    [0, 80, 100],
    [0, 0, 230],
    [119, 11, 32],
    [110, 190, 160],
    [170, 120, 50],
    [55, 90, 80],
    [45, 60, 150],
    [157, 234, 50],
    [81, 0, 81],
    [150, 100, 100],
    [230, 150, 140],
    [180, 165, 180],
    [110, 110, 110],
    [255, 165, 0],
    [200, 128, 128],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_names_and_colours_line_up() {
        for (number, tag) in Tag::ALL.into_iter().enumerate() {
            assert_eq!(tag as usize, number);
            assert_eq!(Tag::from_u8(number as u8), Some(tag));
        }
        assert_eq!(Tag::from_u8(32), None);
        assert_eq!(Tag::RoadLine.name(), "road_line");
        assert_eq!(Tag::RoadLine.camera_rgb(), [157, 234, 50]);
        assert_eq!(Tag::Barrier.name(), "barrier");
        assert_eq!(Tag::Car.camera_rgb(), [0, 0, 142]);
        let mut colours: Vec<_> = Tag::ALL.iter().map(|t| t.camera_rgb()).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), Tag::COUNT, "semantic images are decoded by colour");
    }
}
