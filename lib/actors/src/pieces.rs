//! The pieces that an actor's mesh has, and how they move.

use std::sync::Arc;

use frames::math::f32::{sin, sin_cos};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use schema::geometry::TriMesh;
use schema::tables::StateRow;

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
    #[must_use]
    pub fn at_rest(&self) -> Affine3A {
        Affine3A::from_translation(self.at())
    }

    /// Where the piece hangs, object frame, metres.
    #[must_use]
    pub fn at(&self) -> Vec3 {
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
