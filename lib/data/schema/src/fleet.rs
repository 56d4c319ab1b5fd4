//! Which vehicles there are on the roads: how common each model is, and its paints.
//!
//! The published datasets draw uniformly from a library of 44 models. Kinds keep their shares of that library; the models of
//! a kind share as they are common on roads.

use crate::models::{BaseType, Model, vehicles};

/// Forty paints (sRGB), and how many of two hundred vehicles have each: close to what makers of paint publish of the colours of new
/// cars worldwide. A third are white, a fifth black, nearly as many grey; then silver, blue, red, brown, green, others.
const SHADES: [([u8; 3], usize); 40] = [
    ([242, 243, 242], 30),
    ([234, 233, 226], 20),
    ([226, 226, 220], 10),
    ([216, 222, 226], 6),
    ([18, 18, 20], 20),
    ([26, 28, 34], 8),
    ([38, 38, 40], 8),
    ([36, 30, 28], 4),
    ([84, 87, 91], 10),
    ([108, 112, 116], 8),
    ([62, 65, 70], 7),
    ([130, 132, 132], 5),
    ([98, 100, 96], 4),
    ([142, 140, 134], 2),
    ([184, 187, 190], 7),
    ([166, 170, 174], 5),
    ([198, 199, 198], 4),
    ([176, 174, 166], 2),
    ([22, 42, 88], 5),
    ([36, 66, 122], 3),
    ([48, 96, 164], 3),
    ([70, 92, 116], 2),
    ([20, 58, 140], 2),
    ([122, 164, 196], 1),
    ([150, 18, 24], 4),
    ([190, 26, 30], 3),
    ([110, 20, 30], 2),
    ([206, 44, 36], 1),
    ([92, 66, 48], 2),
    ([190, 176, 148], 2),
    ([64, 48, 40], 1),
    ([150, 126, 96], 1),
    ([26, 62, 48], 1),
    ([72, 86, 66], 1),
    ([40, 88, 84], 1),
    ([128, 146, 104], 1),
    ([232, 188, 40], 1),
    ([196, 164, 92], 1),
    ([218, 98, 30], 1),
    ([76, 44, 92], 1),
];

/// Every paint as often as vehicles have it.
const PAINTS: [[u8; 3]; 200] = {
    let mut paints = [[0; 3]; 200];
    let (mut shade, mut of_shade, mut i) = (0, 0, 0);
    while i < paints.len() {
        paints[i] = SHADES[shade].0;
        of_shade += 1;
        if of_shade == SHADES[shade].1 {
            (shade, of_shade) = (shade + 1, 0);
        }
        i += 1;
    }
    paints
};

/// Whether a model is one of the police, of an ambulance or of the fire brigade.
#[must_use]
pub fn is_emergency(model: &Model) -> bool {
    model.special == "emergency"
}

/// So many of the library's motorcycles are with the police; it has none.
const POLICE_MOTORCYCLES: f64 = 0.2;

/// How common a model is among those of its kind, the most common ones 1: rough shares of what registers of vehicles count.
fn commonness(model: &Model) -> f64 {
    match model.name.trim_end_matches(".parked") {
        "car.coupe" | "car.offroad" | "car.offroad_large" | "car.liftback" => 0.6,
        "car.sports" | "car.micro" | "car.limousine" | "car.taxi" => 0.4,
        "car.cab" => 0.2,
        "van.passenger" => 0.7,
        "van.camper" | "van.minibus" | "van.parcel" => 0.3,
        "van.motorhome" => 0.15,
        "truck.heavy" | "truck.curtain" => 0.8,
        "truck.dropside" | "truck.flatbed" | "truck.tipper" => 0.4,
        "truck.mixer" | "truck.tanker" | "truck.refuse" | "truck.ladder" => 0.25,
        "truck.tow" | "truck.sweeper" => 0.12,
        "bus.coach" => 0.35,
        "bus.school" => 0.2,
        "motorcycle.moped" | "bicycle.kick" => 0.5,
        "bicycle.cargo" => 0.2,
        _ => 1.0,
    }
}

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
    let of_all = vehicles().filter(alike).map(commonness).sum::<f64>().max(f64::MIN_POSITIVE);
    of_kind(model) * commonness(model) / of_all
}

/// The colours that a model comes in (sRGB), each as often as it is common.
#[must_use]
pub fn paints(model: &Model) -> &'static [[u8; 3]] {
    match model.name {
        "truck.fire" | "truck.ladder" => &[[178, 22, 22]],
        "car.police" | "motorcycle.police" => &[[238, 240, 242]],
        "van.ambulance" => &[[240, 240, 236], [232, 206, 44]],
        "bus.school" => &[[226, 150, 10]],
        "truck.refuse" | "truck.sweeper" => &[[222, 96, 16], [236, 236, 230], [70, 132, 60]],
        "car.taxi" | "car.cab" => &[[236, 184, 28], [238, 232, 208], [24, 24, 26]],
        _ => &PAINTS,
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
        assert!((sum(&is_emergency) - 4.0 - POLICE_MOTORCYCLES).abs() < 1e-9);
        assert!(vehicles().all(|m| weight(m) > 0.0 && !paints(m).is_empty()));
        // What one seldom meets is seldom.
        let all = sum(&|_| true);
        for name in
            ["truck.sweeper", "truck.tow", "truck.mixer", "van.motorhome", "bicycle.cargo", "truck.ladder"]
        {
            let rare = crate::models::find(name).map(weight);
            assert!(rare.is_some_and(|weight| weight < 0.007 * all), "{name}: {rare:?} of {all}");
        }
    }

    #[test]
    fn forty_paints_are_as_common_as_they_say() {
        assert_eq!(SHADES.iter().map(|(_, of_200)| of_200).sum::<usize>(), PAINTS.len());
        for (i, (rgb, of_200)) in SHADES.iter().enumerate() {
            assert_eq!(PAINTS.iter().filter(|paint| *paint == rgb).count(), *of_200, "{rgb:?}");
            assert!(SHADES[..i].iter().all(|(other, _)| other != rgb));
        }
        // White, black, grey and silver are what eight of ten are.
        let grey = |[r, g, b]: &[u8; 3]| r.max(g).max(b) - r.min(g).min(b) <= 12;
        let share = PAINTS.iter().filter(|paint| grey(paint)).count() as f64 / PAINTS.len() as f64;
        assert!((0.75..0.85).contains(&share), "{share}");
    }
}
