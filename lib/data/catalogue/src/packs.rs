//! The models of a dataset: the built-in ones, and those of packs in their place or beside them.

use std::sync::{Mutex, PoisonError};

use schema::tables::PlanModelRow;

use crate::body::Body;
use crate::fleet;
use crate::model::{Age, BaseType, Gender, Model, Person, Special};
use crate::models::{self, MODELS};
use crate::paints::COMMON;

/// The models that a dataset is planned and simulated with. Functions that draw models take it as an
/// argument.
#[derive(Debug, Default, PartialEq)]
pub struct Catalogue {
    /// Those of packs, by name, with their weights.
    own: Vec<(&'static Model, f64)>,
}

static BUILT_IN: Catalogue = Catalogue { own: Vec::new() };

impl Catalogue {
    /// The built-in models alone.
    #[must_use]
    pub fn built_in() -> &'static Self {
        &BUILT_IN
    }

    /// The built-in models with those of a plan's packs. Rows of an unknown base type are passed over.
    #[must_use]
    pub fn with(rows: &[PlanModelRow]) -> Self {
        let of = |row: &PlanModelRow| Some((kept(row)?, row.weight));
        let mut own: Vec<(&'static Model, f64)> = rows.iter().filter_map(of).collect();
        own.sort_by_key(|(model, _)| model.name);
        Self { own }
    }

    /// Whether no pack adds to the built-in models.
    #[must_use]
    pub fn is_built_in(&self) -> bool {
        self.own.is_empty()
    }

    fn own(&self, name: &str) -> Option<&(&'static Model, f64)> {
        self.own.iter().find(|(model, _)| model.name == name)
    }

    /// The model with a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&'static Model> {
        self.own(name).map(|(model, _)| *model).or_else(|| crate::models::find(name))
    }

    /// All models: the built-in ones in their order, or what replaces them, then those that packs add, by
    /// name.
    pub fn models(&self) -> impl Iterator<Item = &'static Model> {
        let built_in = MODELS.iter().map(|model| self.own(model.name).map_or(model, |(own, _)| own));
        built_in.chain(self.added().map(|(model, _)| model))
    }

    /// Models with names that no built-in one has, with their weights.
    fn added(&self) -> impl Iterator<Item = (&'static Model, f64)> {
        self.own.iter().copied().filter(|(model, _)| crate::models::find(model.name).is_none())
    }

    /// Models of a base type that packs add to the built-in ones, with their weights.
    #[must_use]
    pub fn added_of(&self, base: BaseType) -> Vec<(&'static Model, f64)> {
        self.added().filter(|(model, _)| model.base == base).collect()
    }

    /// Models that drive in background traffic.
    pub fn vehicles(&self) -> impl Iterator<Item = &'static Model> {
        self.models().filter(|m| m.wheelbase_m > 0.0)
    }

    /// People who walk about, each with how common they are: 1 of each built-in one, or what its pack says.
    #[must_use]
    pub fn walkers(&self) -> Vec<(&'static Model, f64)> {
        let built_in = crate::models::walkers().map(|m| self.own(m.name).map_or((m, 1.0), |own| *own));
        built_in.chain(self.added_of(BaseType::Pedestrian)).collect()
    }

    /// All that packs add, as bytes that name it: equal ones are of equal models.
    #[must_use]
    pub fn identity(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (model, weight) in &self.own {
            // A new field must be named here: whether and how it is written. A pack says nothing of the last
            // ones.
            let Model { name, base, size_m, wheelbase_m, wheel_radius_m, special, .. } = model;
            let Model { doors, wheels, has_lamps, person, .. } = model;
            let Model { axles: _, commonness: _, paints: _, simbev2x: _, body: _, .. } = model;
            let mut text = |text: &str| {
                bytes.extend((text.len() as u64).to_le_bytes());
                bytes.extend(text.as_bytes());
            };
            let age = person.map_or(Age::Adult, |person| person.age).name();
            [name, base.name(), special.name(), age, model.gender(0)].into_iter().for_each(&mut text);
            bytes.extend([*doors, *wheels, u8::from(*has_lamps)]);
            let numbers = size_m.iter().chain([wheelbase_m, wheel_radius_m, weight]);
            bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
        }
        bytes
    }

    /// How common a vehicle is: as its pack says, or [`fleet::weight`].
    #[must_use]
    pub fn weight(&self, model: &Model) -> f64 {
        self.own(model.name).map_or_else(|| fleet::weight(model), |(_, weight)| *weight)
    }
}

