//! The list of all models, and how to find one.

use crate::model::{BaseType, Model, Special};
use crate::{buses, cars, lorries, people, roadside, two_wheelers, vans};

/// Families in the order in which models are drawn.
const FAMILIES: [&[Model]; 13] = [
    cars::FIRST,
    vans::FIRST,
    lorries::FIRST,
    buses::FIRST,
    two_wheelers::FIRST,
    people::FIRST,
    roadside::ALL,
    people::LATER,
    cars::LATER,
    vans::LATER,
    lorries::LATER,
    buses::LATER,
    two_wheelers::LATER,
];

const COUNT: usize = {
    let (mut count, mut family) = (0, 0);
    while family < FAMILIES.len() {
        count += FAMILIES[family].len();
        family += 1;
    }
    count
};

static ALL: [Model; COUNT] = {
    let mut all = [FAMILIES[0][0]; COUNT];
    let (mut next, mut family) = (0, 0);
    while family < FAMILIES.len() {
        let mut member = 0;
        while member < FAMILIES[family].len() {
            all[next] = FAMILIES[family][member];
            (next, member) = (next + 1, member + 1);
        }
        family += 1;
    }
    all
};

/// All models, in the order in which they are drawn.
pub static MODELS: &[Model] = &ALL;

/// Two-wheelers that are parked at a kerb or rack, with nobody on them: those of [`MODELS`], in that order.
pub static PARKED_TWO_WHEELERS: &[Model] = two_wheelers::PARKED;

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

/// The model that a name of SimBEV2X's configurations means, by a part of it; none where no record has such a
/// part.
#[must_use]
pub fn of_simbev2x(name: &str) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.simbev2x.iter().any(|part| name.contains(part)))
}

/// Models that drive in background traffic.
pub fn vehicles() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.wheelbase_m > 0.0)
}

/// Models that walk about alone; police and workers have their places.
pub fn walkers() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|m| m.base == BaseType::Pedestrian && m.special == Special::None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::{Attribute, DetectionClass};

    use crate::body::Body;

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
            assert_eq!(
                sits.as_deref(),
                Some(if model.special == Special::Wheelchair { "true" } else { "false" })
            );
        }
        assert_eq!(fact("walker.child", Attribute::Age).as_deref(), Some("child"));
        assert_eq!(fact("cone.big", Attribute::NumberOfWheels), None);
        let child = find("walker.child").expect("a model");
        assert_eq!([0, 1].map(|variant| child.gender(variant)), ["male", "female"]);
    }

    #[test]
    fn parked_two_wheelers_are_those_that_drive_without_their_riders() {
        for (parked, ridden) in PARKED_TWO_WHEELERS.iter().zip(MODELS.iter().filter(|m| m.frame().is_some()))
        {
            assert_eq!(find_parked(parked.name), Some((parked, ridden)));
            assert_eq!(parked.name, format!("{}.parked", ridden.name));
            assert_eq!((parked.base, &parked.size_m[..2]), (ridden.base, &ridden.size_m[..2]));
            assert!(parked.size_m[2] < ridden.size_m[2] && find(parked.name).is_none());
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

    #[test]
    fn records_are_sound() {
        for model in MODELS.iter().chain(crate::trains::sections()) {
            let Model { name, base, size_m, .. } = *model;
            assert!(name.starts_with(base.family()) || name.starts_with("trailer."), "{name}");
            assert!(size_m.iter().all(|side_m| (0.2..20.0).contains(side_m)), "{name}");
            assert_eq!(model.person.is_some(), base == BaseType::Pedestrian, "{name}");
            assert_eq!(model.axles > 0, base.is_driven(), "{name}");
            assert_eq!(model.paints.is_empty(), !base.is_driven(), "{name}");
            let two_wheels = matches!(base, BaseType::Motorcycle | BaseType::Bicycle);
            assert_eq!(model.wheels, if two_wheels { 2 } else { 2 * model.axles }, "{name}");
            assert!([0, 2, 4].contains(&model.doors) && model.commonness > 0.0, "{name}");
            let fits = match model.body {
                Body::Car(_) => matches!(base, BaseType::Car | BaseType::Van | BaseType::Truck),
                Body::Lorry(_) => base == BaseType::Truck,
                Body::Trailer(_) => model.special == Special::Trailer,
                Body::Bus(_) => base == BaseType::Bus,
                Body::TwoWheeler(_) => two_wheels,
                Body::Person(_) => base == BaseType::Pedestrian,
                Body::Cone(_) => base == BaseType::Cone,
                Body::Barrier(_) => base == BaseType::Barrier,
                Body::Pack => false,
            };
            assert!(fits, "{name}");
        }
    }

    #[test]
    fn no_part_of_a_foreign_name_means_two_models() {
        let parts: Vec<&str> = MODELS.iter().flat_map(|m| m.simbev2x).copied().collect();
        for (i, part) in parts.iter().enumerate() {
            assert!(parts.iter().enumerate().all(|(j, other)| i == j || !other.contains(part)), "{part}");
        }
    }
}
