//! Meshes of everything that stands or moves in a scene, made from a model name, a size and a variant.

mod building;
mod car;
mod heavy;
mod nature;
mod props;
mod street;
mod two_wheeler;
mod walker;
mod wheel;

use std::sync::Arc;

use frames::math::f32::{sin, sin_cos};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use schema::geometry::TriMesh;
use schema::models::{self, BaseType};

pub(crate) use building::{BUILDINGS, BuildingKind};
pub(crate) use nature::TREES;
pub(crate) use street::LAMP_FAILED;

/// How a piece of an actor moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// Not at all.
    Fixed,
    /// A wheel: turns about its axle (y) by the phase, and with the steering angle about z if it is steered.
    Wheel {
        /// Axle, object frame, metres.
        at: Vec3,
        /// Whether it follows the steering angle.
        steered: bool,
        /// Whether its outer face looks right: the mesh is turned by half a turn about z.
        right: bool,
    },
    /// A limb that swings about an axis along y.
    Limb {
        /// Hinge, object frame, metres.
        at: Vec3,
        /// Largest angle from the vertical, radians; negative swings the other way first.
        swing_rad: f32,
    },
}

/// One piece of an actor.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Its triangles, relative to its joint.
    pub mesh: Arc<TriMesh>,
    /// How it hangs on the actor.
    pub joint: Joint,
}

/// All pieces of an actor; they share its object id.
#[derive(Clone, Debug, Default)]
pub struct ActorMesh {
    /// The pieces, the body first.
    pub pieces: Vec<Piece>,
}

impl Joint {
    /// Takes the piece's points to the object frame.
    #[must_use]
    pub fn object_from_piece(&self, steer_rad: f32, phase_rad: f32) -> Affine3A {
        match *self {
            Self::Fixed => Affine3A::IDENTITY,
            Self::Wheel { at, steered, right } => {
                let steer = if steered { steer_rad } else { 0.0 };
                // The half turn swaps the axle's ends, and with them the sense of rotation.
                let spin = if right { -phase_rad } else { phase_rad };
                let turn =
                    if right { Mat3A::from_diagonal(Vec3::new(-1.0, -1.0, 1.0)) } else { Mat3A::IDENTITY };
                Affine3A { matrix3: about_z(steer) * turn * about_y(spin), translation: Vec3A::from(at) }
            }
            Self::Limb { at, swing_rad } => {
                let angle = swing_rad * sin(phase_rad);
                Affine3A { matrix3: about_y(-angle), translation: Vec3A::from(at) }
            }
        }
    }
}

fn about_y(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, 0.0, -s), Vec3A::Y, Vec3A::new(s, 0.0, c))
}

fn about_z(angle: f32) -> Mat3A {
    let (s, c) = sin_cos(angle);
    Mat3A::from_cols(Vec3A::new(c, s, 0.0), Vec3A::new(-s, c, 0.0), Vec3A::Z)
}

/// The mesh of an actor.
///
/// `model` is a name of [`schema::models::MODELS`] or of the scenery (`building.*`, `tree.*`, `light.signal`, ...);
/// `size_m` is length, width, height; `variant` tells apart objects of the same model. The mesh stands on z = 0 inside the
/// box of that size, centred in x and y; poles of lights and signs reach below z = 0. `None`: no such model.
#[must_use]
pub fn actor_mesh(model: &str, size_m: [f64; 3], variant: u32) -> Option<ActorMesh> {
    let size = Vec3::new(size_m[0] as f32, size_m[1] as f32, size_m[2] as f32);
    let fixed =
        |mesh: TriMesh| Some(ActorMesh { pieces: vec![Piece { mesh: Arc::new(mesh), joint: Joint::Fixed }] });
    if let Some(known) = models::find(model) {
        return match known.base {
            BaseType::Car | BaseType::Van => Some(car::vehicle(known, size)),
            BaseType::Truck if known.name == "truck.pickup" => Some(car::vehicle(known, size)),
            BaseType::Truck => Some(heavy::truck(known, size)),
            BaseType::Bus => Some(heavy::bus(known, size)),
            BaseType::Motorcycle | BaseType::Bicycle => Some(two_wheeler::two_wheeler(known, size, variant)),
            BaseType::Pedestrian => Some(walker::walker(known, size, variant)),
            BaseType::Cone => fixed(props::cone(size)),
            BaseType::Barrier => fixed(props::barrier(size)),
        };
    }
    let (family, kind) = model.split_once('.')?;
    match family {
        "building" => building::building(kind, size, variant).and_then(fixed),
        "tree" | "bush" => nature::plant(family, kind, size, variant).and_then(fixed),
        "light" | "sign" | "pole" => street::street(family, kind, size, variant).and_then(fixed),
        "prop" => props::prop(kind, size, variant).and_then(fixed),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
