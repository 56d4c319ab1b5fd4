//! The layout's words: categories, levels of visibility, channels.

use clap::ValueEnum;
use scene::{SensorEntry, SensorKind};
use schema::{Attribute, Attributes, DetectionClass, ImageKind, Tag};
use serde::Serialize;

/// Categories in the order of their lidarseg indices, with what each is. Devkits know colours for just these.
pub(crate) const CATEGORIES: [(&str, &str); 32] = [
    ("noise", "Returns of nothing: fog and rain."),
    ("animal", "Not in this dataset."),
    ("human.pedestrian.adult", "A grown-up on foot."),
    ("human.pedestrian.child", "A child on foot."),
    ("human.pedestrian.construction_worker", "A worker at road works."),
    ("human.pedestrian.personal_mobility", "Not in this dataset."),
    ("human.pedestrian.police_officer", "A police officer on foot."),
    ("human.pedestrian.stroller", "Somebody with a pram, with it."),
    ("human.pedestrian.wheelchair", "A person in a wheelchair, with it."),
    ("movable_object.barrier", "A barrier at road works."),
    ("movable_object.debris", "Not in this dataset."),
    ("movable_object.pushable_pullable", "Things that lie or stand about and can be moved."),
    ("movable_object.trafficcone", "A traffic cone."),
    ("static_object.bicycle_rack", "Not in this dataset."),
    ("vehicle.bicycle", "A bicycle, with its rider."),
    ("vehicle.bus.bendy", "A section of an articulated bus, each with a box of its own."),
    ("vehicle.bus.rigid", "A bus."),
    ("vehicle.car", "A car."),
    ("vehicle.construction", "Not in this dataset."),
    ("vehicle.emergency.ambulance", "Not in this dataset: ambulances are trucks."),
    ("vehicle.emergency.police", "Not in this dataset: police cars are cars."),
    ("vehicle.motorcycle", "A motorcycle, with its rider."),
    ("vehicle.trailer", "A semi-trailer; the tractor unit before it is a truck."),
    ("vehicle.truck", "A truck or van."),
    ("flat.driveable_surface", "Roads and what is painted on them."),
    ("flat.other", "Other flat ground: rails, water."),
    ("flat.sidewalk", "Sidewalks."),
    ("flat.terrain", "Grass and soil."),
    ("static.manmade", "Buildings, walls, fences, poles, lights, signs, bridges."),
    ("static.other", "What fits nowhere else; as boxes: traffic lights and signs."),
    ("static.vegetation", "Trees, bushes and hedges."),
    ("vehicle.ego", "The agent itself."),
];

/// Levels of visibility: token, level, what it says.
pub(crate) const VISIBILITIES: [(&str, &str, &str); 4] = [
    ("1", "v0-40", "The cameras show 0 to 40 % of what is in their pictures of the object."),
    ("2", "v40-60", "They show 40 to 60 % of it."),
    ("3", "v60-80", "They show 60 to 80 % of it."),
    ("4", "v80-100", "They show 80 to 100 % of it."),
];

/// The category of an annotated object.
pub(crate) fn category(class: DetectionClass, facts: &Attributes) -> &'static str {
    match class {
        DetectionClass::Car => "vehicle.car",
        DetectionClass::Truck if schema::is_trailer(class, facts) => "vehicle.trailer",
        DetectionClass::Truck => "vehicle.truck",
        DetectionClass::Bus => match facts.get(&Attribute::SpecialType) {
            Some("articulated") => "vehicle.bus.bendy",
            _ => "vehicle.bus.rigid",
        },
        DetectionClass::Motorcycle => "vehicle.motorcycle",
        DetectionClass::Bicycle => "vehicle.bicycle",
        DetectionClass::TrafficCone => "movable_object.trafficcone",
        DetectionClass::Barrier => "movable_object.barrier",
        DetectionClass::TrafficLight | DetectionClass::TrafficSign => "static.other",
        DetectionClass::Pedestrian => match facts.get(&Attribute::SpecialType) {
            _ if facts.is_true(&Attribute::UseWheelchair) => "human.pedestrian.wheelchair",
            Some("wheelchair") => "human.pedestrian.wheelchair",
            Some("pram") => "human.pedestrian.stroller",
            Some("worker") => "human.pedestrian.construction_worker",
            Some("police") => "human.pedestrian.police_officer",
            _ if facts.get(&Attribute::Age) == Some("child") => "human.pedestrian.child",
            _ => "human.pedestrian.adult",
        },
    }
}

/// The lidarseg index of a category.
pub(crate) fn category_index(name: &str) -> u8 {
    CATEGORIES.iter().position(|(category, _)| *category == name).unwrap_or_default() as u8
}

/// The level of visibility of a share.
pub(crate) fn visibility(share: f64) -> &'static str {
    let level = [0.4, 0.6, 0.8].iter().filter(|limit| share >= **limit).count();
    VISIBILITIES[level].0
}

/// The lidarseg index of a return by its tag alone: of things of a class that of the class.
pub(crate) fn index_of_tag(tag: u8) -> u8 {
    let name = match Tag::from_u8(tag).unwrap_or_default() {
        Tag::Unlabeled | Tag::Sky => "noise",
        Tag::Road | Tag::RoadLine => "flat.driveable_surface",
        Tag::Sidewalk => "flat.sidewalk",
        Tag::Terrain => "flat.terrain",
        Tag::Ground | Tag::Water | Tag::RailTrack => "flat.other",
        Tag::Building
        | Tag::Wall
        | Tag::Fence
        | Tag::Pole
        | Tag::TrafficLight
        | Tag::TrafficSign
        | Tag::Static
        | Tag::Bridge
        | Tag::GuardRail => "static.manmade",
        Tag::Vegetation => "static.vegetation",
        Tag::Dynamic => "movable_object.pushable_pullable",
        Tag::Train | Tag::Other | Tag::Rock => "static.other",
        Tag::Pedestrian | Tag::Rider => "human.pedestrian.adult",
        Tag::Car => "vehicle.car",
        Tag::Truck => "vehicle.truck",
        Tag::Bus => "vehicle.bus.rigid",
        Tag::Motorcycle => "vehicle.motorcycle",
        Tag::Bicycle => "vehicle.bicycle",
        Tag::TrafficCone => "movable_object.trafficcone",
        Tag::Barrier => "movable_object.barrier",
    };
    category_index(name)
}

