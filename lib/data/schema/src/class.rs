//! Detection classes and difficulty.

use crate::Tag;

/// Class of an annotated box, in canonical evaluation order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum DetectionClass {
    TrafficLight,
    TrafficSign,
    Pedestrian,
    Car,
    Truck,
    Bus,
    Motorcycle,
    Bicycle,
    TrafficCone,
    Barrier,
}

impl DetectionClass {
    /// All classes, in canonical order.
    pub const ALL: [Self; 10] = {
        use DetectionClass::*;
        [TrafficLight, TrafficSign, Pedestrian, Car, Truck, Bus, Motorcycle, Bicycle, TrafficCone, Barrier]
    };

    /// The class of a tag. Riders have no boxes of their own and therefore no class.
    #[must_use]
    pub fn from_tag(tag: Tag) -> Option<Self> {
        Some(match tag {
            Tag::TrafficLight => Self::TrafficLight,
            Tag::TrafficSign => Self::TrafficSign,
            Tag::Pedestrian => Self::Pedestrian,
            Tag::Car => Self::Car,
            Tag::Truck => Self::Truck,
            Tag::Bus => Self::Bus,
            Tag::Motorcycle => Self::Motorcycle,
            Tag::Bicycle => Self::Bicycle,
            Tag::TrafficCone => Self::TrafficCone,
            Tag::Barrier => Self::Barrier,
            _ => return None,
        })
    }

    /// The class of an object with several tags: the last one that has a class (rider before two-wheeler).
    #[must_use]
    pub fn from_tags(tags: &[u8]) -> Option<Self> {
        tags.iter().rev().find_map(|&t| Tag::from_u8(t).and_then(Self::from_tag))
    }

    /// Name in tables and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TrafficLight => "traffic_light",
            Self::TrafficSign => "traffic_sign",
            Self::Pedestrian => "pedestrian",
            Self::Car => "car",
            Self::Truck => "truck",
            Self::Bus => "bus",
            Self::Motorcycle => "motorcycle",
            Self::Bicycle => "bicycle",
            Self::TrafficCone => "traffic_cone",
            Self::Barrier => "barrier",
        }
    }

    /// The class with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// Colour of boxes in pictures (sRGB).
    #[must_use]
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Self::TrafficLight => [240, 160, 0],
            Self::TrafficSign => [240, 0, 128],
            Self::Pedestrian => [240, 0, 0],
            Self::Car => [0, 128, 240],
            Self::Truck => [128, 240, 64],
            Self::Bus => [0, 144, 0],
            Self::Motorcycle => [240, 240, 0],
            Self::Bicycle => [0, 240, 240],
            Self::TrafficCone => [252, 180, 0],
            Self::Barrier => [240, 128, 128],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_wheelers_are_not_riders() {
        assert_eq!(DetectionClass::from_tags(&[13, 18]), Some(DetectionClass::Motorcycle));
        assert_eq!(DetectionClass::from_tags(&[13]), None);
        for class in DetectionClass::ALL {
            assert_eq!(DetectionClass::from_name(class.name()), Some(class));
        }
    }
}
