//! Meshes of everything that stands or moves in a scene, made from a model name, a size and a variant.

mod building;
mod car;
mod cones;
mod heavy;
mod nature;
mod props;
mod street;
mod two_wheeler;
mod walker;
mod warning;
mod wheel;
mod wheelchair;
mod works;

use std::sync::Arc;

use frames::math::f32::{sin, sin_cos};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use schema::geometry::TriMesh;
use schema::models::{self, BaseType};
use schema::tables::StateRow;

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
    /// A door's leaf: turns outward about its front edge; there only while the door stands open.
    Door {
        /// Hinge, object frame, metres.
        at: Vec3,
        /// Number of the door: front left, front right, rear left, rear right.
        door: usize,
    },
    /// What shows behind a door that stands open.
    Doorway {
        /// Number of the door.
        door: usize,
    },
}

/// How an actor's joints are turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture {
    /// Steering angle of the front wheels, radians, positive left.
    pub steer_rad: f32,
    /// Rotation of the wheels; of walkers the gait phase, radians.
    pub phase_rad: f32,
    /// How far the doors stand open, radians.
    pub door_rad: [f32; 4],
}

impl From<&StateRow> for Posture {
    fn from(state: &StateRow) -> Self {
        Self { steer_rad: state.steer_rad, phase_rad: state.phase_rad, door_rad: state.door_rad }
    }
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
    /// Takes the piece's points to the object frame; none where the piece is not to be seen.
    #[must_use]
    pub fn object_from_piece(&self, posture: &Posture) -> Option<Affine3A> {
        let open = |door: usize| posture.door_rad.get(door).copied().filter(|angle| *angle > 0.0);
        Some(match *self {
            Self::Fixed => Affine3A::IDENTITY,
            Self::Wheel { at, steered, right } => {
                let steer = if steered { posture.steer_rad } else { 0.0 };
                // The half turn swaps the axle's ends, and with them the sense of rotation.
                let spin = if right { -posture.phase_rad } else { posture.phase_rad };
                let turn =
                    if right { Mat3A::from_diagonal(Vec3::new(-1.0, -1.0, 1.0)) } else { Mat3A::IDENTITY };
                Affine3A { matrix3: about_z(steer) * turn * about_y(spin), translation: Vec3A::from(at) }
            }
            Self::Limb { at, swing_rad } => {
                let angle = swing_rad * sin(posture.phase_rad);
                Affine3A { matrix3: about_y(-angle), translation: Vec3A::from(at) }
            }
            Self::Door { at, door } => {
                // From the hinge the leaf reaches back: outward is clockwise on the left, counter-clockwise on the right.
                let angle = open(door)?;
                let turn = if at.y > 0.0 { -angle } else { angle };
                Affine3A { matrix3: about_z(turn), translation: Vec3A::from(at) }
            }
            Self::Doorway { door } => open(door).map(|_| Affine3A::IDENTITY)?,
        })
    }

    /// Takes the piece's points to the object frame where nothing is turned and doors are closed.
    pub(crate) fn at_rest(&self) -> Affine3A {
        Affine3A::from_translation(self.at())
    }

    /// Where the piece hangs, object frame, metres.
    pub(crate) fn at(&self) -> Vec3 {
        match *self {
            Self::Wheel { at, .. } | Self::Limb { at, .. } | Self::Door { at, .. } => at,
            Self::Fixed | Self::Doorway { .. } => Vec3::ZERO,
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
            BaseType::Pedestrian if known.wheel_radius_m > 0.0 => {
                Some(wheelchair::wheelchair(known, size, variant))
            }
            BaseType::Pedestrian => Some(walker::walker(known, size, variant)),
            BaseType::Cone => fixed(cones::cone(known.name, size)),
            BaseType::Barrier => fixed(cones::barrier(known.name, size)),
        };
    }
    let (family, kind) = model.split_once('.')?;
    match family {
        "building" => building::building(kind, size, variant).and_then(fixed),
        "tree" | "bush" => nature::plant(family, kind, size, variant).and_then(fixed),
        "light" | "sign" | "pole" => street::street(family, kind, size, variant).and_then(fixed),
        "prop" => {
            props::prop(kind, size, variant).or_else(|| works::item(kind, size, variant)).and_then(fixed)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
