//! Poses of those who sit on a bench: the back at its rest, the feet on the ground, the hands on the thighs.

use frames::math::f32::{cos, sin};
use glam::{Affine3A, Mat3A, Vec3};

use crate::people::appearance::{Carried, Stance};
use crate::people::body::legs::thigh_reach_m;
use crate::people::figure::{BONES, Bone, Bones, Figure, Side};
use crate::people::joints::{about_y, about_z, frame};

/// How far the trunk leans back, radians.
const BACK_RAD: f32 = 0.14;
/// A body sinks so far into the seat, metres: it is flatter there than while its owner stands.
const SINKS_M: f32 = 0.007;
/// The pelvis reaches so far below the hips, as a share of the stature.
const BELOW_HIPS: f32 = 0.060;
/// A person so short that the thighs slope down sits higher by this share of the slope.
const SLOPE_LIFTS: f32 = 0.5;
/// How far the feet look outward, radians, and how far they stand aside from below the hips, as a share of
/// the stature.
const FEET_OUT: f32 = 0.16;
const FEET_ASIDE: f32 = 0.012;
/// How far along the thighs the hands lie.
const HANDS_ALONG: f32 = 0.66;

impl Figure {
    /// Where the bones are of somebody who sits on a bench whose seat is at a height over the ground, metres,
    /// and looks about as the phase goes on.
    #[must_use]
    pub fn sitting(&self, phase_rad: f32, seat_m: f32) -> Bones {
        let h = self.stature;
        let mut bones = Bones([Affine3A::IDENTITY; BONES]);
        let below = thigh_reach_m(self)[0].max(BELOW_HIPS * h) - SINKS_M;
        // Thighs of short people slope down over the seat's front edge, on which they lie.
        let slope = (seat_m + below - self.ankle - self.shin).max(0.0);
        let below = below + SLOPE_LIFTS * slope;
        let hips = Vec3::new(self.sits_ahead, self.sits_left, seat_m + below);
        bones.place(Bone::Pelvis, frame(about_y(-0.6 * BACK_RAD), hips));
        let waist = bones.object_from_bone(Bone::Pelvis).transform_point3(Vec3::Z * self.waist);
        bones.place(Bone::Chest, frame(about_y(-BACK_RAD), waist));
        let chest = bones.object_from_bone(Bone::Chest);
        let (nods, looks) = match (self.look.carried, self.look.stance) {
            (Carried::Phone, _) => (0.38, 0.06),
            (_, Stance::Phones) => (0.02, 0.0),
            _ => (0.04, 0.30),
        };
        let head = about_z(looks * sin(phase_rad)) * about_y(nods);
        bones.place(Bone::Head, frame(head, chest.transform_point3(self.neck)));
        for side in Side::BOTH {
            self.place_sitting_leg(&mut bones, side, hips);
            self.place_lying_hand(&mut bones, side, phase_rad);
        }
        if self.look.stance == Stance::Phones {
            self.raise_to_ear(&mut bones, 1.0);
        }
        bones
    }

    /// A foot flat on the ground, the shin all but upright.
    fn place_sitting_leg(&self, bones: &mut Bones, side: Side, hips: Vec3) {
        let rise = hips.z - self.ankle;
        // Where the seat is higher than the shin is long the thigh slopes down, and the foot stands nearer.
        let slope = (rise - self.shin).clamp(0.0, 0.9 * self.thigh);
        let ahead = (self.thigh * self.thigh - slope * slope).sqrt() + 0.02 * self.stature;
        let aside = side.sign() * (self.hip_y + FEET_ASIDE * self.stature);
        let ankle = Vec3::new(hips.x + ahead, hips.y + aside, self.ankle);
        self.place_leg(bones, side, frame(about_z(side.sign() * FEET_OUT), ankle), 0.0);
    }

    /// A hand on its thigh, moved in talk, or before the chest with a phone.
    fn place_lying_hand(&self, bones: &mut Bones, side: Side, phase_rad: f32) {
        let h = self.stature;
        let [hip, knee] = [side.leg()[0], side.leg()[1]].map(|bone| bones.joint(bone));
        let over = thigh_reach_m(self)[1] + 0.014 * h;
        let lies = hip.lerp(knee, HANDS_ALONG) + Vec3::new(0.0, -0.012 * h * side.sign(), over);
        let bends = Vec3::new(-0.75, 0.55 * side.sign(), -0.35);
        let palm = match (self.look.carried, self.look.stance, side) {
            (Carried::Phone, _, Side::Right) => lies + Vec3::new(-0.02 * h, 0.05 * h, 0.115 * h),
            (_, Stance::Talks, Side::Left) => {
                let (s, c) = (sin(3.0 * phase_rad), cos(2.0 * phase_rad));
                lies + Vec3::new(0.018 * c, 0.004 * s, 0.07 + 0.012 * s) * h
            }
            _ => lies,
        };
        self.take_hold(bones, side, palm, bends);
        if palm == lies {
            self.lay_palm_down(bones, side);
        }
    }

    /// Turns a forearm about itself so that the palm, which looks inward, looks down.
    fn lay_palm_down(&self, bones: &mut Bones, side: Side) {
        let [_, lower] = side.arm();
        let arm = bones.object_from_bone(lower);
        let up = arm.matrix3.z_axis;
        // The hand's inner side is towards -y on the left.
        let inward = (glam::Vec3A::NEG_Z - up * glam::Vec3A::NEG_Z.dot(up)).normalize_or(glam::Vec3A::NEG_X);
        let y = -side.sign() * inward;
        let x = y.cross(up);
        bones.place(lower, Affine3A { matrix3: Mat3A::from_cols(x, y, up), translation: arm.translation });
    }
}
