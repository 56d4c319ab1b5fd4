//! Articulated vehicles: one that drives, and one that it tows. Each section is an object of its own, as
//! nuScenes' annotators have it; sections are met in trains alone, so that [`crate::models::MODELS`] does not
//! list them.
//!
//! Dimensions are of ordinary vehicles of each kind, taken from makers' public data sheets and rounded.

use crate::body::{Body, BusBody, Load};
use crate::model::{BaseType, Model, Special};
use crate::paints::COMMON;

/// One that drives and one that it tows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Train {
    /// The one that drives.
    pub lead: &'static Model,
    /// The one that it tows.
    pub towed: &'static Model,
    /// From the middle of the lead's footprint back to where the other one turns about it, metres.
    pub hitch_m: f64,
    /// From the middle of the towed one's footprint ahead to that place, metres.
    pub coupling_m: f64,
    /// From that place back to the axle of the towed one, or the middle of its axles, metres.
    pub rod_m: f64,
    /// How common it is among trains of its base type, the most common ones 1.
    pub commonness: f64,
}

const TRACTOR: &Model = &Model {
    name: "truck.tractor",
    base: BaseType::Truck,
    size_m: [6.00, 2.50, 3.80],
    wheelbase_m: 3.70,
    wheel_radius_m: 0.50,
    special: Special::None,
    axles: 2,
    wheels: 4,
    doors: 0,
    has_lamps: true,
    commonness: 1.0,
    paints: COMMON,
    simbev2x: &[],
    person: None,
    body: Body::Lorry(Load::Coupling),
};

const fn trailer(name: &'static str, size_m: [f64; 3], load: Load) -> Model {
    Model {
        name,
        base: BaseType::Truck,
        size_m,
        wheelbase_m: 2.62,
        wheel_radius_m: 0.50,
        special: Special::Trailer,
        axles: 3,
        wheels: 6,
        doors: 0,
        has_lamps: true,
        commonness: 1.0,
        paints: COMMON,
        simbev2x: &[],
        person: None,
        body: Body::Trailer(load),
    }
}

const CURTAIN: &Model = &trailer("trailer.curtain", [13.60, 2.55, 4.00], Load::Curtain);
const BOX: &Model = &trailer("trailer.box", [13.60, 2.55, 4.00], Load::Goods { ribbed: true });
const TANKER: &Model = &trailer("trailer.tanker", [12.20, 2.55, 3.60], Load::Tank);
const CONTAINER: &Model = &trailer("trailer.container", [12.60, 2.50, 3.95], Load::Container);

const BUS_FRONT: &Model = &Model {
    name: "bus.articulated",
    base: BaseType::Bus,
    size_m: [10.60, 2.55, 3.10],
    wheelbase_m: 5.90,
    wheel_radius_m: 0.48,
    special: Special::Articulated,
    axles: 2,
    wheels: 4,
    doors: 0,
    has_lamps: true,
    commonness: 1.0,
    paints: COMMON,
    simbev2x: &[],
    person: None,
    body: Body::Bus(BusBody::ArticulatedFront),
};
const BUS_REAR: &Model = &Model {
    name: "bus.articulated_rear",
    size_m: [8.55, 2.55, 3.10],
    wheelbase_m: 0.0,
    axles: 1,
    wheels: 2,
    body: Body::Bus(BusBody::ArticulatedRear),
    ..*BUS_FRONT
};

/// A tractor unit with a semi-trailer whose front is so far ahead of its kingpin, metres.
const fn semi(towed: &'static Model, before_m: f64, rod_m: f64, commonness: f64) -> Train {
    let coupling_m = 0.5 * towed.size_m[0] - before_m;
    Train { lead: TRACTOR, towed, hitch_m: 1.45, coupling_m, rod_m, commonness }
}

/// All of them.
pub const TRAINS: &[Train] = &[
    semi(CURTAIN, 1.6, 7.7, 1.0),
    semi(BOX, 1.6, 7.7, 0.7),
    semi(TANKER, 1.5, 6.9, 0.25),
    semi(CONTAINER, 1.5, 7.4, 0.45),
    // The bellows are a drum about the joint: half of it lies within the front section.
    Train { lead: BUS_FRONT, towed: BUS_REAR, hitch_m: 5.30, coupling_m: 3.125, rod_m: 4.0, commonness: 1.0 },
];

