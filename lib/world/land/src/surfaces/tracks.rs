//! Rails and sleepers on the beds of railways.

use nalgebra::{Point3, Vector3};
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::surfaces::blocks::Blocks;
use crate::surfaces::ground::GroundLevels;
use crate::surfaces::lanes::free_of_traffic;
use crate::surfaces::region::Region;
use crate::surfaces::sections::{Ground, Section, Strip};
use schema::Layer;

const STEEL: MeshPart = MeshPart::new(Tag::RailTrack, Surface::Metal, [0.32, 0.30, 0.28]);
const SLEEPER: MeshPart = MeshPart::new(Tag::RailTrack, Surface::Concrete, [0.24, 0.23, 0.22]);
/// Standard gauge, from the middle of one rail to that of the other, metres.
const GAUGE_M: f64 = 1.505;
/// Width of a rail's head and height of a rail over its bed, metres; in a level crossing it hardly stands
/// out.
const RAIL_M: [f64; 2] = [0.07, 0.17];
const FLUSH_M: f64 = 0.012;
/// Sleepers: half their length, half their width, height, distance, metres.
const SLEEPER_M: [f64; 4] = [1.3, 0.13, 0.05, 0.65];

/// Draws the rails and sleepers of pieces that begin in an area.
pub(crate) fn build(sections: &[&Section], area: &Region, ground: &GroundLevels, blocks: &mut Blocks) {
    for section in sections {
        for strip in section.strips.iter().filter(|s| s.ground == Ground::Track) {
            let mut along_m = 0.0;
            for i in 0..section.s.len() - 1 {
                let ends = [i, i + 1].map(|i| nalgebra::center(&strip.right[i], &strip.left[i]));
                let length = (ends[1] - ends[0]).norm();
                let from = along_m;
                along_m += length;
                if length < 1e-6 || !section.inside(i, area) {
                    continue;
                }
                let open = free_of_traffic(section, strip, i, &ground.cover);
                for side in [-0.5, 0.5] {
                    rail(blocks, strip, i, side * GAUGE_M, if open { RAIL_M[1] } else { FLUSH_M });
                }
                if open {
                    sleepers(blocks, ends, from);
                }
            }
        }
    }
}

/// Unit vector to the left of a strip at a sample, in its surface.
fn left_of(strip: &Strip, i: usize) -> Vector3<f64> {
    (strip.left[i] - strip.right[i]).try_normalize(1e-9).unwrap_or_default()
}

/// A piece of a rail, `left_m` to the left of the strip's middle.
fn rail(blocks: &mut Blocks, strip: &Strip, i: usize, left_m: f64, height_m: f64) {
    let edge = |i: usize, aside: f64, up: f64| {
        let middle = nalgebra::center(&strip.right[i], &strip.left[i]);
        middle + left_of(strip, i) * (left_m + aside) + Vector3::z() * up
    };
    let half = 0.5 * RAIL_M[0];
    let (j, h) = (i + 1, height_m);
    blocks.quad(
        Layer::Track,
        STEEL,
        [edge(i, -half, h), edge(j, -half, h), edge(j, half, h), edge(i, half, h)],
    );
    if height_m > FLUSH_M {
        blocks.quad(
            Layer::Track,
            STEEL,
            [edge(i, -half, 0.0), edge(j, -half, 0.0), edge(j, -half, h), edge(i, -half, h)],
        );
        blocks.quad(
            Layer::Track,
            STEEL,
            [edge(j, half, 0.0), edge(i, half, 0.0), edge(i, half, h), edge(j, half, h)],
        );
    }
}

/// The sleepers of a straight piece that begins `from_m` after the strip does; their sides are too low to
/// matter.
fn sleepers(blocks: &mut Blocks, [a, b]: [Point3<f64>; 2], from_m: f64) {
    let [half_length, half_width, height, spacing] = SLEEPER_M;
    let length = (b - a).norm();
    let along = (b - a) / length;
    let left = Vector3::new(-along.y, along.x, 0.0);
    let mut at = (from_m / spacing).ceil() * spacing - from_m;
    while at < length {
        let middle = a + along * at + Vector3::z() * height;
        let corner = |u: f64, v: f64| middle + along * (u * half_width) + left * (v * half_length);
        blocks.quad(
            Layer::Track,
            SLEEPER,
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        );
        at += spacing;
    }
}
