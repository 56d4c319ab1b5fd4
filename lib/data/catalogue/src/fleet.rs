//! Which vehicles there are on the roads: how common each model is.
//!
//! The published datasets draw uniformly from a library of 44 models. Kinds keep their shares of that
//! library; the models of a kind share as they are common on roads.

use crate::model::{BaseType, Model, Special};
use crate::models::vehicles;

/// Whether a model is one of the police, of an ambulance or of the fire brigade.
#[must_use]
pub fn is_emergency(model: &Model) -> bool {
    model.special == Special::Emergency
}

/// So many of the library's motorcycles are with the police; it has none.
const POLICE_MOTORCYCLES: f64 = 0.2;

/// How many models of its kind the library has: ordinary ones or those of emergency services.
fn of_kind(model: &Model) -> f64 {
    match (is_emergency(model), model.base) {
        (false, BaseType::Car) => 26.0,
        (false, BaseType::Truck | BaseType::Van | BaseType::Bicycle) => 3.0,
        (false, BaseType::Motorcycle) => 4.0 - POLICE_MOTORCYCLES,
        (false, BaseType::Bus) => 1.0,
        (true, BaseType::Car) => 2.0,
        (true, BaseType::Truck | BaseType::Van) => 1.0,
        (true, BaseType::Motorcycle) => POLICE_MOTORCYCLES,
        _ => 0.0,
    }
}

/// How common a vehicle model is, in models of the library; all vehicles together are 44.
#[must_use]
pub fn weight(model: &Model) -> f64 {
    let alike = |other: &&Model| other.base == model.base && is_emergency(other) == is_emergency(model);
    let of_all = vehicles().filter(alike).map(|model| model.commonness).sum::<f64>().max(f64::MIN_POSITIVE);
    of_kind(model) * model.commonness / of_all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_have_the_shares_of_the_library() {
        let sum = |of: &dyn Fn(&Model) -> bool| vehicles().filter(|m| of(m)).map(weight).sum::<f64>();
        use BaseType::{Bicycle, Bus, Car, Motorcycle, Truck, Van};
        for (base, models) in
            [(Car, 28.0), (Truck, 4.0), (Van, 4.0), (Bus, 1.0), (Motorcycle, 4.0), (Bicycle, 3.0)]
        {
            assert!((sum(&|m| m.base == base) - models).abs() < 1e-9, "{base:?}");
        }
        assert!((sum(&is_emergency) - 4.0 - POLICE_MOTORCYCLES).abs() < 1e-9);
        assert!(vehicles().all(|m| weight(m) > 0.0));
        // What one seldom meets is seldom.
        let all = sum(&|_| true);
        for name in
            ["truck.sweeper", "truck.tow", "truck.mixer", "van.motorhome", "bicycle.cargo", "truck.ladder"]
        {
            let rare = crate::models::find(name).map(weight);
            assert!(rare.is_some_and(|weight| weight < 0.007 * all), "{name}: {rare:?} of {all}");
        }
    }
}
