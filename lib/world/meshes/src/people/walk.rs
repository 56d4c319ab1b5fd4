//! Poses of those who stand, walk and run.

use std::f32::consts::TAU;

use catalogue::Age;
use frames::math::f32::{cos, sin};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

use crate::people::figure::{BONES, Bone, Bones, Figure, Side};
use crate::people::gait::{Gait, cycle};
use crate::people::joints::{Limb, about_x, about_y, about_z, frame};

use crate::people::appearance::{Build, Carried, Stance, Top};

/// Shares of a foot's time on the ground at which is seen how low the hips must be: where it is far from
/// them.
const FAR: [f32; 10] = [0.0, 0.04, 0.09, 0.16, 0.45, 0.65, 0.75, 0.84, 0.92, 0.9999];
/// A leg is not quite straight.
const STRAIGHT: f32 = 0.997;

impl Figure {
    /// Where the bones are of somebody who has come so far in the walk's cycle, and strides as at a speed
    /// (m/s; 0: stands).
    #[must_use]
    pub fn walking(&self, phase_rad: f32, speed_mps: f32) -> Bones {
        let gait = Gait::new(self, speed_mps);
        let hips = self.hips_over(&gait);
        let mut bones = Bones([Affine3A::IDENTITY; BONES]);
        let strides = cycle(phase_rad, Side::Left) * TAU;
        let v = gait.vigour;
        let walk = 1.0 - gait.run;
        // The body is over the foot that carries it, and lowest (running: while it carries).
        let over = strides - gait.duty * 0.5 * TAU;
        // A standing person shifts the weight, looks about and moves the hands in talk.
        let idle = gait.idle * sin(phase_rad);
        let sway = self.stature * (0.010 * v * walk * cos(over) + 0.009 * idle);
        let z = self.hips_m(&gait) + self.bob(&gait) * cos(2.0 * over);
        let yaw = -0.10 * v * cos(strides);
        let tips = 0.045 * v * walk * cos(over) + 0.020 * idle;
        let turn = about_z(yaw) * about_x(tips) * about_y(0.7 * self.lean(&gait));
        let pelvis = frame(turn, Vec3::new(hips[0], hips[1] + sway, z.min(self.hip_z)));
        bones.place(Bone::Pelvis, pelvis);
        for side in Side::BOTH {
            let foot = gait.foot(self, side, cycle(phase_rad, side), hips);
            self.place_leg(&mut bones, side, foot.object_from_foot, foot.toes_rad);
        }
        self.place_trunk(&mut bones, &gait, [yaw, tips, strides]);
        for side in Side::BOTH {
            self.place_arm(&mut bones, side, &gait, strides);
        }
        match self.look.carried {
            Carried::Pram => self.place_pram(&mut bones, hips, phase_rad),
            Carried::Dog => self.place_dog(&mut bones, hips, &gait, phase_rad),
            Carried::Shovel => self.place_shovel(&mut bones, hips, &gait),
            _ => {}
        }
        bones
    }

    /// Where the hips' middle is over the ground.
    fn hips_over(&self, gait: &Gait) -> [f32; 2] {
        [self.hips_ahead + self.strides_ahead * gait.vigour, self.hips_left]
    }

    /// How far the hips go up and down, metres; when running they are lowest where walkers' are highest.
    fn bob(&self, gait: &Gait) -> f32 {
        (0.012 - 0.024 * gait.run) * self.stature * gait.vigour
    }

    /// Height of the hips in the mean: so low that a leg reaches the ground wherever its foot stands.
    fn hips_m(&self, gait: &Gait) -> f32 {
        let leg = STRAIGHT * (self.thigh + self.shin);
        let across = self.hip_y - self.stance_y;
        let bob = self.bob(gait);
        let allowed = FAR.into_iter().map(|share| {
            let c = gait.duty * share;
            let ankle = gait.foot(self, Side::Left, c, [0.0; 2]).object_from_foot.translation;
            // The pelvis turns and tips by a little: a hip may be so much farther from the foot.
            let away = ankle.x.abs() + 0.008 * self.stature * gait.vigour;
            let side = across.abs() + 0.012 * self.stature * gait.vigour;
            let rise = (leg * leg - away * away - side * side).max(0.01).sqrt();
            ankle.z + rise - bob * cos(2.0 * TAU * (c - 0.5 * gait.duty)) - 0.004 * self.stature * gait.vigour
        });
        allowed.fold(self.hip_z, f32::min)
    }

