//! Wires from the arm of one utility pole to that of the next one.

use std::sync::Arc;

use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::actors::pieces::{ActorMesh, Coarser, Joint, Piece};
use crate::solids::{MeshBuilder, circle};

const CABLE: MeshPart = MeshPart::new(Tag::Other, Surface::Plain, [0.02, 0.02, 0.022]);
/// Where wires hang on an arm, as shares of half its length.
const HELD: [f32; 4] = [-0.94, -0.42, 0.42, 0.94];
/// The box is so much wider than the arm, and the ends of wires are so far below its top, metres.
const WIDER_M: f32 = 0.1;
const ROOM_M: f32 = 0.05;
/// From where on, how thick and of how many pieces wires are, and every how many of them are there: what is
/// much thinner than a pixel would be dots, so from afar they are thicker and one stands for two.
const LEVELS: [(f64, f32, usize, usize); 4] =
    [(0.0, 0.0125, 6, 1), (15.0, 0.02, 6, 1), (40.0, 0.035, 4, 2), (80.0, 0.05, 3, 2)];
/// Beyond this there are none, metres.
const UNTIL_M: f64 = 120.0;

/// Wires along x that hang down in between. The variant says how the arms at their beginning and end are
/// turned against them, in whole degrees, 0 being half a turn back.
pub(crate) fn wires(size: Vec3, variant: u32) -> ActorMesh {
    let turns = [variant & 0x1ff, variant >> 9 & 0x1ff].map(|turn| (turn as f32 - 180.0).to_radians());
    let arm = 0.5 * (size.y - WIDER_M) - 0.02;
    let level = |radius: f32, steps: usize, every: usize| {
        let mut b = MeshBuilder::new();
        for share in HELD.into_iter().skip(every - 1).step_by(every) {
            // The box runs from the middle of one arm to the middle of the other one.
            let ends = [(-0.5, turns[0]), (0.5, turns[1])].map(|(side, turn)| {
                let (s, c) = sin_cos(turn);
                Vec3::new(side * size.x + share * arm * c, share * arm * s, size.z - ROOM_M)
            });
            wire(&mut b, ends, size.z - 2.0 * ROOM_M, radius, steps);
        }
        vec![Piece { mesh: Arc::new(b.finish()), joint: Joint::Fixed }]
    };
    let [near, far @ ..] = LEVELS.map(|(from_m, radius, steps, every)| (from_m, level(radius, steps, every)));
    let far = far.into_iter().chain([(UNTIL_M, Vec::new())]);
    let coarser = far.map(|(from_m, pieces)| Coarser { from_m, pieces }).collect();
    ActorMesh { coarser, ..ActorMesh::of(near.1) }
}

/// A tube of three sides that hangs down from its ends by so much in the middle, metres.
fn wire(b: &mut MeshBuilder, [from, to]: [Vec3; 2], sag_m: f32, radius: f32, steps: usize) {
    let across = (to - from).cross(Vec3::Z).normalize_or(Vec3::Y);
    let rings: Vec<Vec<Vec3>> = (0..=steps)
        .map(|k| {
            let share = k as f32 / steps as f32;
            let off = 2.0 * share - 1.0;
            let middle = from + (to - from) * share - Vec3::Z * (sag_m * (1.0 - off * off));
            circle(3).map(|(c, s)| middle + radius * (c * Vec3::Z + s * across)).collect()
        })
        .collect();
    b.loft(&rings, |_, _| CABLE, [CABLE; 2]);
}
