//! Prams: where they are before the person who pushes them. They roll as the body goes on, and their wheels
//! turn with the phase of the walk.

use std::f32::consts::TAU;

use glam::{Mat3A, Vec3};

use crate::people::figure::{Bone, Bones, Figure, Side};
use crate::people::joints::{about_y, frame};

/// The wheels of an axle, metres: how far it is ahead of the hips of the person who pushes, their radius, how
/// far from the middle they run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axle {
    pub(crate) ahead: f32,
    pub(crate) radius: f32,
    pub(crate) aside: f32,
}

/// The feet of the person who pushes never reach the rear axle.
pub(crate) const REAR: Axle = Axle { ahead: 0.74, radius: 0.14, aside: 0.27 };
pub(crate) const FRONT: Axle = Axle { ahead: 1.22, radius: 0.10, aside: 0.20 };
/// How far from the middle the hands are on the handle, metres.
const GRIP_M: f32 = 0.17;
/// Wheels turn as is right at this speed, m/s: the phase tells steps, and steps grow with the speed.
const ROLLS_MPS: f32 = 1.3;

impl Figure {
    /// A pram's handle: ahead of the hips, and above the ground, metres.
    pub(crate) fn handle_m(&self) -> [f32; 2] {
        [0.235 * self.stature, 0.59 * self.stature]
    }

    /// The pram before somebody whose hips are over a place, and their hands on its handle.
    pub(crate) fn place_pram(&self, bones: &mut Bones, hips: [f32; 2], phase_rad: f32) {
        let ground = Vec3::new(hips[0], hips[1], 0.0);
        bones.place(Bone::Pram, frame(Mat3A::IDENTITY, ground));
        for (bone, axle) in [(Bone::PramFront, FRONT), (Bone::PramRear, REAR)] {
            let turns = phase_rad / TAU * self.stride_m(ROLLS_MPS) / (TAU * axle.radius);
            let at = ground + Vec3::new(axle.ahead, 0.0, axle.radius);
            bones.place(bone, frame(about_y(TAU * turns.fract()), at));
        }
        let [ahead, up] = self.handle_m();
        for side in Side::BOTH {
            let grip = ground + Vec3::new(ahead, side.sign() * GRIP_M, up);
            self.take_hold(bones, side, grip, Vec3::new(-0.7, 0.45 * side.sign(), -0.6));
        }
    }
}
