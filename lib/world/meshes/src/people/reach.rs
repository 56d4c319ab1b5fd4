//! Poses of those who sit: on a two-wheeler, or in a wheelchair.

use glam::{Affine3A, Vec3};

use crate::people::figure::{BONES, Bone, Bones, Figure, Side};
use crate::people::joints::{Limb, about_y, frame};

/// What somebody who sits holds on to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seat {
    /// Middle between the hip joints, object frame, metres.
    pub hips: Vec3,
    /// How far the trunk leans forward, radians.
    pub lean_rad: f32,
    /// Where the hands are, left and right: the middle of the palm.
    pub hands: [Vec3; 2],
    /// Where the balls of the feet stand, left and right, on their soles.
    pub balls: [Vec3; 2],
    /// How far the heels are up, radians.
    pub heels_rad: f32,
    /// Where the knees bend to.
    pub knees: Vec3,
    /// Where the elbows bend to, on the left.
    pub elbows: Vec3,
}

impl Figure {
    /// Where the bones are of somebody who sits.
    #[must_use]
    pub fn seated(&self, seat: &Seat) -> Bones {
        let mut bones = Bones([Affine3A::IDENTITY; BONES]);
        bones.place(Bone::Pelvis, frame(about_y(0.75 * seat.lean_rad - 0.10), seat.hips));
        let waist = bones.object_from_bone(Bone::Pelvis).transform_point3(Vec3::Z * self.waist);
        bones.place(Bone::Chest, frame(about_y(seat.lean_rad), waist));
        let chest = bones.object_from_bone(Bone::Chest);
        bones.place(Bone::Head, frame(about_y(0.25 * seat.lean_rad), chest.transform_point3(self.neck)));
        for side in Side::BOTH {
            let k = usize::from(side == Side::Right);
            self.sit_leg(&mut bones, side, seat, seat.balls[k]);
            let elbow = seat.elbows * Vec3::new(1.0, side.sign(), 1.0);
            self.take_hold(&mut bones, side, seat.hands[k], elbow);
        }
        bones
    }

    fn sit_leg(&self, bones: &mut Bones, side: Side, seat: &Seat, ball: Vec3) {
        let turn = about_y(seat.heels_rad);
        let ankle = ball + Vec3::from(turn * glam::Vec3A::new(-self.ball, 0.0, self.ankle));
        let pelvis = bones.object_from_bone(Bone::Pelvis);
        let limb = Limb {
            root: pelvis.transform_point3(self.hip(side)),
            upper: self.thigh,
            lower: self.shin,
            bends: seat.knees * Vec3::new(1.0, side.sign(), 1.0),
            forward: true,
        };
        let ([thigh, shin], ankle) = limb.reach(ankle);
        let [a, b, c, d] = side.leg();
        bones.place(a, thigh);
        bones.place(b, shin);
        bones.place(c, frame(turn, ankle));
        let hinge = bones.object_from_bone(c).transform_point3(self.hinge());
        bones.place(d, frame(turn * about_y(-seat.heels_rad.max(0.0)), hinge));
    }
}
