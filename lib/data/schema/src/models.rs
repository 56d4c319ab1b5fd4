//! The catalogue of actor models: names and real dimensions. `world` makes the meshes, `traffic` drives them.
//!
//! Dimensions are of ordinary vehicles of each kind, taken from makers' public data sheets and rounded.

use crate::{Attribute, Attributes, Tag};

/// What a model is, for planning and driving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum BaseType {
    Car,
    Van,
    Truck,
    Bus,
    Motorcycle,
    Bicycle,
    Pedestrian,
    Cone,
    Barrier,
}

impl BaseType {
    /// All of them.
    pub const ALL: [Self; 9] = {
        use BaseType::*;
        [Car, Van, Truck, Bus, Motorcycle, Bicycle, Pedestrian, Cone, Barrier]
    };

    /// The type of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|base| base.name() == name)
    }

    /// Whether it drives, and so has wheels and an engine or pedals.
    #[must_use]
    pub fn is_driven(self) -> bool {
        !matches!(self, Self::Pedestrian | Self::Cone | Self::Barrier)
    }

    /// Name in attributes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Car => "car",
            Self::Van => "van",
            Self::Truck => "truck",
            Self::Bus => "bus",
            Self::Motorcycle => "motorcycle",
            Self::Bicycle => "bicycle",
            Self::Pedestrian => "pedestrian",
            Self::Cone => "cone",
            Self::Barrier => "barrier",
        }
    }

    /// What the names of its models begin with.
    #[must_use]
    pub fn family(self) -> &'static str {
        if self == Self::Pedestrian { "walker" } else { self.name() }
    }

    /// Length of lane that a vehicle of an accident takes up, metres.
    #[must_use]
    pub fn stretch_m(self) -> f64 {
        match self {
            Self::Truck | Self::Van => 10.0,
            Self::Bus => 12.0,
            Self::Motorcycle => 4.0,
            Self::Bicycle => 2.0,
            Self::Car | Self::Pedestrian | Self::Cone | Self::Barrier => 6.0,
        }
    }

    /// Semantic tags of an object of this type; the last one names its class.
    #[must_use]
    pub fn tags(self) -> &'static [Tag] {
        match self {
            Self::Car => &[Tag::Car],
            Self::Van | Self::Truck => &[Tag::Truck],
            Self::Bus => &[Tag::Bus],
            Self::Motorcycle => &[Tag::Rider, Tag::Motorcycle],
            Self::Bicycle => &[Tag::Rider, Tag::Bicycle],
            Self::Pedestrian => &[Tag::Pedestrian],
            Self::Cone => &[Tag::TrafficCone],
            Self::Barrier => &[Tag::Barrier],
        }
    }
}

/// One model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Name in configuration, log and boxes.
    pub name: &'static str,
    /// What it is.
    pub base: BaseType,
    /// Length, width, height, metres (rider included).
    pub size_m: [f64; 3],
    /// Distance between the axles, metres (0 without wheels).
    pub wheelbase_m: f64,
    /// Wheel radius, metres.
    pub wheel_radius_m: f64,
    /// `emergency`, `taxi`, `electric`, `trailer`, `articulated` (sections of buses), of people `police`, `worker`, `wheelchair`, `pram`, `dog`; or empty.
    pub special: &'static str,
    /// What a pack says of its model, which follows from kind and name of all others.
    pub own: Option<OwnFacts>,
}

/// What only the maker of a model knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnFacts {
    /// Doors that open: none, the two in front, or four.
    pub doors: u8,
    /// Wheels.
    pub wheels: u8,
    /// Whether it has lamps.
    pub has_lights: bool,
    /// Of people: one of [`AGES`]; else the first.
    pub age: &'static str,
    /// Of people: one of [`GENDERS`]; else the first.
    pub gender: &'static str,
}

/// Model of a road-side unit: its pole.
pub const RSU_MODEL: &str = "rsu.pole";

/// How old people are.
pub const AGES: [&str; 3] = ["adult", "child", "elderly"];
/// What people are.
pub const GENDERS: [&str; 2] = ["male", "female"];

impl Model {
    /// How far the springs of a vehicle on four wheels let its body come down on a wheel, or up from it, metres: less than
    /// there is room in the arches. Lorries and buses are stiff.
    #[must_use]
    pub fn spring_travel_m(&self) -> f64 {
        let share = if matches!(self.base, BaseType::Truck | BaseType::Bus) { 0.05 } else { 0.1 };
        share * self.wheel_radius_m
    }

