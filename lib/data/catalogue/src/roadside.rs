//! Cones and barriers about hazards.

use crate::body::{BarrierBody, Body, ConeBody};
use crate::model::{BaseType, Model, Special};

/// A thing without wheels, lamps and paint.
const fn thing(name: &'static str, size_m: [f64; 3], base: BaseType, body: Body) -> Model {
    Model {
        name,
        base,
        size_m,
        wheelbase_m: 0.0,
        wheel_radius_m: 0.0,
        special: Special::None,
        axles: 0,
        wheels: 0,
        doors: 0,
        has_lamps: false,
        commonness: 1.0,
        paints: &[],
        simbev2x: &[],
        person: None,
        body,
    }
}

const fn cone(name: &'static str, size_m: [f64; 3], body: ConeBody) -> Model {
    thing(name, size_m, BaseType::Cone, Body::Cone(body))
}

const fn barrier(name: &'static str, size_m: [f64; 3], body: BarrierBody) -> Model {
    thing(name, size_m, BaseType::Barrier, Body::Barrier(body))
}

/// A block of concrete.
pub const CONCRETE: Model = barrier("barrier.concrete", [2.00, 0.58, 0.82], BarrierBody::Concrete);

/// All of them; new ones are appended.
pub(crate) const ALL: &[Model] = &[
    cone("cone.traffic", [0.36, 0.36, 0.72], ConeBody::Traffic),
    cone("cone.plain", [0.30, 0.30, 0.50], ConeBody::Plain),
    cone("cone.big", [0.48, 0.48, 0.95], ConeBody::Big),
    cone("cone.barrel", [0.58, 0.58, 1.02], ConeBody::Barrel),
    cone("cone.skinny", [0.34, 0.34, 1.07], ConeBody::Skinny),
    cone("cone.construction", [0.38, 0.38, 0.76], ConeBody::Construction),
    cone("cone.small", [0.24, 0.24, 0.32], ConeBody::Small),
    barrier("barrier.street", [1.20, 0.45, 1.00], BarrierBody::Street),
    CONCRETE,
    barrier("barrier.wooden", [1.50, 0.60, 1.05], BarrierBody::Wooden),
];
