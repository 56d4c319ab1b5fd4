//! Which vehicles there are on the roads: how common each model is, and its paints.
//!
//! The published datasets draw uniformly from a library of 44 models. Ours has fewer; kinds keep their shares of that
//! library, and the models of a kind share alike.

use crate::models::{BaseType, Model, vehicles};

/// Common paints (sRGB).
const PAINTS: &[[u8; 3]] = &[
    [240, 240, 238],
    [22, 22, 24],
    [120, 124, 128],
    [176, 180, 184],
    [70, 74, 80],
    [132, 16, 20],
    [196, 28, 30],
    [20, 44, 96],
    [44, 92, 160],
    [20, 66, 46],
    [206, 190, 156],
    [96, 62, 40],
    [232, 176, 32],
    [216, 96, 28],
];

/// Whether a model is one of the police, of an ambulance or of the fire brigade.
#[must_use]
pub fn is_emergency(model: &Model) -> bool {
    model.special == "emergency"
}

/// How many models of its kind the library has: ordinary ones or those of emergency services.
fn of_kind(model: &Model) -> f64 {
    match (is_emergency(model), model.base) {
        (false, BaseType::Car) => 26.0,
        (false, BaseType::Truck | BaseType::Van | BaseType::Bicycle) => 3.0,
        (false, BaseType::Motorcycle) => 4.0,
        (false, BaseType::Bus) => 1.0,
        (true, BaseType::Car) => 2.0,
        (true, BaseType::Truck | BaseType::Van) => 1.0,
        _ => 0.0,
    }
}

/// How common a vehicle model is, in models of the library; all vehicles together are 44.
#[must_use]
pub fn weight(model: &Model) -> f64 {
    let alike = |other: &&Model| other.base == model.base && is_emergency(other) == is_emergency(model);
    of_kind(model) / vehicles().filter(alike).count().max(1) as f64
}

/// The colours that a model comes in (sRGB), all equally common.
#[must_use]
pub fn paints(model: &Model) -> &'static [[u8; 3]] {
    match model.name {
        "truck.fire" => &[[178, 22, 22]],
        "car.police" => &[[238, 240, 242]],
        "van.ambulance" => &[[240, 240, 236], [232, 206, 44]],
        "car.taxi" => &[[236, 184, 28], [238, 232, 208], [24, 24, 26]],
        _ => PAINTS,
    }
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
        assert!((sum(&is_emergency) - 4.0).abs() < 1e-9);
        assert!(vehicles().all(|m| weight(m) > 0.0 && !paints(m).is_empty()));
    }
}