    /// Doors that open: the two in front, or four; none of trucks, buses, large vans and two-wheelers.
    #[must_use]
    pub fn doors(&self) -> usize {
        if let Some(own) = self.own {
            return own.doors.into();
        }
        match (self.base, self.name) {
            // Theirs slide, or are too high to be told from the body.
            (BaseType::Van, "van.parcel" | "van.motorhome") => 0,
            (BaseType::Car, "car.coupe" | "car.sports" | "car.mini" | "car.micro") | (BaseType::Van, _) => 2,
            (BaseType::Car, _) | (_, "truck.pickup") => 4,
            _ => 0,
        }
    }

    /// Axles of a vehicle: heavy lorries have two at the rear, semi-trailers three.
    #[must_use]
    pub fn axles(&self) -> usize {
        match self.name {
            "truck.heavy" | "truck.tipper" | "truck.mixer" | "truck.tanker" | "truck.refuse" => 3,
            "bus.articulated_rear" => 1,
            name if name.starts_with("trailer.") => 3,
            _ => 2,
        }
    }

    /// What people look like.
    #[must_use]
    pub fn gender(&self, variant: u32) -> &'static str {
        if let Some(own) = self.own {
            return own.gender;
        }
        match self.name {
            "walker.woman" => "female",
            "walker.child" | "walker.teen" | "walker.elder" | "walker.wheelchair" | "walker.with_pram"
            | "walker.with_dog"
                if variant % 2 == 1 =>
            {
                "female"
            }
            "walker.police" | "walker.worker" if variant % 4 == 3 => "female",
            _ => "male",
        }
    }

    /// What is true of every object of the model, for its attributes. ([`Model::gender`] depends on the object.)
    #[must_use]
    pub fn facts(&self) -> Attributes {
        let facts = Attributes::new()
            .with(Attribute::BaseType, self.base.name())
            .with(Attribute::SpecialType, self.special);
        match self.base {
            BaseType::Pedestrian => {
                let age = match (self.own, self.name) {
                    (Some(own), _) => own.age,
                    (None, "walker.child" | "walker.teen") => "child",
                    (None, "walker.elder") => "elderly",
                    _ => "adult",
                };
                let sits = self.special == "wheelchair";
                facts
                    .with(Attribute::Age, age)
                    .with(Attribute::Generation, GENERATION)
                    .with(Attribute::CanUseWheelchair, sits)
                    .with(Attribute::UseWheelchair, sits)
                    .with(Attribute::IsInvincible, false)
            }
            BaseType::Cone | BaseType::Barrier => facts,
            _ => {
                let wheels = match (self.own, self.base) {
                    (Some(own), _) => own.wheels.into(),
                    (None, BaseType::Motorcycle | BaseType::Bicycle) => 2,
                    _ => 2 * self.axles(),
                };
                let has_lights = self.own.map_or(self.base != BaseType::Bicycle, |own| own.has_lights);
                facts
                    .with(Attribute::NumberOfWheels, wheels)
                    .with(Attribute::HasLights, has_lights)
                    .with(Attribute::HasDynamicDoors, self.doors() > 0)
                    .with(Attribute::Generation, GENERATION)
            }
        }
    }
}

/// See [`Attribute::Generation`].
const GENERATION: u32 = 2;

pub(crate) const fn model(
    name: &'static str,
    base: BaseType,
    size_m: [f64; 3],
    wheelbase_m: f64,
    wheel_radius_m: f64,
    special: &'static str,
) -> Model {
    Model { name, base, size_m, wheelbase_m, wheel_radius_m, special, own: None }
}

