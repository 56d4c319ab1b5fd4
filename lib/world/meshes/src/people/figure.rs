//! How somebody is built: lengths of the limbs and where they are joined.

use catalogue::Age;
use glam::{Affine3A, Vec3};

use crate::people::appearance::{Appearance, Build, Hair, Hat};

/// The rigid parts of a body. Each has its frame at its upper joint, axes as the object's where somebody
/// stands upright.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Bone {
    Pelvis,
    Chest,
    Head,
    UpperArmLeft,
    UpperArmRight,
    ForearmLeft,
    ForearmRight,
    ThighLeft,
    ThighRight,
    ShinLeft,
    ShinRight,
    FootLeft,
    FootRight,
    ToesLeft,
    ToesRight,
    /// A cane, from its grip down.
    Cane,
    /// A shovel, from its upper end down.
    Shovel,
    /// A pram without its wheels, from the ground below the person who pushes it.
    Pram,
    /// Both front wheels of a pram about their axle, and both rear ones.
    PramFront,
    PramRear,
    /// A dog's lead: from the hand to where it hangs lowest, and from there to the collar.
    LeadUpper,
    LeadLower,
    /// A dog's trunk about its middle; head and neck; tail.
    Dog,
    DogHead,
    DogTail,
    DogForeLeft,
    DogForeRight,
    DogHindLeft,
    DogHindRight,
    /// The lower halves of a dog's legs, with the paws.
    DogForeLeftLower,
    DogForeRightLower,
    DogHindLeftLower,
    DogHindRightLower,
}

impl Bone {
    /// Those of the body itself, in order.
    pub const BODY: [Self; 15] = {
        use Bone::*;
        [
            Pelvis,
            Chest,
            Head,
            UpperArmLeft,
            UpperArmRight,
            ForearmLeft,
            ForearmRight,
            ThighLeft,
            ThighRight,
            ShinLeft,
            ShinRight,
            FootLeft,
            FootRight,
            ToesLeft,
            ToesRight,
        ]
    };
}

/// So many bones there are.
pub const BONES: usize = 33;

/// Where each bone is: its frame to the object's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bones(pub(crate) [Affine3A; BONES]);

impl Bones {
    /// Takes points of a bone's frame to the object's.
    #[must_use]
    pub fn object_from_bone(&self, bone: Bone) -> Affine3A {
        self.0[bone as usize]
    }

    pub(crate) fn place(&mut self, bone: Bone, object_from_bone: Affine3A) {
        self.0[bone as usize] = object_from_bone;
    }

    /// The middle of the joint at a bone's upper end.
    #[must_use]
    pub fn joint(&self, bone: Bone) -> Vec3 {
        self.0[bone as usize].translation.into()
    }
}

/// Left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Side {
    Left,
    Right,
}

impl Side {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 1 on the left, -1 on the right.
    #[must_use]
    pub fn sign(self) -> f32 {
        if self == Self::Left { 1.0 } else { -1.0 }
    }

    /// Of a pair of bones that of this side.
    #[must_use]
    pub fn of<T: Copy>(self, [left, right]: [T; 2]) -> T {
        if self == Self::Left { left } else { right }
    }

    /// Thigh, shin, foot and toes.
    #[must_use]
    pub fn leg(self) -> [Bone; 4] {
        self.of([
            [Bone::ThighLeft, Bone::ShinLeft, Bone::FootLeft, Bone::ToesLeft],
            [Bone::ThighRight, Bone::ShinRight, Bone::FootRight, Bone::ToesRight],
        ])
    }

    /// Upper arm and forearm (with the hand).
    #[must_use]
    pub fn arm(self) -> [Bone; 2] {
        self.of([[Bone::UpperArmLeft, Bone::ForearmLeft], [Bone::UpperArmRight, Bone::ForearmRight]])
    }
}

/// Somebody's measures, metres. Shares of the stature are those of ordinary tables of human proportions
/// (Drillis and Contini 1966, as in Winter's textbook), rounded, and of children with longer heads and
/// shorter legs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub struct Figure {
    pub look: Appearance,
    /// From the ground to the crown, with shoes and hair, without a hat.
    pub stature: f32,
    /// Height of the hip joints, and how far each is from the middle.
    pub hip_z: f32,
    pub hip_y: f32,
    pub thigh: f32,
    pub shin: f32,
    /// Height of the ankle over the sole; heel, ball and tip of the foot before it.
    pub ankle: f32,
    pub heel: f32,
    pub ball: f32,
    pub toe: f32,
    /// How far the ankles stand from the middle.
    pub stance_y: f32,
    /// Height of the waist, where the chest turns, over the hips.
    pub waist: f32,
    /// The left shoulder and the neck's lower end over the waist.
    pub shoulder: Vec3,
    pub neck: Vec3,
    pub upper_arm: f32,
    pub forearm: f32,
    pub hand: f32,
    /// From the chin to the crown, and of the neck.
    pub head: f32,
    pub neck_m: f32,
    /// How far the hips are ahead and to the left of the origin, so that the box about somebody who stands is
    /// centred.
    pub hips_ahead: f32,
    pub hips_left: f32,
    /// How much farther ahead they are of somebody who strides out: who has something before them reaches
    /// farther back then.
    pub strides_ahead: f32,
    /// How far the hips are ahead and to the left of the origin of somebody who sits on a bench, for the same
    /// reason.
    pub sits_ahead: f32,
    pub sits_left: f32,
}