    pub(crate) fn place_leg(&self, bones: &mut Bones, side: Side, object_from_foot: Affine3A, toes_rad: f32) {
        let pelvis = bones.object_from_bone(Bone::Pelvis);
        let ahead = Vec3::from(object_from_foot.transform_vector3a(Vec3A::X));
        let limb = Limb {
            root: pelvis.transform_point3(self.hip(side)),
            upper: self.thigh,
            lower: self.shin,
            bends: Vec3::from(pelvis.matrix3.x_axis) * 0.6 + ahead * Vec3::new(1.0, 1.0, 0.0) * 0.4,
            forward: true,
        };
        let ([thigh, shin], ankle) = limb.reach(object_from_foot.translation.into());
        let foot = frame(object_from_foot.matrix3, ankle);
        let hinge = foot.transform_point3(self.hinge());
        let [a, b, c, d] = side.leg();
        bones.place(a, thigh);
        bones.place(b, shin);
        bones.place(c, foot);
        bones.place(d, frame(foot.matrix3 * about_y(-toes_rad), hinge));
    }

    /// How far the trunk leans forward, radians.
    fn lean(&self, gait: &Gait) -> f32 {
        let stoop = if self.look.age == Age::Elder { 0.13 } else { 0.015 };
        let load = match self.look.carried {
            Carried::Backpack => 0.03,
            Carried::Pram => 0.05,
            _ => 0.0,
        };
        stoop + load + gait.vigour * (0.02 + 0.11 * gait.run)
    }

    fn place_trunk(&self, bones: &mut Bones, gait: &Gait, [yaw, tips, strides]: [f32; 3]) {
        let pelvis = bones.object_from_bone(Bone::Pelvis);
        let lean = self.lean(gait);
        // The shoulders turn against the hips, and stay level.
        let turn = about_z(-0.8 * yaw) * about_y(lean) * about_x(-0.3 * tips);
        let waist = pelvis.transform_point3(Vec3::Z * self.waist);
        bones.place(Bone::Chest, frame(turn, waist));
        let chest = bones.object_from_bone(Bone::Chest);
        let nod = 0.35 * lean + 0.01 * gait.vigour * sin(2.0 * strides);
        let looks_down = if self.look.carried == Carried::Phone { 0.30 } else { 0.0 };
        // Not with a phone at the ear.
        let about = if self.look.stance == Stance::Phones { 0.0 } else { 0.24 * gait.idle };
        let looks = about_z(about * sin(strides)) * about_y(nod + looks_down);
        bones.place(Bone::Head, frame(looks, chest.transform_point3(self.neck)));
    }

    fn place_arm(&self, bones: &mut Bones, side: Side, gait: &Gait, strides: f32) {
        let chest = bones.object_from_bone(Bone::Chest);
        let (v, run) = (gait.vigour, gait.run);
        let with_leg = if side == Side::Left { cos(strides) } else { -cos(strides) };
        // Arms swing against the legs.
        let mut swing = -with_leg * v * (0.34 + 0.30 * run) - 0.02 * v + 0.04;
        let mut elbow = 0.16 + v * (0.18 + 0.12 * -with_leg) + run * (1.25 - 0.20 * with_leg);
        let mut out = self.arms_out(side);
        let mut inward = 0.0;
        if side == Side::Right {
            match self.look.carried {
                Carried::Cane => return self.place_cane(bones, gait, strides),
                Carried::Phone => (swing, elbow, inward) = (0.35, 1.75, 0.35),
                _ => {}
            }
        }
        let idle = 1.0 - v;
        let stance = match (self.look.stance, side) {
            (Stance::Talks, Side::Left) => {
                Some((0.35 + 0.10 * sin(2.0 * strides), 1.25 + 0.30 * sin(2.0 * strides), 0.18, 0.30))
            }
            (Stance::Talks, Side::Right) => {
                Some((0.25 + 0.08 * sin(strides), 0.95 + 0.25 * sin(3.0 * strides), 0.15, 0.25))
            }
            (Stance::HandsOnHips, _) => Some((-0.35, 1.35, 0.62, 1.10)),
            _ => None,
        };
        if let Some((s, e, o, i)) =
            stance.filter(|_| self.look.carried != Carried::Phone || side == Side::Left)
        {
            swing += (s - swing) * idle;
            elbow += (e - elbow) * idle;
            out += (o - out) * idle;
            inward += (i - inward) * idle;
        }
        let root = frame(chest.matrix3, chest.transform_point3(self.shoulder(side)));
        let upper = root.matrix3 * about_x(side.sign() * out) * about_y(-swing);
        // The forearm turns in towards the middle by turning the elbow's hinge.
        let lower = upper * about_z(-side.sign() * inward) * about_y(-elbow);
        self.place_arm_bones(bones, side, Vec3::from(root.translation), [upper, lower]);
        if (self.look.stance, side) == (Stance::Phones, Side::Right) {
            // One who walks phones on, one who runs does not.
            self.raise_to_ear(bones, 1.0 - run);
        }
    }