/// Whether returns of a tag are of an object that says more than the tag: a pedestrian's kind, what is
/// ridden, what is towed.
pub(crate) fn is_told_by_object(tag: u8) -> bool {
    matches!(Tag::from_u8(tag), Some(Tag::Pedestrian | Tag::Rider | Tag::Truck | Tag::Bus))
}

/// What a channel's readings are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Modality {
    /// Pictures.
    Camera,
    /// Sweeps of a lidar.
    Lidar,
    /// Returns of a radar.
    Radar,
}

impl Modality {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Lidar => "lidar",
            Self::Radar => "radar",
        }
    }

    /// What its files are called at the end.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Camera => "jpg",
            Self::Lidar => "pcd.bin",
            Self::Radar => "pcd",
        }
    }

    /// What tables call the format of its files.
    pub(crate) fn file_format(self) -> &'static str {
        match self {
            Self::Camera => "jpg",
            Self::Lidar | Self::Radar => "pcd",
        }
    }
}

/// The channel and modality of a sensor; none of what the layout has no place for. `is_top` is the lidar that
/// every sample must have.
pub(crate) fn channel(sensor: &SensorEntry, is_top: bool) -> Option<(String, Modality)> {
    match sensor.kind {
        SensorKind::Image(ImageKind::Rgb) => Some((sensor.camera()?.to_owned(), Modality::Camera)),
        SensorKind::Lidar if is_top => Some(("LIDAR_TOP".to_owned(), Modality::Lidar)),
        SensorKind::Lidar => Some((sensor.name.clone(), Modality::Lidar)),
        SensorKind::Radar => {
            let name = sensor.name.strip_prefix("RAD_").map(|place| format!("RADAR_{place}"));
            Some((name.unwrap_or_else(|| sensor.name.clone()), Modality::Radar))
        }
        SensorKind::Image(_) | SensorKind::SemanticLidar | SensorKind::Gnss | SensorKind::Imu => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn index(name: &str) -> u8 {
        category_index(name)
    }

    #[test]
    fn indices_are_those_of_lidarseg() {
        for (name, number) in [
            ("noise", 0),
            ("human.pedestrian.adult", 2),
            ("movable_object.barrier", 9),
            ("movable_object.trafficcone", 12),
            ("vehicle.bicycle", 14),
            ("vehicle.bus.rigid", 16),
            ("vehicle.car", 17),
            ("vehicle.motorcycle", 21),
            ("vehicle.truck", 23),
            ("flat.driveable_surface", 24),
            ("flat.sidewalk", 26),
            ("static.vegetation", 30),
            ("vehicle.ego", 31),
        ] {
            assert_eq!(index(name), number, "{name}");
        }
        assert_eq!([1, 24, 2, 14, 13, 0, 8].map(index_of_tag), [24, 24, 26, 17, 2, 0, 28]);
    }

    #[test]
    fn people_are_told_apart() {
        let facts = |key, value: &str| Attributes::new().with(key, value);
        let person = |facts: &Attributes| category(DetectionClass::Pedestrian, facts);
        assert_eq!(person(&facts(Attribute::Age, "child")), "human.pedestrian.child");
        assert_eq!(person(&facts(Attribute::Age, "elderly")), "human.pedestrian.adult");
        assert_eq!(person(&facts(Attribute::SpecialType, "worker")), "human.pedestrian.construction_worker");
        assert_eq!(person(&facts(Attribute::SpecialType, "pram")), "human.pedestrian.stroller");
        assert_eq!(person(&facts(Attribute::SpecialType, "dog")), "human.pedestrian.adult");
        assert_eq!(person(&facts(Attribute::UseWheelchair, "true")), "human.pedestrian.wheelchair");
        assert_eq!(category(DetectionClass::TrafficSign, &Attributes::new()), "static.other");
    }

    #[test]
    fn sections_of_trains_are_told_apart() {
        for (name, wanted) in [
            ("truck.tractor", "vehicle.truck"),
            ("trailer.box", "vehicle.trailer"),
            ("bus.articulated", "vehicle.bus.bendy"),
            ("bus.articulated_rear", "vehicle.bus.bendy"),
        ] {
            let model = catalogue::trains::find(name).expect("a section");
            let tags: Vec<u8> = model.base.tags().iter().map(|tag| *tag as u8).collect();
            let class = DetectionClass::from_tags(&tags).expect("a class");
            assert_eq!(category(class, &model.facts()), wanted, "{name}");
            assert!(tags.iter().all(|tag| is_told_by_object(*tag)));
        }
        let bus = catalogue::models::find("bus.city").expect("a bus");
        assert_eq!(category(DetectionClass::Bus, &bus.facts()), "vehicle.bus.rigid");
    }

    #[test]
    fn levels_begin_with_their_lower_end() {
        assert_eq!(
            [0.0, 0.39, 0.4, 0.6, 0.79, 0.8, 1.0].map(visibility),
            ["1", "1", "2", "3", "3", "4", "4"]
        );
    }
}