/// All models, in catalogue order.
pub const MODELS: &[Model] = {
    use BaseType::*;
    &[
        model("car.coupe", Car, [4.72, 1.92, 1.38], 2.72, 0.35, ""),
        model("car.sedan", Car, [4.70, 1.84, 1.44], 2.85, 0.33, ""),
        model("car.hatchback", Car, [4.28, 1.79, 1.47], 2.63, 0.32, ""),
        model("car.sports", Car, [4.38, 1.86, 1.30], 2.47, 0.34, ""),
        model("car.wagon", Car, [4.78, 1.83, 1.48], 2.84, 0.33, ""),
        model("car.suv", Car, [4.68, 1.89, 1.67], 2.73, 0.36, ""),
        model("car.offroad", Car, [4.24, 1.88, 1.84], 2.46, 0.39, ""),
        model("car.mini", Car, [3.82, 1.73, 1.42], 2.50, 0.30, ""),
        model("car.micro", Car, [2.70, 1.66, 1.55], 1.87, 0.29, "electric"),
        model("car.electric", Car, [4.69, 1.85, 1.44], 2.88, 0.34, "electric"),
        model("car.limousine", Car, [5.18, 1.90, 1.50], 3.11, 0.35, ""),
        model("car.taxi", Car, [4.93, 1.86, 1.47], 2.94, 0.34, "taxi"),
        model("car.police", Car, [5.03, 1.90, 1.47], 3.05, 0.36, "emergency"),
        model("van.delivery", Van, [5.93, 2.02, 2.62], 3.66, 0.35, ""),
        model("van.camper", Van, [4.90, 1.90, 1.99], 3.00, 0.34, ""),
        model("van.passenger", Van, [5.14, 1.93, 1.91], 3.20, 0.34, ""),
        model("van.ambulance", Van, [6.20, 2.10, 2.85], 3.70, 0.36, "emergency"),
        model("truck.box", Truck, [7.60, 2.35, 3.25], 4.30, 0.44, ""),
        model("truck.heavy", Truck, [9.20, 2.50, 3.60], 5.60, 0.50, ""),
        model("truck.pickup", Truck, [5.68, 2.02, 1.90], 3.80, 0.42, "electric"),
        model("truck.fire", Truck, [8.60, 2.50, 3.30], 4.70, 0.50, "emergency"),
        model("bus.city", Bus, [12.00, 2.55, 3.10], 5.90, 0.48, ""),
        model("motorcycle.cruiser", Motorcycle, [2.35, 0.80, 1.68], 1.63, 0.33, ""),
        model("motorcycle.sport", Motorcycle, [2.08, 0.74, 1.66], 1.40, 0.31, ""),
        model("motorcycle.scooter", Motorcycle, [1.85, 0.72, 1.73], 1.29, 0.23, "electric"),
        model("bicycle.city", Bicycle, [1.80, 0.62, 1.88], 1.08, 0.35, ""),
        model("bicycle.road", Bicycle, [1.70, 0.60, 1.76], 1.00, 0.34, ""),
        model("walker.man", Pedestrian, [0.40, 0.58, 1.78], 0.0, 0.0, ""),
        model("walker.woman", Pedestrian, [0.36, 0.52, 1.65], 0.0, 0.0, ""),
        model("walker.tall", Pedestrian, [0.42, 0.60, 1.90], 0.0, 0.0, ""),
        model("walker.elder", Pedestrian, [0.38, 0.55, 1.62], 0.0, 0.0, ""),
        model("walker.child", Pedestrian, [0.28, 0.38, 1.25], 0.0, 0.0, ""),
        model("walker.police", Pedestrian, [0.42, 0.60, 1.84], 0.0, 0.0, "police"),
        model("walker.worker", Pedestrian, [0.42, 0.60, 1.86], 0.0, 0.0, "worker"),
        model("cone.traffic", Cone, [0.36, 0.36, 0.72], 0.0, 0.0, ""),
        model("cone.plain", Cone, [0.30, 0.30, 0.50], 0.0, 0.0, ""),
        model("cone.big", Cone, [0.48, 0.48, 0.95], 0.0, 0.0, ""),
        model("cone.barrel", Cone, [0.58, 0.58, 1.02], 0.0, 0.0, ""),
        model("cone.skinny", Cone, [0.34, 0.34, 1.07], 0.0, 0.0, ""),
        model("cone.construction", Cone, [0.38, 0.38, 0.76], 0.0, 0.0, ""),
        model("cone.small", Cone, [0.24, 0.24, 0.32], 0.0, 0.0, ""),
        model("barrier.street", Barrier, [1.20, 0.45, 1.00], 0.0, 0.0, ""),
        model("barrier.concrete", Barrier, [2.00, 0.58, 0.82], 0.0, 0.0, ""),
        model("barrier.wooden", Barrier, [1.50, 0.60, 1.05], 0.0, 0.0, ""),
        model("walker.teen", Pedestrian, [0.38, 0.52, 1.60], 0.0, 0.0, ""),
        model("walker.wheelchair", Pedestrian, [1.10, 0.66, 1.32], 0.0, 0.31, "wheelchair"),
        model("walker.with_pram", Pedestrian, [1.47, 0.60, 1.68], 0.0, 0.0, "pram"),
        model("walker.with_dog", Pedestrian, [0.80, 0.74, 1.70], 0.0, 0.0, "dog"),
        model("car.city", Car, [3.60, 1.66, 1.50], 2.42, 0.29, ""),
        model("car.compact", Car, [4.46, 1.77, 1.45], 2.67, 0.31, ""),
        model("car.liftback", Car, [4.96, 1.96, 1.44], 2.96, 0.36, "electric"),
        model("car.crossover", Car, [4.43, 1.84, 1.61], 2.67, 0.35, ""),
        model("car.offroad_large", Car, [5.06, 2.02, 1.87], 3.00, 0.40, ""),
        model("car.mpv", Car, [4.53, 1.83, 1.66], 2.79, 0.33, ""),
        model("car.cab", Car, [4.70, 1.84, 1.58], 2.78, 0.33, "taxi"),
        model("van.compact", Van, [4.49, 1.86, 1.86], 2.79, 0.33, ""),
        model("van.minibus", Van, [6.97, 2.02, 2.64], 4.33, 0.35, ""),
        model("van.parcel", Van, [7.10, 2.30, 3.05], 4.00, 0.40, ""),
        model("van.motorhome", Van, [6.99, 2.32, 2.92], 4.04, 0.35, ""),
        model("truck.curtain", Truck, [9.60, 2.55, 3.80], 5.80, 0.50, ""),
        model("truck.dropside", Truck, [6.60, 2.20, 2.50], 3.85, 0.40, ""),
        model("truck.flatbed", Truck, [8.90, 2.50, 2.95], 5.20, 0.48, ""),
        model("truck.tipper", Truck, [7.90, 2.50, 3.10], 4.30, 0.50, ""),
        model("truck.mixer", Truck, [8.70, 2.50, 3.75], 4.90, 0.50, ""),
        model("truck.tanker", Truck, [9.30, 2.50, 3.30], 5.50, 0.50, ""),
        model("truck.refuse", Truck, [9.20, 2.50, 3.45], 4.70, 0.50, ""),
        model("truck.tow", Truck, [7.60, 2.40, 2.80], 4.30, 0.44, ""),
        model("truck.sweeper", Truck, [6.60, 2.30, 2.85], 3.50, 0.42, ""),
        model("truck.ladder", Truck, [9.70, 2.50, 3.40], 5.10, 0.50, "emergency"),
        model("bus.coach", Bus, [12.00, 2.55, 3.65], 6.10, 0.50, ""),
        model("bus.school", Bus, [10.60, 2.45, 3.10], 5.50, 0.48, ""),
        model("motorcycle.moped", Motorcycle, [1.74, 0.66, 1.72], 1.20, 0.25, ""),
        model("motorcycle.police", Motorcycle, [2.24, 0.90, 1.80], 1.52, 0.32, "emergency"),
        model("bicycle.cargo", Bicycle, [2.46, 0.68, 1.86], 1.84, 0.30, "electric"),
        model("bicycle.kick", Bicycle, [1.16, 0.60, 1.90], 0.90, 0.12, "electric"),
    ]
};

