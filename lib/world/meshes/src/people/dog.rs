//! Dogs on a lead: where they are beside the person who leads them, and how they trot.
//!
//! A dog takes some whole number of strides to its leader's one. A paw on the ground goes back, seen from the
//! dog, exactly as far as it goes on; each foreleg moves with the hind leg of the other side.

use std::f32::consts::TAU;

use frames::math::f32::{cos, sin};
use glam::Vec3;

use crate::people::appearance::Appearance;
use crate::people::figure::{Bone, Bones, Figure, Side};
use crate::people::gait::Gait;
use crate::people::joints::{Limb, about_y, about_z, frame, hanging};

/// A dog's measures as shares of the height of its back.
const SHOULDER: Vec3 = Vec3::new(0.36, 0.12, 0.70);
const HIP: Vec3 = Vec3::new(-0.38, 0.11, 0.72);
const LEG: f32 = 0.395;
const NECK: Vec3 = Vec3::new(0.40, 0.0, 0.84);
const RUMP: Vec3 = Vec3::new(-0.46, 0.0, 0.86);
const PAW: f32 = 0.05;
/// Where the lead is tied to the collar, from the neck's lower end.
const COLLAR: Vec3 = Vec3::new(0.04, 0.0, 0.16);
/// A paw's way on the ground, and the dog's stride at a usual walk, at most.
const STEP: f32 = 0.72;
const STRIDE: f32 = 1.55;
/// Longest share of a stride that a paw is on the ground.
const DUTY: f32 = 0.55;
/// A lead is this much longer than straight.
const SLACK: f32 = 1.04;

/// A dog's measures, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dog {
    /// Height of its back.
    pub(crate) back: f32,
    /// Length of either half of a leg, and half the height of a paw.
    pub(crate) leg: f32,
    pub(crate) paw: f32,
}

impl Dog {
    pub(crate) fn new(look: &Appearance) -> Self {
        let back = look.dog_m;
        Self { back, leg: LEG * back, paw: PAW * back }
    }
}

/// One of a dog's legs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) upper: Bone,
    pub(crate) lower: Bone,
    pub(crate) hind: bool,
    side: Side,
}

/// All four.
pub(crate) const LEGS: [Leg; 4] = {
    use Bone::*;
    [
        Leg { upper: DogForeLeft, lower: DogForeLeftLower, hind: false, side: Side::Left },
        Leg { upper: DogForeRight, lower: DogForeRightLower, hind: false, side: Side::Right },
        Leg { upper: DogHindLeft, lower: DogHindLeftLower, hind: true, side: Side::Left },
        Leg { upper: DogHindRight, lower: DogHindRightLower, hind: true, side: Side::Right },
    ]
};

impl Figure {
    /// Length of either half of the lead, metres.
    pub(crate) fn lead_m(&self) -> f32 {
        let collar = self.dog_at() + self.look.dog_m * (NECK + COLLAR);
        0.5 * SLACK * (collar - self.hand_at()).length()
    }

    /// The left hand that holds a lead, from the ground below the hips.
    fn hand_at(&self) -> Vec3 {
        Vec3::new(0.07, 0.165, 0.475) * self.stature
    }

    /// The ground below a dog's middle, from that below the hips.
    fn dog_at(&self) -> Vec3 {
        Vec3::new(0.30, 0.15 * self.stature + 0.26 * self.look.dog_m, 0.0)
    }

    /// The dog of somebody whose hips are over a place, and the lead between them.
    pub(crate) fn place_dog(&self, bones: &mut Bones, hips: [f32; 2], gait: &Gait, phase_rad: f32) {
        let dog = Dog::new(&self.look);
        let (m, v) = (dog.back, gait.vigour);
        let strides = (self.stride_m(crate::people::gait::USUAL_MPS) / (STRIDE * m)).round().max(1.0);
        let turns = phase_rad / TAU * strides;
        let stride = gait.stride / strides;
        let duty = if stride > 0.0 { (STEP * m / stride).min(DUTY) } else { DUTY };
        let ground = Vec3::new(hips[0], hips[1], 0.0);
        // It rises twice in a stride, and its back stays all but level.
        let bob = 0.012 * m * v * cos(2.0 * TAU * (turns - 0.5 * duty));
        let at = ground + self.dog_at() - Vec3::Z * (0.012 * m * v + bob);
        bones.place(Bone::Dog, frame(about_y(0.015 * v * sin(TAU * turns)), at + Vec3::Z * 0.78 * m));
        let nod = 0.05 * v * sin(2.0 * TAU * turns);
        bones.place(Bone::DogHead, frame(about_y(nod), at + NECK * m));
        let wag = (0.35 * v + 0.5 * gait.idle) * sin(TAU * turns);
        bones.place(Bone::DogTail, frame(about_z(wag), at + RUMP * m));
        for leg in LEGS {
            let offset = if (leg.side == Side::Left) == leg.hind { 0.5 } else { 0.0 };
            let joint = if leg.hind { HIP } else { SHOULDER } * m * Vec3::new(1.0, leg.side.sign(), 1.0);
            let below = (ground + self.dog_at() + joint) * Vec3::new(1.0, 1.0, 0.0);
            let [x, z] = paw(turns + offset, stride * duty, duty, 0.16 * m * v);
            let limb =
                Limb { root: at + joint, upper: dog.leg, lower: dog.leg, bends: Vec3::NEG_X, forward: false };
            let ([upper, lower], _) = limb.reach(below + Vec3::new(x, 0.0, dog.paw + z));
            bones.place(leg.upper, upper);
            bones.place(leg.lower, lower);
        }
        let swing = Vec3::X * 0.012 * self.stature * v * cos(phase_rad);
        let bends = Vec3::new(-0.6, 0.25, -0.5);
        let hand = self.take_hold(bones, Side::Left, ground + self.hand_at() + swing, bends);
        let collar = bones.object_from_bone(Bone::DogHead).transform_point3(COLLAR * m);
        let half = self.lead_m();
        let lead = Limb { root: hand, upper: half, lower: half, bends: Vec3::NEG_Z, forward: true };
        let ([upper, lower], _) = lead.reach(collar);
        bones.place(Bone::LeadUpper, upper);
        bones.place(Bone::LeadLower, hanging(lower.translation.into(), collar, Vec3::X));
    }
}

/// A paw before the place below its joint, and above the ground, metres: on the ground for a share of its
/// stride.
fn paw(turns: f32, step: f32, duty: f32, lift: f32) -> [f32; 2] {
    let c = turns - turns.floor();
    if c < duty {
        return [step * (0.5 - c / duty), 0.0];
    }
    let w = (c - duty) / (1.0 - duty);
    [step * (w * w * (3.0 - 2.0 * w) - 0.5), lift * sin(0.5 * TAU * w)]
}
