//! Meshes of everything that stands or moves in a scene, made from a model name, a size and a variant.
//!
//! [`actor_mesh`] makes them; wheels, limbs and doors are pieces of the same object that hang on [`Joint`]s.
//!
//! ```
//! use meshes::actors::{Posture, actor_mesh};
//!
//! let car = actor_mesh("car.sedan", [4.7, 1.84, 1.44], 0).unwrap();
//! // Body, four wheels, four doors and what shows behind them; closed doors are not to be seen.
//! let parked = Posture::default();
//! let shown = car.pieces.iter().filter(|p| p.joint.object_from_piece(&parked).is_some()).count();
//! assert_eq!((car.pieces.len(), shown), (13, 5));
//! ```

mod ambient_occlusion;
mod bodies;
mod brigade;
mod building;
mod bus;
mod cabin;
mod canvas;
mod car;
mod cones;
mod decal;
mod device;
mod furniture;
mod heavy;
mod hull;
mod load;
mod lorry;
mod motorcycle;
mod pieces;
mod plants;
mod plates;
mod pod;
mod posture;
mod props;
mod rig;
mod sign;
mod signal;
mod skin;
mod street;
mod tanks;
mod trailer;
mod two_wheeler;
mod warning;
mod wheel;
mod wheelchair;
mod wires;
mod works;

use std::sync::Arc;

use crate::people::Walker;
use crate::solids::Detail;
use catalogue::{Body, BusBody, PersonBody, models, trains};
use glam::Vec3;
use schema::geometry::TriMesh;

pub use pieces::{ActorMesh, Cabin, Coarser, Joint, Piece};
pub use posture::Posture;
pub use rig::{Pedals, Pusher, Rider, Rig};

/// The mesh of an actor.
///
/// `model` is a name of [`catalogue::models::MODELS`], of [`catalogue::trains`], of a parked two-wheeler, or
/// of the scenery (`building.*`, `tree.*`, `plant.*`, `light.signal`, ...); `size_m` is length, width,
/// height; `variant` tells apart objects of the same model. Walkers are as high as that says, and as long and
/// wide as such people are ([`meshes::people::Walker::size_m`]). The mesh stands on z = 0 inside the box of
/// that size, centred in x and y; poles of lights and signs reach below z = 0. `None`: no such model.
#[must_use]
pub fn actor_mesh(model: &str, size_m: [f64; 3], variant: u32) -> Option<ActorMesh> {
    let size = Vec3::new(size_m[0] as f32, size_m[1] as f32, size_m[2] as f32);
    let fixed =
        |mesh: TriMesh| Some(ActorMesh::of(vec![Piece { mesh: Arc::new(mesh), joint: Joint::Fixed }]));
    if let Some((parked, ridden)) = models::find_parked(model) {
        let Body::TwoWheeler(built) = ridden.body else { return None };
        return Some(plates::lettered(two_wheeler::parked(parked, ridden, built, size), model, 0));
    }
    if let Some(known) = models::find(model).or_else(|| trains::find(model)) {
        return match known.body {
            Body::Car(body) => Some(plates::lettered(car::vehicle(known, body, size), model, 0)),
            Body::Lorry(load) => Some(plates::lettered(heavy::truck(known, load, size), model, 0)),
            Body::Trailer(load) => {
                let made = trailer::trailer(trains::of_towed(model)?, load, size);
                Some(plates::lettered(made, model, 0))
            }
            Body::Bus(BusBody::ArticulatedRear) => Some(bus::rear_section(trains::of_towed(model)?, size)),
            Body::Bus(body) => Some(bus::bus(known, body, size)),
            Body::TwoWheeler(body) => {
                let made = two_wheeler::two_wheeler(known, body, size, variant);
                Some(plates::lettered(made, model, variant))
            }
            Body::Person(PersonBody::Wheelchair) => Some(wheelchair::wheelchair(known, size, variant)),
            Body::Person(PersonBody::OnFoot) => {
                Some(bodies::walker(Walker::of_height(known, variant, size.z)))
            }
            Body::Cone(body) => fixed(cones::cone(body, size)),
            Body::Barrier(body) => fixed(cones::barrier(body, size)),
            // Packs bring their own.
            Body::Pack => None,
        };
    }
    let (family, kind) = model.split_once('.')?;
    match family {
        "building" => in_two(FAR_BUILDING_M, |detail| building::building(kind, size, variant, detail)),
        "tree" | "bush" | "plant" => plants::plant(family, kind, size, variant),
        "light" => in_two(FAR_STREET_M, |detail| signal::light(kind, size, variant, detail)),
        "pole" if kind == "wires" => Some(wires::wires(size, variant)),
        "pole" if kind == "lamp" => in_two(FAR_STREET_M, |detail| Some(street::lamp(size, detail))),
        "sign" | "pole" | "rsu" => street::street(family, kind, size, variant)
            .and_then(fixed)
            .or_else(|| furniture::thing(family, kind, size, variant)),
        "prop" if props::BORDERS.contains(&kind) => {
            in_two(FAR_BORDER_M, |detail| props::prop(kind, size, variant, detail))
        }
        "prop" => props::prop(kind, size, variant, Detail::Full)
            .or_else(|| works::item(kind, size, variant))
            .and_then(fixed)
            .or_else(|| furniture::thing(family, kind, size, variant)),
        _ => None,
    }
}

/// From where on buildings, fences, and lights and lamps of streets are made of fewer pieces, metres.
const FAR_BUILDING_M: f64 = 70.0;
const FAR_STREET_M: f64 = 50.0;
const FAR_BORDER_M: f64 = 30.0;

/// Something that never moves, made for close by and for farther away.
fn in_two(from_m: f64, make: impl Fn(Detail) -> Option<TriMesh>) -> Option<ActorMesh> {
    let pieces =
        |detail: Detail| make(detail).map(|mesh| vec![Piece { mesh: Arc::new(mesh), joint: Joint::Fixed }]);
    let far = Coarser { from_m, pieces: pieces(Detail::Coarse)? };
    Some(ActorMesh { coarser: vec![far], ..ActorMesh::of(pieces(Detail::Full)?) })
}

/// Whether objects of a model and a size differ by their variants; if not, [`actor_mesh`] makes the same of
/// each.
#[must_use]
pub fn has_variants(model: &str) -> bool {
    if models::find_parked(model).is_some() {
        return false;
    }
    let known = models::find(model).or_else(|| trains::find(model));
    known.is_none_or(|known| matches!(known.body, Body::TwoWheeler(_) | Body::Person(_)))
}

#[cfg(test)]
mod tests;
