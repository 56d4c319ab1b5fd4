//! Wheelchairs with those who sit in them: the large wheels turn with the phase, and the arms push once a turn.

use std::sync::Arc;

use glam::Vec3;
use schema::Tag;
use schema::geometry::{Part, Surface, TriMesh};
use schema::models::Model;

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::solids::MeshBuilder;
use crate::walker::{HAIR, SKIN, TOPS, TROUSERS, pick};
use crate::wheel;

/// Width of a large wheel's tyre, metres.
const TYRE_M: f32 = 0.035;
/// Largest swing of an arm, radians.
const PUSH_RAD: f32 = 0.35;

/// A wheelchair; the variant dresses who sits in it.
pub(crate) fn wheelchair(model: &Model, size: Vec3, variant: u32) -> ActorMesh {
    let cloth = |rgb: [f32; 3]| Part::new(Tag::Pedestrian, Surface::Cloth, rgb);
    let (top, trousers) = (cloth(pick(&TOPS, variant)), cloth(pick(&TROUSERS, variant / 3)));
    let (skin, hair) = (cloth(pick(&SKIN, variant / 7)), cloth(pick(&HAIR, variant / 11)));
    let frame = Part::new(Tag::Pedestrian, Surface::Metal, [0.30, 0.31, 0.33]);
    let canvas = Part::new(Tag::Pedestrian, Surface::Cloth, [0.03, 0.03, 0.04]);
    let rubber = Part::new(Tag::Pedestrian, Surface::Rubber, [0.04; 3]);
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let wheel_y = half.y - 0.5 * TYRE_M;
    // The large wheels under the shoulders; the handles are the rearmost, the feet the foremost points.
    let axle = Vec3::new(0.55 * radius - half.x + 0.18, 0.0, radius);
    let seat = Vec3::new(axle.x + 0.20, 0.0, 0.40 * size.z);
    let back_x = seat.x - 0.22;
    let foot = Vec3::new(half.x - 0.14, 0.0, 0.12);
    let side = half.y - TYRE_M - 0.05;

    let mut b = MeshBuilder::new();
    b.cuboid(canvas, Vec3::new(back_x, -side, seat.z - 0.04), Vec3::new(seat.x + 0.22, side, seat.z));
    b.cuboid(canvas, Vec3::new(back_x - 0.03, -side, seat.z), Vec3::new(back_x, side, seat.z + 0.40));
    for y in [-side, side] {
        let at = |x: f32, z: f32| Vec3::new(x, y, z);
        // Back tube with its handle, seat rail, front tube to the foot rest, arm rest.
        b.bar(frame, at(back_x, axle.z - 0.05), at(back_x, seat.z + 0.44), [0.014; 2], 4);
        b.bar(rubber, at(back_x, seat.z + 0.44), at(-half.x, seat.z + 0.46), [0.018; 2], 5);
        b.bar(frame, at(back_x, seat.z - 0.02), at(seat.x + 0.24, seat.z - 0.02), [0.014; 2], 4);
        b.bar(frame, at(seat.x + 0.24, seat.z - 0.02), at(foot.x - 0.06, foot.z), [0.013; 2], 4);
        b.bar(frame, at(back_x, axle.z - 0.05), at(seat.x + 0.20, 0.19), [0.013; 2], 4);
        b.bar(frame, at(seat.x + 0.20, seat.z - 0.02), at(seat.x + 0.20, 0.17), [0.013; 2], 4);
        b.cuboid(
            rubber,
            at(back_x + 0.04, seat.z + 0.20) - Vec3::Y * 0.025,
            at(seat.x + 0.14, seat.z + 0.23) + Vec3::Y * 0.025,
        );
        // Caster.
        let hub = Vec3::new(seat.x + 0.20, y, 0.085);
        b.bar(rubber, hub - Vec3::Y * 0.015, hub + Vec3::Y * 0.015, [0.085; 2], 9);
        b.bar(frame, hub, hub + Vec3::Z * 0.10, [0.012; 2], 3);
    }
    b.cuboid(rubber, Vec3::new(foot.x - 0.12, -0.17, foot.z - 0.02), Vec3::new(foot.x + 0.06, 0.17, foot.z));
    b.bar(frame, axle - Vec3::Y * wheel_y, axle + Vec3::Y * wheel_y, [0.012; 2], 6);

    let hip = Vec3::new(back_x + 0.13, 0.0, seat.z + 0.08);
    let shoulder_z = seat.z + 0.54;
    let chest = 0.30 * size.y;
    sitter(&mut b, size, [top, trousers, skin, hair, rubber], hip, shoulder_z, [seat, foot]);
    b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, size.z));

    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let large = Arc::new(wheel::spoked(Tag::Pedestrian, radius, TYRE_M, 7));
    for (y, right) in [(wheel_y, false), (-wheel_y, true)] {
        let joint = Joint::Wheel { at: Vec3::new(axle.x, y, radius), steered: false, right };
        pieces.push(Piece { mesh: Arc::clone(&large), joint });
    }
    // Hands on the rims' tops.
    let shoulder = Vec3::new(hip.x, chest + 0.03, shoulder_z);
    let hand = Vec3::new(axle.x + 0.05, side - 0.02, 2.0 * radius + 0.05);
    for mirror in [1.0, -1.0] {
        let turned = Vec3::new(1.0, mirror, 1.0);
        let mesh = Arc::new(arm(top, skin, (hand - shoulder) * turned));
        pieces.push(Piece { mesh, joint: Joint::Limb { at: shoulder * turned, swing_rad: PUSH_RAD } });
    }
    ActorMesh { pieces }
}

