//! Wheelchairs with those who sit in them: the large wheels turn with the phase, and the hands push them.

use std::sync::Arc;

use crate::people::{Appearance, Figure, Seat};
use crate::solids::{Detail, MeshBuilder};
use catalogue::Model;
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::actors::bodies::{body, coarser, fitted};
use crate::actors::pieces::{ActorMesh, Joint, Piece};
use crate::actors::rig::{Pusher, Rig};
use crate::actors::wheel;

/// Width of a large wheel's tyre, metres.
const TYRE_M: f32 = 0.035;

/// A wheelchair; the variant dresses the person in it.
pub(crate) fn wheelchair(model: &Model, size: Vec3, variant: u32) -> ActorMesh {
    let frame = MeshPart::new(Tag::Pedestrian, Surface::Metal, [0.30, 0.31, 0.33]);
    let canvas = MeshPart::new(Tag::Pedestrian, Surface::Cloth, [0.03, 0.03, 0.04]);
    let rubber = MeshPart::new(Tag::Pedestrian, Surface::Rubber, [0.04; 3]);
    let half = 0.5 * size;
    let radius = model.wheel_radius_m as f32;
    let wheel_y = half.y - 0.5 * TYRE_M;
    // The large wheels under the shoulders; the handles are the rearmost, the feet the foremost points.
    let axle = Vec3::new(0.55 * radius - half.x + 0.18, 0.0, radius);
    let seat = Vec3::new(axle.x + 0.20, 0.0, 0.36 * size.z);
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

    let high = b.clone().finish().aabb().max.z;
    let fit = b.fit(Vec3::new(-half.x, -half.y, 0.0), Vec3::new(half.x, half.y, high));

    let mut pieces = vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }];
    let large = Arc::new(wheel::spoked(Tag::Pedestrian, radius, TYRE_M, 7, Detail::Half));
    for (y, right) in [(wheel_y, false), (-wheel_y, true)] {
        let joint = Joint::Wheel { at: Vec3::new(axle.x, y, radius), steered: false, right };
        pieces.push(Piece { mesh: Arc::clone(&large), joint });
    }
    let ball = fit.apply(foot) + Vec3::new(-0.01, 0.10, 0.0);
    let hand = Vec3::new(axle.x, wheel_y - 0.03, 2.0 * radius);
    let mirror = Vec3::new(1.0, -1.0, 1.0);
    let sits = Seat {
        hips: fit.apply(Vec3::new(back_x + 0.13, 0.0, seat.z + 0.075)),
        lean_rad: 0.02,
        hands: [hand, hand * mirror],
        balls: [ball, ball * mirror],
        heels_rad: -0.05,
        knees: Vec3::new(1.0, 0.0, 1.0),
        elbows: Vec3::new(-1.0, 0.10, -0.2),
    };
    let figure =
        fitted(Figure::new(Appearance::new(model, variant).seated(), 1.65), |_| sits, sits.hips.z, size.z);
    let coarser = coarser(&figure, Tag::Pedestrian, &pieces);
    pieces.extend(body(&figure, Tag::Pedestrian, Detail::Full));
    let pusher = Pusher { figure, seat: sits, axle, rim_m: radius - 0.02, aside_m: wheel_y - 0.045 };
    ActorMesh { pieces, coarser, rig: Some(Arc::new(Rig::Pushes(pusher))), cabin: None }
}
