//! Buses.

use crate::body::{Body, BusBody};
use crate::model::{BaseType, Model, Special};
use crate::paints::COMMON;

/// Those of the first release.
pub(crate) const FIRST: &[Model] = &[Model {
    name: "bus.city",
    base: BaseType::Bus,
    size_m: [12.00, 2.55, 3.10],
    wheelbase_m: 5.90,
    wheel_radius_m: 0.48,
    special: Special::None,
    axles: 2,
    wheels: 4,
    doors: 0,
    has_lamps: true,
    commonness: 1.0,
    paints: COMMON,
    simbev2x: &["fusorosa"],
    person: None,
    body: Body::Bus(BusBody::City),
}];

/// Those that came later; new ones are appended.
pub(crate) const LATER: &[Model] = &[
    Model {
        name: "bus.coach",
        base: BaseType::Bus,
        size_m: [12.00, 2.55, 3.65],
        wheelbase_m: 6.10,
        wheel_radius_m: 0.50,
        special: Special::None,
        axles: 2,
        wheels: 4,
        doors: 0,
        has_lamps: true,
        commonness: 0.35,
        paints: COMMON,
        simbev2x: &[],
        person: None,
        body: Body::Bus(BusBody::Coach),
    },
    Model {
        name: "bus.school",
        base: BaseType::Bus,
        size_m: [10.60, 2.45, 3.10],
        wheelbase_m: 5.50,
        wheel_radius_m: 0.48,
        special: Special::None,
        axles: 2,
        wheels: 4,
        doors: 0,
        has_lamps: true,
        commonness: 0.2,
        paints: &[[226, 150, 10]],
        simbev2x: &[],
        person: None,
        body: Body::Bus(BusBody::School),
    },
];