/// A model that stays for as long as the process does: models are handed about as `&'static` all over
/// traffic, and a pack has few. Equal ones are kept once, however many scenes ask for them; nothing but
/// memory depends on what is kept.
fn kept(row: &PlanModelRow) -> Option<&'static Model> {
    static KEPT: Mutex<Vec<&'static Model>> = Mutex::new(Vec::new());
    let gender = if row.gender == Gender::NAMES[1] { Gender::Female } else { Gender::Male };
    let base = BaseType::from_name(&row.base_type)?;
    let wanted = |name| Model {
        name,
        base,
        size_m: row.size_m,
        wheelbase_m: row.wheelbase_m,
        wheel_radius_m: row.wheel_radius_m,
        special: Special::from_name(&row.special).unwrap_or_default(),
        axles: 2,
        wheels: row.wheels.min(u32::from(u8::MAX)) as u8,
        doors: row.doors.min(4) as u8,
        has_lamps: row.has_lights,
        commonness: row.weight,
        paints: models::find(name).map_or(COMMON, |replaced| replaced.paints),
        simbev2x: &[],
        person: Some(Person { age: Age::from_name(&row.age), gender }),
        body: Body::Pack,
    };
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(model) = all.iter().find(|model| model.name == row.name && ***model == wanted(model.name)) {
        return Some(model);
    }
    let name: &'static str = Box::leak(row.name.clone().into_boxed_str());
    let model: &'static Model = Box::leak(Box::new(wanted(name)));
    all.push(model);
    Some(model)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, base: &str, weight: f64) -> PlanModelRow {
        PlanModelRow {
            name: name.into(),
            base_type: base.into(),
            size_m: [4.0, 2.0, 1.5],
            wheelbase_m: 2.5,
            doors: 2,
            wheels: 6,
            weight,
            ..PlanModelRow::default()
        }
    }

    #[test]
    fn packs_replace_and_add() {
        let all = Catalogue::with(&[row("van.kiosk", "van", 3.0), row("car.sedan", "car", 0.5)]);
        let names: Vec<&str> = all.models().map(|m| m.name).collect();
        let built_in: Vec<&str> = MODELS.iter().map(|m| m.name).collect();
        assert_eq!(names[..built_in.len()], built_in);
        assert_eq!(names[built_in.len()..], ["van.kiosk"]);
        let sedan = all.find("car.sedan").expect("a model");
        assert_eq!((sedan.size_m[0], sedan.doors, all.weight(sedan)), (4.0, 2, 0.5));
        let (van, coupe) = (all.find("van.kiosk").expect("a model"), all.find("car.coupe").expect("a model"));
        assert_eq!((all.weight(van), all.weight(coupe)), (3.0, fleet::weight(coupe)));
        assert_eq!(all.vehicles().filter(|m| m.name == "van.kiosk").count(), 1);
        assert_eq!(all.added_of(BaseType::Van), [(van, 3.0)]);
        assert_eq!(all.added_of(BaseType::Car), []);
        let wheels = van.facts().get(&schema::Attribute::NumberOfWheels).map(str::to_owned);
        assert_eq!(wheels.as_deref(), Some("6"));
    }

    #[test]
    fn every_fact_of_a_pack_is_in_its_identity() {
        let model = || row("van.kiosk", "van", 3.0);
        let changed: [fn(&mut PlanModelRow); 11] = [
            |row| row.name = "van.stall".into(),
            |row| row.base_type = "truck".into(),
            |row| row.special = "taxi".into(),
            |row| row.size_m[2] = 1.6,
            |row| row.wheelbase_m = 2.6,
            |row| row.wheel_radius_m = 0.4,
            |row| row.doors = 4,
            |row| row.wheels = 4,
            |row| row.has_lights = !row.has_lights,
            |row| row.age = "child".into(),
            |row| row.weight = 2.0,
        ];
        let identity = |row: PlanModelRow| Catalogue::with(&[row]).identity();
        assert_eq!(identity(model()), identity(model()));
        let mut all = vec![identity(model())];
        for change in changed {
            let mut other = model();
            change(&mut other);
            all.push(identity(other));
        }
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 12);
        assert!(Catalogue::built_in().identity().is_empty());
    }

    #[test]
    fn people_of_packs_walk_among_the_others() {
        let own = PlanModelRow {
            age: "child".into(),
            gender: "female".into(),
            ..row("walker.ada", "pedestrian", 2.0)
        };
        let all = Catalogue::with(&[own, row("walker.man", "pedestrian", 0.0)]);
        let walkers = all.walkers();
        let weight = |name: &str| walkers.iter().find(|(m, _)| m.name == name).map(|(_, weight)| *weight);
        assert_eq!(
            ["walker.ada", "walker.man", "walker.woman"].map(weight),
            [Some(2.0), Some(0.0), Some(1.0)]
        );
        assert_eq!(walkers.len(), crate::models::walkers().count() + 1);
        let ada = all.find("walker.ada").expect("a model");
        let age = ada.facts().get(&schema::Attribute::Age).map(str::to_owned);
        assert_eq!((ada.gender(0), age.as_deref()), ("female", Some("child")));
    }

    #[test]
    fn without_packs_it_is_the_table() {
        let all = Catalogue::built_in();
        assert!(all.is_built_in() && all.models().eq(MODELS.iter()));
        assert!(all.vehicles().eq(crate::models::vehicles()));
        assert!(all.vehicles().all(|m| all.weight(m) == fleet::weight(m)));
        assert!(all.walkers().into_iter().eq(crate::models::walkers().map(|m| (m, 1.0))));
    }

    #[test]
    fn equal_models_are_kept_once() {
        let find = || Catalogue::with(&[row("van.twice", "van", 1.0)]).find("van.twice").expect("a model");
        assert!(std::ptr::eq(find(), find()));
    }
}