    /// Takes the right hand so much of the way to the ear: the wrist to before the jaw.
    pub(crate) fn raise_to_ear(&self, bones: &mut Bones, share: f32) {
        let [a, b] = Side::Right.arm();
        let length = self.forearm;
        let [shoulder, elbow] = [a, b].map(|bone| bones.joint(bone));
        let hand = bones.object_from_bone(b).transform_point3(Vec3::NEG_Z * length);
        let ear = Vec3::new(0.42 * self.head, -0.58 * self.head, self.neck_m - 0.22 * self.head);
        let ear = bones.object_from_bone(Bone::Head).transform_point3(ear);
        let limb = Limb {
            root: shoulder,
            upper: self.upper_arm,
            lower: length,
            bends: (elbow - 0.5 * (shoulder + hand))
                .normalize_or(Vec3::NEG_X)
                .lerp(Vec3::new(0.2, -0.2, -1.0), share),
            forward: false,
        };
        let ([upper, lower], _) = limb.reach(hand.lerp(ear, share));
        bones.place(a, upper);
        bones.place(b, lower);
    }

    fn place_arm_bones(&self, bones: &mut Bones, side: Side, shoulder: Vec3, [upper, lower]: [Mat3A; 2]) {
        let [a, b] = side.arm();
        bones.place(a, frame(upper, shoulder));
        let elbow = bones.object_from_bone(a).transform_point3(Vec3::NEG_Z * self.upper_arm);
        bones.place(b, frame(lower, elbow));
    }

    /// How far the arms are held off the body, radians.
    fn arms_out(&self, side: Side) -> f32 {
        let cloth = if matches!(self.look.top, Top::Coat | Top::Jacket | Top::Hoodie) { 0.04 } else { 0.0 };
        let wide = match self.look.build {
            Build::Heavy => 0.17,
            Build::Average => 0.10,
            Build::Slim => 0.07,
        };
        let bag = if self.look.carried == Carried::ShoulderBag && side == Side::Right { 0.10 } else { 0.0 };
        wide + cloth + bag
    }

    /// A cane goes forward with the left foot and stands on the ground as long.
    fn place_cane(&self, bones: &mut Bones, gait: &Gait, strides: f32) {
        let c = strides / TAU;
        let travel = gait.stride * gait.duty;
        let (x, z) = if c < gait.duty {
            (travel * (0.5 - c / gait.duty), 0.0)
        } else {
            let w = (c - gait.duty) / (1.0 - gait.duty);
            (travel * (w * w * (3.0 - 2.0 * w) - 0.5), 0.07 * gait.vigour * sin(0.5 * TAU * w))
        };
        let h = self.stature;
        let [hips_ahead, hips_left] = self.hips_over(gait);
        let tip = Vec3::new(hips_ahead + 0.06 * h + x, hips_left - 0.155 * h, z);
        // The grip is near above the tip, leaning after the hand.
        let grip = Vec3::new(0.6 * tip.x + 0.4 * (hips_ahead + 0.05 * h), tip.y - 0.005 * h, 0.0);
        let lean = Vec3::new(grip.x - tip.x, grip.y - tip.y, self.cane_m());
        let grip = tip + lean.normalize_or(Vec3::Z) * self.cane_m();
        let hand = self.take_hold(bones, Side::Right, grip, Vec3::new(-1.0, -0.35, 0.0));
        bones.place(Bone::Cane, crate::people::joints::hanging(hand, tip, Vec3::X));
    }

    /// A shovel before the body, its blade on the ground while somebody stands; one who walks carries it a
    /// little above.
    fn place_shovel(&self, bones: &mut Bones, hips: [f32; 2], gait: &Gait) {
        let h = self.stature;
        let at = |x: f32, y: f32, z: f32| Vec3::new(hips[0] + x * h, hips[1] + y * h, z * h);
        let way = (at(0.11, -0.02, 0.62) - at(0.24, 0.06, 0.0)).normalize_or(Vec3::Z);
        let tip = at(0.24, 0.06, 0.0048 + 0.08 * gait.vigour);
        let top = tip + way * self.shovel_m();
        bones.place(Bone::Shovel, crate::people::joints::hanging(top, tip, Vec3::X));
        for (side, share) in [(Side::Right, 0.97), (Side::Left, 0.82)] {
            let bends = Vec3::new(-0.7, 0.6 * side.sign(), -0.4);
            self.take_hold(bones, side, tip.lerp(top, share), bends);
        }
    }

    /// Length of a shovel, metres.
    pub(crate) fn shovel_m(&self) -> f32 {
        0.66 * self.stature
    }

    /// The palm of a side at a place, or as near to it as the arm reaches, its elbow bent to `bends`; gives
    /// where the palm is.
    pub(crate) fn take_hold(&self, bones: &mut Bones, side: Side, at: Vec3, bends: Vec3) -> Vec3 {
        let limb = Limb {
            root: bones.object_from_bone(Bone::Chest).transform_point3(self.shoulder(side)),
            upper: self.upper_arm,
            lower: self.forearm + 0.45 * self.hand,
            bends,
            forward: false,
        };
        let ([upper, lower], palm) = limb.reach(at);
        let [a, b] = side.arm();
        bones.place(a, upper);
        bones.place(b, lower);
        palm
    }

    /// Length of a cane, metres.
    pub(crate) fn cane_m(&self) -> f32 {
        0.49 * self.stature
    }
}
