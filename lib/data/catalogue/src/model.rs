//! What a record holds.

use schema::{Attribute, Attributes, Tag};

use crate::body::{Body, CarBody, Frame};

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

/// One model: everything that is known of it.
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
    /// What is special about it.
    pub special: Special,
    /// Axles.
    pub axles: u8,
    /// Wheels.
    pub wheels: u8,
    /// Doors that open: none, the two in front, or four.
    pub doors: u8,
    /// Whether it has lamps.
    pub has_lamps: bool,
    /// How common it is among models of its kind, the most common ones 1: rough shares of what registers of
    /// vehicles count.
    pub commonness: f64,
    /// Its colours (sRGB), each as often as it is common.
    pub paints: &'static [[u8; 3]],
    /// Parts of names in SimBEV2X's configurations that mean this model.
    pub simbev2x: &'static [&'static str],
    /// Of people: age and gender.
    pub person: Option<Person>,
    /// What it looks like.
    pub body: Body,
}

/// What is special about a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Special {
    /// Nothing.
    #[default]
    None,
    /// A vehicle of the police, an ambulance or the fire brigade.
    Emergency,
    /// A taxi.
    Taxi,
    /// An electric vehicle.
    Electric,
    /// A semi-trailer.
    Trailer,
    /// A section of an articulated bus.
    Articulated,
    /// Somebody of the police.
    Police,
    /// A worker on the road.
    Worker,
    /// Somebody in a wheelchair.
    Wheelchair,
    /// A person who pushes a pram.
    Pram,
    /// A person who leads a dog.
    Dog,
}

/// Age and gender of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Person {
    /// How old.
    pub age: Age,
    /// Man or woman.
    pub gender: Gender,
}

/// How old somebody is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Age {
    Child,
    Teen,
    Adult,
    Elder,
}

/// Man or woman.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gender {
    /// All are men or boys.
    Male,
    /// All are women or girls.
    Female,
    /// One of so many is a woman or girl: of the variants, counted from 0, each that many's last.
    FemaleOneOf(u32),
}

/// Model of a road-side unit: its pole.
pub const RSU_MODEL: &str = "rsu.pole";

impl Special {
    /// All of them.
    pub const ALL: [Self; 11] = {
        use Special::*;
        [None, Emergency, Taxi, Electric, Trailer, Articulated, Police, Worker, Wheelchair, Pram, Dog]
    };

    /// Name in attributes; empty where there is nothing special.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Emergency => "emergency",
            Self::Taxi => "taxi",
            Self::Electric => "electric",
            Self::Trailer => "trailer",
            Self::Articulated => "articulated",
            Self::Police => "police",
            Self::Worker => "worker",
            Self::Wheelchair => "wheelchair",
            Self::Pram => "pram",
            Self::Dog => "dog",
        }
    }

    /// What a name says.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|special| special.name() == name)
    }
}

impl Age {
    /// Names in attributes.
    pub const NAMES: [&str; 3] = ["adult", "child", "elderly"];

    /// Name in attributes: teens are children.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Child | Self::Teen => "child",
            Self::Adult => "adult",
            Self::Elder => "elderly",
        }
    }

    /// The age of a name; adult where there is none of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        match name {
            "child" => Self::Child,
            "elderly" => Self::Elder,
            _ => Self::Adult,
        }
    }
}

impl Gender {
    /// Names in attributes.
    pub const NAMES: [&str; 2] = ["male", "female"];
}

impl Model {
    /// How far the springs of a vehicle on four wheels let its body come down on a wheel, or up from it,
    /// metres: less than there is room in the arches. Lorries and buses are stiff.
    #[must_use]
    pub fn spring_travel_m(&self) -> f64 {
        let share = if matches!(self.base, BaseType::Truck | BaseType::Bus) { 0.05 } else { 0.1 };
        share * self.wheel_radius_m
    }

    /// What is on it, of cars, vans and pickups.
    #[must_use]
    pub fn car_body(&self) -> Option<&'static CarBody> {
        if let Body::Car(body) = self.body { Some(body) } else { None }
    }

    /// Whether a pack brings it.
    #[must_use]
    pub fn is_of_pack(&self) -> bool {
        self.body == Body::Pack
    }

    /// What it is built like, of motorcycles, bicycles and kick scooters.
    #[must_use]
    pub fn frame(&self) -> Option<Frame> {
        if let Body::TwoWheeler(body) = self.body { Some(body.frame) } else { None }
    }

    /// `male` or `female`; people without a record are men.
    #[must_use]
    pub fn gender(&self, variant: u32) -> &'static str {
        let is_female = match self.person.map(|person| person.gender) {
            Some(Gender::Female) => true,
            Some(Gender::FemaleOneOf(n)) => variant % n == n - 1,
            Some(Gender::Male) | None => false,
        };
        Gender::NAMES[usize::from(is_female)]
    }

    /// What is true of every object of the model, for its attributes. ([`Model::gender`] depends on the
    /// object.)
    #[must_use]
    pub fn facts(&self) -> Attributes {
        let facts = Attributes::new()
            .with(Attribute::BaseType, self.base.name())
            .with(Attribute::SpecialType, self.special.name());
        match self.base {
            BaseType::Pedestrian => {
                let sits = self.special == Special::Wheelchair;
                facts
                    .with(Attribute::Age, self.person.map_or(Age::Adult, |person| person.age).name())
                    .with(Attribute::Generation, GENERATION)
                    .with(Attribute::CanUseWheelchair, sits)
                    .with(Attribute::UseWheelchair, sits)
                    .with(Attribute::IsInvincible, false)
            }
            BaseType::Cone | BaseType::Barrier => facts,
            _ => facts
                .with(Attribute::NumberOfWheels, u32::from(self.wheels))
                .with(Attribute::HasLights, self.has_lamps)
                .with(Attribute::HasDynamicDoors, self.doors > 0)
                .with(Attribute::Generation, GENERATION),
        }
    }
}

/// See [`Attribute::Generation`].
const GENERATION: u32 = 2;

/// How far a vehicle of a length and width reaches inwards and outwards from a circle that its middle goes
/// round on, metres: with a half wheelbase h, its rear axle goes round on a circle of radius sqrt(R^2 - h^2),
/// and its outer front corner's circle follows from the side and the front.
#[must_use]
pub fn swept_m([length_m, width_m]: [f64; 2], half_base_m: f64, radius_m: f64) -> [f64; 2] {
    let rear = (radius_m * radius_m - half_base_m * half_base_m).max(0.0).sqrt();
    let (side, front) = (rear + 0.5 * width_m, half_base_m + 0.5 * length_m);
    [radius_m - rear + 0.5 * width_m, (side * side + front * front).sqrt() - radius_m]
}
