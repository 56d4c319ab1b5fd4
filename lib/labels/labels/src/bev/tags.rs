//! What a tag means for masks.

use schema::{BevClass, Tag};

/// Whether a tag is a surface one can stand on.
pub(crate) fn is_ground(tag: Tag) -> bool {
    use Tag::*;
    matches!(tag, Road | RoadLine | Sidewalk | Terrain | Ground | Water | RailTrack)
}

/// The channel of an object's tag.
pub(crate) fn object_class(tag: Tag) -> Option<BevClass> {
    Some(match tag {
        Tag::TrafficCone => BevClass::TrafficCone,
        Tag::Barrier => BevClass::Barrier,
        Tag::Car => BevClass::Car,
        Tag::Truck => BevClass::Truck,
        Tag::Bus => BevClass::Bus,
        Tag::Motorcycle => BevClass::Motorcycle,
        Tag::Bicycle => BevClass::Bicycle,
        Tag::Rider => BevClass::Rider,
        Tag::Pedestrian => BevClass::Pedestrian,
        _ => return None,
    })
}

/// The tags that a predicate holds for, as bits.
pub(crate) fn tag_bits(wanted: impl Fn(Tag) -> bool) -> u32 {
    Tag::ALL.into_iter().filter(|&tag| wanted(tag)).fold(0, |bits, tag| bits | 1 << tag as u32)
}