/// Who sits in a wheelchair, without arms. `[seat, foot]`: the seat's middle, and where the feet stand.
fn sitter(
    b: &mut MeshBuilder,
    size: Vec3,
    [top, trousers, skin, hair, shoes]: [Part; 5],
    hip: Vec3,
    shoulder_z: f32,
    [seat, foot]: [Vec3; 2],
) {
    let half = 0.5 * size;
    let chest = 0.30 * size.y;
    b.stack(
        top,
        &[
            (hip - Vec3::Z * 0.08, 0.12, 0.82 * chest),
            (hip + Vec3::Z * 0.16, 0.12, 0.86 * chest),
            (Vec3::new(hip.x, 0.0, shoulder_z - 0.06), 0.12, chest),
            (Vec3::new(hip.x, 0.0, shoulder_z + 0.03), 0.09, 0.85 * chest),
            (Vec3::new(hip.x + 0.01, 0.0, shoulder_z + 0.07), 0.06, 0.07),
        ],
        10,
    );
    for y in [-0.10, 0.10] {
        let knee = Vec3::new(seat.x + 0.28, y, seat.z + 0.09);
        let ankle = Vec3::new(foot.x - 0.03, y, foot.z + 0.05);
        b.bar(trousers, Vec3::new(hip.x, y, hip.z), knee, [0.085, 0.068], 8);
        b.ellipsoid(trousers, knee, Vec3::splat(0.07), 4, 6);
        b.bar(trousers, knee, ankle, [0.065, 0.045], 8);
        b.tapered(
            shoes,
            Vec3::new(foot.x - 0.10, y - 0.045, foot.z),
            Vec3::new(half.x, y + 0.045, foot.z + 0.09),
            0.75,
            0.8,
        );
    }
    let head_half = Vec3::new(0.10, 0.08, 0.115);
    let head = Vec3::new(hip.x + 0.03, 0.0, size.z - head_half.z - 0.01);
    b.bar(skin, Vec3::new(hip.x + 0.02, 0.0, shoulder_z + 0.02), head, [0.05; 2], 6);
    b.ellipsoid(skin, head, head_half, 6, 9);
    b.ellipsoid(hair, head + Vec3::new(-0.018, 0.0, 0.024), Vec3::new(0.094, 0.086, 0.10), 5, 9);
}

/// An arm from its hinge to a hand.
fn arm(sleeve: Part, skin: Part, hand: Vec3) -> TriMesh {
    let mut b = MeshBuilder::new();
    let elbow = 0.5 * hand + Vec3::new(-0.09, 0.02 * hand.y.signum(), 0.0);
    b.ellipsoid(sleeve, Vec3::ZERO, Vec3::splat(0.06), 4, 6);
    b.bar(sleeve, Vec3::ZERO, elbow, [0.055, 0.048], 7);
    b.bar(sleeve, elbow, hand, [0.048, 0.036], 7);
    b.ellipsoid(skin, hand, Vec3::new(0.045, 0.035, 0.05), 4, 6);
    b.finish()
}
