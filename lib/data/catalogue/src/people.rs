//! People.

use crate::body::{Body, PersonBody};
use crate::model::{Age, BaseType, Gender, Model, Person, Special};

/// Somebody on foot, with what they take along in the box about them (length, width, height, metres).
const fn on_foot(name: &'static str, size_m: [f64; 3], special: Special, age: Age, gender: Gender) -> Model {
    Model {
        name,
        base: BaseType::Pedestrian,
        size_m,
        wheelbase_m: 0.0,
        wheel_radius_m: 0.0,
        special,
        axles: 0,
        wheels: 0,
        doors: 0,
        has_lamps: false,
        commonness: 1.0,
        paints: &[],
        simbev2x: &[],
        person: Some(Person { age, gender }),
        body: Body::Person(PersonBody::OnFoot),
    }
}

/// Somebody of the police.
pub const POLICE: Model =
    on_foot("walker.police", [0.42, 0.60, 1.84], Special::Police, Age::Adult, Gender::FemaleOneOf(4));
/// A worker on the road.
pub const WORKER: Model =
    on_foot("walker.worker", [0.42, 0.60, 1.86], Special::Worker, Age::Adult, Gender::FemaleOneOf(4));
/// Somebody in a wheelchair.
pub const WHEELCHAIR: Model = Model {
    wheel_radius_m: 0.31,
    body: Body::Person(PersonBody::Wheelchair),
    ..on_foot(
        "walker.wheelchair",
        [1.10, 0.66, 1.32],
        Special::Wheelchair,
        Age::Adult,
        Gender::FemaleOneOf(2),
    )
};
/// A person who pushes a pram.
pub const WITH_PRAM: Model =
    on_foot("walker.with_pram", [1.47, 0.60, 1.68], Special::Pram, Age::Adult, Gender::FemaleOneOf(2));
/// A person who leads a dog.
pub const WITH_DOG: Model =
    on_foot("walker.with_dog", [0.80, 0.74, 1.70], Special::Dog, Age::Adult, Gender::FemaleOneOf(2));

/// Those of the first release.
pub(crate) const FIRST: &[Model] = {
    use Special::None;
    &[
        on_foot("walker.man", [0.40, 0.58, 1.78], None, Age::Adult, Gender::Male),
        on_foot("walker.woman", [0.36, 0.52, 1.65], None, Age::Adult, Gender::Female),
        on_foot("walker.tall", [0.42, 0.60, 1.90], None, Age::Adult, Gender::Male),
        on_foot("walker.elder", [0.38, 0.55, 1.62], None, Age::Elder, Gender::FemaleOneOf(2)),
        on_foot("walker.child", [0.28, 0.38, 1.25], None, Age::Child, Gender::FemaleOneOf(2)),
        POLICE,
        WORKER,
    ]
};

/// Those that came later; new ones are appended.
pub(crate) const LATER: &[Model] = &[
    on_foot("walker.teen", [0.38, 0.52, 1.60], Special::None, Age::Teen, Gender::FemaleOneOf(2)),
    WHEELCHAIR,
    WITH_PRAM,
    WITH_DOG,
];