/// Sections of trains, each once: those that drive, and those that are towed.
pub fn sections() -> impl Iterator<Item = &'static Model> {
    let all = || TRAINS.iter().flat_map(|train| [train.lead, train.towed]);
    all()
        .enumerate()
        .filter(move |(i, model)| all().take(*i).all(|other| other.name != model.name))
        .map(|(_, m)| m)
}

/// The section with a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Model> {
    sections().find(|model| model.name == name)
}

/// The train that tows a section with a name.
#[must_use]
pub fn of_towed(name: &str) -> Option<&'static Train> {
    TRAINS.iter().find(|train| train.towed.name == name)
}

/// Trains of a base type, each with how common it is.
#[must_use]
pub fn of_base(base: BaseType) -> Vec<(&'static Train, f64)> {
    TRAINS.iter().filter(|train| train.lead.base == base).map(|train| (train, train.commonness)).collect()
}

impl Train {
    /// From the middle of the lead's footprint back to the middle of the towed one's, when they stand in
    /// line, metres.
    #[must_use]
    pub fn apart_m(&self) -> f64 {
        self.hitch_m + self.coupling_m
    }

    /// From the middle of the lead's footprint back to the rear of the train, when it stands in line, metres.
    #[must_use]
    pub fn rear_m(&self) -> f64 {
        self.apart_m() + 0.5 * self.towed.size_m[0]
    }

    /// Radius on which the towed one's axle goes round, when the lead's middle has gone round for long on a
    /// circle, metres; 0 where the circle is too tight for that. With a half wheelbase h, the lead's rear
    /// axle is on `R^2 - h^2`; the hitch, e behind it, on `+ e^2`; the axle, which rolls at a right angle to
    /// its rod L, on `- L^2`.
    #[must_use]
    pub fn axle_radius_m(&self, radius_m: f64) -> f64 {
        let half_base_m = 0.5 * self.lead.wheelbase_m;
        let behind_m = self.hitch_m - half_base_m;
        let square = radius_m * radius_m - half_base_m * half_base_m + behind_m * behind_m;
        (square - self.rod_m * self.rod_m).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models;

    #[test]
    fn sections_are_met_in_trains_alone() {
        let names: Vec<&str> = sections().map(|m| m.name).collect();
        assert_eq!(names.len(), 7);
        for name in names {
            assert!(models::find(name).is_none() && find(name).is_some_and(|m| m.name == name));
        }
        for train in TRAINS {
            assert_eq!(of_towed(train.towed.name), Some(train));
            assert!(of_towed(train.lead.name).is_none());
            assert_eq!(train.lead.base, train.towed.base);
        }
    }

    #[test]
    fn trains_are_as_long_as_the_law_allows() {
        for train in TRAINS {
            let long_m = 0.5 * train.lead.size_m[0] + train.rear_m();
            // Directive 96/53/EC: 16.5 m with a semi-trailer, 18.75 m articulated buses; kingpins 2.04 m from
            // the front corners.
            let most_m = if train.lead.base == BaseType::Bus { 18.75 } else { 16.5 };
            assert!((14.0..=most_m).contains(&long_m), "{}: {long_m}", train.towed.name);
            let ahead_m = 0.5 * train.towed.size_m[0] - train.coupling_m;
            let aside_m = 0.5 * train.towed.size_m[1];
            let corner_m = (ahead_m * ahead_m + aside_m * aside_m).sqrt();
            assert!(corner_m <= 2.06, "{}: {corner_m}", train.towed.name);
            // Its axle is under it.
            assert!(
                train.rod_m - train.coupling_m < 0.5 * train.towed.size_m[0] - train.towed.wheel_radius_m
            );
        }
    }

    #[test]
    fn trailers_cut_corners() {
        let train = of_towed("trailer.box").expect("a train");
        // 20^2 - 1.85^2 + 0.4^2 - 7.7^2 = 337.4475
        assert!((train.axle_radius_m(20.0) - 337.4475_f64.sqrt()).abs() < 1e-9);
        assert_eq!(train.axle_radius_m(6.0), 0.0);
    }
}