/// Two-wheelers that stand at a kerb or rack with nobody on them.
pub const PARKED_TWO_WHEELERS: &[Model] = {
    use BaseType::*;
    &[
        model("motorcycle.cruiser.parked", Motorcycle, [2.35, 0.80, 1.12], 1.63, 0.33, ""),
        model("motorcycle.sport.parked", Motorcycle, [2.08, 0.74, 1.14], 1.40, 0.31, ""),
        model("motorcycle.scooter.parked", Motorcycle, [1.85, 0.72, 1.16], 1.29, 0.23, "electric"),
        model("bicycle.city.parked", Bicycle, [1.80, 0.62, 1.06], 1.08, 0.35, ""),
        model("bicycle.road.parked", Bicycle, [1.70, 0.60, 1.02], 1.00, 0.34, ""),
        model("motorcycle.moped.parked", Motorcycle, [1.74, 0.66, 1.10], 1.20, 0.25, ""),
        model("motorcycle.police.parked", Motorcycle, [2.24, 0.90, 1.38], 1.52, 0.32, "emergency"),
        model("bicycle.cargo.parked", Bicycle, [2.46, 0.68, 1.10], 1.84, 0.30, "electric"),
        model("bicycle.kick.parked", Bicycle, [1.16, 0.60, 1.18], 0.90, 0.12, "electric"),
    ]
};

