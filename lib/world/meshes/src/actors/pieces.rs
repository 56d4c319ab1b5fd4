//! The pieces that an actor's mesh has, and how they move.

use std::sync::Arc;

use crate::people::{Bone, about_y, about_z};
use crate::solids::{Detail, Fit};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use schema::geometry::TriMesh;

use crate::actors::posture::Posture;
use crate::actors::rig::Rig;

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
    /// Wheels that neither turn nor steer.
    Standing,
    /// A bone of the rig.
    Bone(Bone),
    /// A bicycle's crank: turns about y by a share of the wheels' rotation.
    Crank {
        /// Axle, object frame, metres.
        at: Vec3,
        /// Turns of the crank for one of the wheels.
        gear: f32,
    },
    /// A pedal: goes round with the crank and stays level.
    Pedal {
        /// Axle of the crank, object frame, metres.
        at: Vec3,
        /// From there to the pedal while the crank stands at 0, metres.
        arm: Vec3,
        /// Turns of the crank for one of the wheels.
        gear: f32,
    },
    /// A door's leaf: turns outward about its front edge; there only while the door stands open.
    Door {
        /// Hinge, object frame, metres.
        at: Vec3,
        /// Number of the door: front left, front right, rear left, rear right.
        door: usize,
    },
    /// A door that is there when it is closed, too: turns outward about its hinge.
    Leaf {
        /// Hinge, object frame, metres.
        at: Vec3,
        /// Number of the door.
        door: usize,
    },
    /// What shows behind a door that stands open.
    Doorway {
        /// Number of the door.
        door: usize,
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

/// From these distances on vehicles are half and coarsely detailed, metres.
const HALF_FROM_M: f64 = 20.0;
pub(crate) const COARSE_FROM_M: f64 = 50.0;

/// Pieces that stand for an actor who is far away.
#[derive(Clone, Debug)]
pub struct Coarser {
    /// They do so from this distance on, metres.
    pub from_m: f64,
    /// The pieces, the body first.
    pub pieces: Vec<Piece>,
}

/// What stands behind the panes of a vehicle ([`schema::geometry::Surface::is_window`]), in the frame of its
/// body, the first of the pieces. It is strictly inside the body and no piece of it: it is seen only
/// through a pane. The lining of floor, sides and roof is open and faces inward; all else is closed and faces
/// outward.
#[derive(Clone, Debug)]
pub struct Cabin {
    /// Lining, dashboard, steering wheel, seats.
    pub seats: Arc<TriMesh>,
    /// The driver: the parts above the seat. Parked vehicles have none.
    pub driver: Option<Arc<TriMesh>>,
}

impl Cabin {
    /// From this distance on there is nothing behind panes, metres: bodies are coarse there.
    pub const UNTIL_M: f64 = COARSE_FROM_M;
}

/// All pieces of an actor; they share its object id.
#[derive(Clone, Debug, Default)]
pub struct ActorMesh {
    /// The pieces close by, the body first.
    pub pieces: Vec<Piece>,
    /// Their coarser levels of detail, the nearest first.
    pub coarser: Vec<Coarser>,
    /// Where its bones are in a posture, if it has bones.
    pub rig: Option<Arc<Rig>>,
    /// What one sees through its panes.
    pub cabin: Option<Cabin>,
}

impl ActorMesh {
    /// An actor whose pieces need no bones.
    pub(crate) fn of(pieces: Vec<Piece>) -> Self {
        Self { pieces, ..Self::default() }
    }

    /// An actor without bones, made for each level.
    pub(crate) fn in_levels(pieces: impl Fn(Detail) -> Vec<Piece>) -> Self {
        let farther = [(HALF_FROM_M, Detail::Half), (COARSE_FROM_M, Detail::Coarse)];
        let coarser = farther.map(|(from_m, detail)| Coarser { from_m, pieces: pieces(detail) });
        Self { coarser: coarser.to_vec(), ..Self::of(pieces(Detail::Full)) }
    }

    /// A vehicle made for each level, and behind the panes of its body, stretched as the finest one is, a
    /// cabin.
    pub(crate) fn with_cabin(
        made: impl Fn(Detail) -> (Vec<Piece>, Fit),
        cabin: impl FnOnce(&Fit) -> Cabin,
    ) -> Self {
        let (pieces, fit) = made(Detail::Full);
        let farther = [(HALF_FROM_M, Detail::Half), (COARSE_FROM_M, Detail::Coarse)];
        let coarser = farther.map(|(from_m, detail)| Coarser { from_m, pieces: made(detail).0 });
        Self { pieces, coarser: coarser.to_vec(), rig: None, cabin: Some(cabin(&fit)) }
    }

    /// A posture with the bones that follow from it.
    #[must_use]
    pub fn posed(&self, posture: Posture) -> Posture {
        self.rig.as_ref().map_or(posture, |rig| rig.posed(posture))
    }
}

impl Joint {
    /// Takes the piece's points to the object frame; none where the piece is not to be seen.
    #[must_use]
    pub fn object_from_piece(&self, posture: &Posture) -> Option<Affine3A> {
        let open = |door: usize| posture.door_rad.get(door).copied().filter(|angle| *angle > 0.0);
        Some(match *self {
            Self::Fixed | Self::Standing => Affine3A::IDENTITY,
            Self::Wheel { at, steered, right } => {
                let steer = if steered { posture.steer_rad } else { 0.0 };
                // The half turn swaps the axle's ends, and with them the sense of rotation.
                let spin = if right { -posture.phase_rad } else { posture.phase_rad };
                let turn =
                    if right { Mat3A::from_diagonal(Vec3::new(-1.0, -1.0, 1.0)) } else { Mat3A::IDENTITY };
                Affine3A { matrix3: about_z(steer) * turn * about_y(spin), translation: Vec3A::from(at) }
            }
            Self::Bone(bone) => posture.bones.as_ref()?.object_from_bone(bone),
            Self::Crank { at, gear } => {
                Affine3A { matrix3: about_y(gear * posture.phase_rad), translation: Vec3A::from(at) }
            }
            Self::Pedal { at, arm, gear } => {
                let arm = about_y(gear * posture.phase_rad) * Vec3A::from(arm);
                Affine3A::from_translation(at + Vec3::from(arm))
            }
            Self::Door { at, door } => swung(at, open(door)?),
            Self::Leaf { at, door } => swung(at, open(door).unwrap_or(0.0)),
            Self::Doorway { door } => open(door).map(|_| Affine3A::IDENTITY)?,
        })
    }

    /// Takes the piece's points to the object frame where nothing is turned and doors are closed.
    #[must_use]
    pub fn at_rest(&self) -> Affine3A {
        Affine3A::from_translation(self.at())
    }

    /// Whether the piece stays on the road when the body leans on its springs.
    #[must_use]
    pub fn stays_on_road(&self) -> bool {
        matches!(self, Self::Wheel { .. } | Self::Standing)
    }

    /// Where the piece hangs, object frame, metres.
    #[must_use]
    pub fn at(&self) -> Vec3 {
        match *self {
            Self::Wheel { at, .. }
            | Self::Door { at, .. }
            | Self::Leaf { at, .. }
            | Self::Crank { at, .. }
            | Self::Pedal { at, .. } => at,
            Self::Fixed | Self::Standing | Self::Bone(_) | Self::Doorway { .. } => Vec3::ZERO,
        }
    }
}

/// A door's leaf, swung open. From the hinge it reaches back: outward is clockwise on the left,
/// counter-clockwise on the right.
fn swung(at: Vec3, angle_rad: f32) -> Affine3A {
    let turn = if at.y > 0.0 { -angle_rad } else { angle_rad };
    Affine3A { matrix3: about_z(turn), translation: Vec3A::from(at) }
}
