//! Guard rails.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use super::outline::along_y;
use super::parts::block;
use crate::solids::MeshBuilder;

const ZINC: MeshPart = MeshPart::new(Tag::GuardRail, Surface::Metal, [0.42, 0.43, 0.44]);
/// Distance between posts, metres.
const POSTS_M: f32 = 2.0;
/// The beam's section: forward, as a share of its depth, and upward, as one of its height.
const WAVES: [[f32; 2]; 10] = [
    [0.10, 0.0],
    [0.30, 0.03],
    [1.0, 0.16],
    [1.0, 0.32],
    [0.16, 0.46],
    [0.16, 0.54],
    [1.0, 0.68],
    [1.0, 0.84],
    [0.30, 0.97],
    [0.10, 1.0],
];
/// Depth and height of the beam, and how thick it is, metres.
const BEAM_M: [f32; 2] = [0.083, 0.31];
const THICK_M: f32 = 0.008;

/// A beam with two waves along y on posts; its ends meet those of the next piece.
pub(super) fn guard_rail(b: &mut MeshBuilder, size: Vec3, _variant: u32) {
    let (half, h) = (0.5 * size, size.z);
    let (back, low) = (half.x - BEAM_M[0], h - BEAM_M[1]);
    let at = |[u, v]: [f32; 2], off: f32| [back + u * BEAM_M[0] - off, low + v * BEAM_M[1]];
    // Strip by strip, as the section is no outline that one corner sees whole.
    for pair in WAVES.windows(2) {
        let [p, q] = [pair[0], pair[1]];
        along_y(b, ZINC, &[at(p, 0.0), at(q, 0.0), at(q, THICK_M), at(p, THICK_M)], [-half.y, half.y]);
    }
    let posts = (size.y / POSTS_M).round().max(1.0);
    for k in 0..posts as usize {
        let y = -half.y + size.y * (k as f32 + 0.5) / posts;
        // A post of C section: a web and two flanges, and a block behind the beam.
        block(b, ZINC, [-half.x + 0.055, y + 0.03], [0.055, 0.004], [0.0, h - 0.04]);
        for x in [-half.x + 0.004, -half.x + 0.106] {
            block(b, ZINC, [x, y], [0.004, 0.028], [0.0, h - 0.04]);
        }
        let (from, to) = (-half.x + 0.11, back + 0.02);
        block(b, ZINC, [0.5 * (from + to), y], [0.5 * (to - from), 0.03], [low + 0.04, h - 0.04]);
    }
}