/// The parked two-wheeler with a name, and the same one with its rider.
#[must_use]
pub fn find_parked(name: &str) -> Option<(&'static Model, &'static Model)> {
    let parked = PARKED_TWO_WHEELERS.iter().find(|m| m.name == name)?;
    Some((parked, find(name.strip_suffix(".parked")?)?))
}

/// The model with a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Model> {
    MODELS.iter().find(|m| m.name == name)
}

/// How far a vehicle of a length and width reaches inwards and outwards from a circle that its middle goes round on, metres:
/// with a half wheelbase h, its rear axle goes round on a circle of radius sqrt(R^2 - h^2), and its outer front corner's
/// circle follows from the side and the front.
#[must_use]
pub fn swept_m([length_m, width_m]: [f64; 2], half_base_m: f64, radius_m: f64) -> [f64; 2] {
    let rear = (radius_m * radius_m - half_base_m * half_base_m).max(0.0).sqrt();
    let (side, front) = (rear + 0.5 * width_m, half_base_m + 0.5 * length_m);
    [radius_m - rear + 0.5 * width_m, (side * side + front * front).sqrt() - radius_m]
}

/// Models that drive in background traffic.
pub fn vehicles() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.wheelbase_m > 0.0)
}

/// Models that walk about alone; police and workers have their places.
pub fn walkers() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.base == BaseType::Pedestrian && m.special.is_empty())
}

/// Somebody in a wheelchair.
#[must_use]
pub fn wheelchair() -> Option<&'static Model> {
    find("walker.wheelchair")
}

/// Somebody who pushes a pram.
#[must_use]
pub fn with_pram() -> Option<&'static Model> {
    find("walker.with_pram")
}

/// Somebody who leads a dog.
#[must_use]
pub fn with_dog() -> Option<&'static Model> {
    find("walker.with_dog")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DetectionClass;

    #[test]
    fn facts_are_those_of_the_kind() {
        let fact =
            |name: &str, attribute| find(name).expect("a model").facts().get(&attribute).map(str::to_owned);
        assert_eq!(fact("bicycle.city", Attribute::NumberOfWheels).as_deref(), Some("2"));
        assert_eq!(fact("truck.box", Attribute::NumberOfWheels).as_deref(), Some("4"));
        assert_eq!(fact("truck.heavy", Attribute::NumberOfWheels).as_deref(), Some("6"));
        assert_eq!(fact("bicycle.city", Attribute::HasLights).as_deref(), Some("false"));
        assert_eq!(fact("bus.city", Attribute::HasDynamicDoors).as_deref(), Some("false"));
        assert_eq!(fact("car.police", Attribute::SpecialType).as_deref(), Some("emergency"));
        assert_eq!(fact("car.police", Attribute::HasDynamicDoors).as_deref(), Some("true"));
        // Statistics need this of every pedestrian: workers and bystanders, too.
        for model in MODELS.iter().filter(|m| m.base == BaseType::Pedestrian) {
            let sits = fact(model.name, Attribute::UseWheelchair);
            assert_eq!(sits.as_deref(), Some(if model.special == "wheelchair" { "true" } else { "false" }));
        }
        assert_eq!(fact("walker.child", Attribute::Age).as_deref(), Some("child"));
        assert_eq!(fact("cone.big", Attribute::NumberOfWheels), None);
        let child = find("walker.child").expect("a model");
        assert_eq!([0, 1].map(|variant| child.gender(variant)), ["male", "female"]);
    }

    #[test]
    fn parked_two_wheelers_are_those_that_drive_without_their_riders() {
        for parked in PARKED_TWO_WHEELERS {
            let (found, ridden) = find_parked(parked.name).expect("one with a rider");
            assert_eq!(
                (found, found.base, found.size_m[..2].to_vec()),
                (parked, ridden.base, ridden.size_m[..2].to_vec())
            );
            assert!(found.size_m[2] < ridden.size_m[2] && find(parked.name).is_none());
        }
        assert_eq!(find_parked("bicycle.city"), None);
    }

    #[test]
    fn names_are_unique_and_every_model_has_a_class() {
        for (i, model) in MODELS.iter().enumerate() {
            assert_eq!(MODELS.iter().position(|m| m.name == model.name), Some(i));
            let tags: Vec<u8> = model.base.tags().iter().map(|&t| t as u8).collect();
            assert!(DetectionClass::from_tags(&tags).is_some(), "{}", model.name);
            assert!(model.wheelbase_m < model.size_m[0]);
        }
    }
}
