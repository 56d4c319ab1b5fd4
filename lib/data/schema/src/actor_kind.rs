//! What an object of a scene is.

use crate::text::words;

/// What an object of a scene is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ActorKind {
    /// Drives, or stands in an accident.
    Vehicle,
    /// Walks, or stands about in a hazard.
    Walker,
    /// A road-side unit's pole.
    Rsu,
    /// The housing of a traffic light; its pole belongs to the mesh.
    TrafficLight,
    /// The board of a sign.
    Sign,
    /// A small thing beside the road or in a hazard.
    #[default]
    Prop,
    /// A vehicle that stands in a parking place for the whole scene.
    Parked,
    /// A building.
    Building,
    /// A tree, bush or hedge.
    Vegetation,
    /// A pole, street lamps among them.
    Pole,
    /// The surfaces of an area.
    Surface,
}

words! {
    ActorKind, "actor kind":
    Vehicle = "vehicle",
    Walker = "walker",
    Rsu = "rsu",
    TrafficLight = "traffic_light",
    Sign = "sign",
    Prop = "prop",
    Parked = "parked",
    Building = "building",
    Vegetation = "vegetation",
    Pole = "pole",
    Surface = "surface",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_format() {
        let words = "vehicle walker rsu traffic_light sign prop parked building vegetation pole surface";
        assert_eq!(ActorKind::ALL.iter().map(|k| k.name()).collect::<Vec<_>>().join(" "), words);
        for kind in ActorKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(*kind));
        }
        let error = "boat".parse::<ActorKind>().expect_err("boats swim").to_string();
        assert!(error.starts_with("`boat` is no actor kind, expected one of vehicle, walker, "), "{error}");
        assert!("".parse::<ActorKind>().is_err() && "Vehicle".parse::<ActorKind>().is_err());
    }
}