/// Where somebody's joints are while they stand upright, metres: see the fields of [`Figure`] of these names.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub struct Measures {
    pub hip_z: f32,
    pub hip_y: f32,
    pub thigh: f32,
    pub shin: f32,
    pub ankle: f32,
    pub heel: f32,
    pub ball: f32,
    pub toe: f32,
    pub stance_y: f32,
    pub waist: f32,
    pub shoulder: Vec3,
    pub neck: Vec3,
    pub upper_arm: f32,
    pub forearm: f32,
}

impl Figure {
    /// Somebody of a look and a stature.
    #[must_use]
    pub fn new(look: Appearance, stature: f32) -> Self {
        let h = stature;
        // 0 of an adult, 1 of a child of a metre.
        let young = ((1.60 - h) / 0.6).clamp(0.0, 1.0);
        let head = 0.158 + 0.040 * h;
        let neck_m = (0.036 - 0.010 * young) * h;
        let hip_z = (0.520 - 0.025 * young) * h;
        let ankle = 0.050 * h;
        let thigh = 0.505 * (hip_z - ankle);
        let shin = hip_z - ankle - thigh;
        let shoulders = match (look.age, look.woman) {
            (Age::Child, _) => 0.096,
            (_, true) => 0.094,
            _ => 0.104,
        };
        let heavy = match look.build {
            Build::Slim => 0.97,
            Build::Average => 1.0,
            Build::Heavy => 1.05,
        };
        let waist = 0.095 * h;
        let shoulder_z = h - head - neck_m - 0.030 * h;
        Self {
            look,
            stature,
            hip_z,
            hip_y: (if look.woman { 0.052 } else { 0.050 }) * h,
            thigh,
            shin,
            ankle,
            heel: -0.042 * h,
            ball: 0.070 * h,
            toe: 0.116 * h,
            stance_y: 0.046 * h * heavy,
            waist,
            shoulder: Vec3::new(-0.004 * h, shoulders * heavy * h, shoulder_z - hip_z - waist),
            neck: Vec3::new(0.0, 0.0, h - head - neck_m - hip_z - waist),
            upper_arm: 0.168 * h,
            forearm: 0.142 * h,
            hand: 0.104 * h,
            head,
            neck_m,
            hips_ahead: 0.0,
            hips_left: 0.0,
            strides_ahead: 0.0,
            sits_ahead: 0.0,
            sits_left: 0.0,
        }
    }

    /// Somebody whose joints stand where they were measured. How they stride follows from the legs: the
    /// stature is that of somebody of ordinary proportions with such legs, whatever is above them.
    #[must_use]
    pub fn measured(look: Appearance, measures: &Measures) -> Self {
        let Measures { hip_z, hip_y, thigh, shin, ankle, heel, ball, toe, stance_y, waist, .. } = *measures;
        let Measures { shoulder, neck, upper_arm, forearm, .. } = *measures;
        let per_hip = Self::new(look, hip_z / 0.5).hip_z / (hip_z / 0.5);
        let usual = Self::new(look, hip_z / per_hip);
        let known = Self { hip_z, hip_y, thigh, shin, ankle, heel, ball, toe, stance_y, waist, ..usual };
        Self { shoulder, neck, upper_arm, forearm, ..known }
    }

    /// Height of what is worn on the head over the crown, as a share of the stature.
    #[must_use]
    pub fn hat_share(look: &Appearance) -> f32 {
        match (look.hat, look.hair) {
            (Hat::None, Hair::Afro) => 0.026,
            (Hat::None, Hair::Curls | Hair::Quiff) => 0.012,
            (Hat::None, Hair::Bald) => -0.002,
            (Hat::None, _) => 0.0,
            (Hat::Cap, _) => 0.008,
            (Hat::Scarf, _) => 0.006,
            (Hat::Beanie, _) => 0.012,
            (Hat::SunHat | Hat::PeakedCap, _) => 0.016,
            (Hat::Helmet | Hat::FullHelmet | Hat::BicycleHelmet, _) => 0.026,
        }
    }

    /// Length of a leg from hip to sole.
    #[must_use]
    pub fn leg_m(&self) -> f32 {
        self.thigh + self.shin + self.ankle
    }

    /// Where the toes are bent, in the frame of the foot.
    #[must_use]
    pub fn hinge(&self) -> Vec3 {
        Vec3::new(self.ball, 0.0, -0.75 * self.ankle)
    }

    /// The hip joint of a side in the frame of the pelvis.
    #[must_use]
    pub fn hip(&self, side: Side) -> Vec3 {
        Vec3::new(0.0, side.sign() * self.hip_y, 0.0)
    }

    /// The shoulder of a side in the frame of the chest.
    pub(crate) fn shoulder(&self, side: Side) -> Vec3 {
        self.shoulder * Vec3::new(1.0, side.sign(), 1.0)
    }
}
