//! What carries roads above the land: retaining walls, decks, piers and guard rails.

use nalgebra::{Point3, Vector3};
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::surfaces::blocks::Blocks;
use crate::surfaces::ground::GroundLevels;
use crate::surfaces::region::Region;
use crate::surfaces::sections::Section;
use schema::Layer;

/// Roads this far above the land have walls and rails, metres.
pub(crate) const WALL_FROM_M: f64 = 1.0;
/// Roads this far above the land are bridges, metres.
const BRIDGE_FROM_M: f64 = 3.0;
/// Thickness of a deck, metres.
const DECK_M: f64 = 0.8;
/// Distance between piers, metres.
const PIER_EVERY_M: f64 = 24.0;
const PIER_HALF_M: f64 = 0.7;
/// Rail over the edge: lower and upper edge, thickness, metres.
const RAIL_M: [f64; 3] = [0.45, 0.78, 0.08];
const POST_EVERY_M: f64 = 4.0;

const DECK: MeshPart = MeshPart::new(Tag::Bridge, Surface::Concrete, [0.36, 0.35, 0.33]);
const RAIL: MeshPart = MeshPart::new(Tag::GuardRail, Surface::Metal, [0.45, 0.46, 0.47]);

/// Draws what carries the pieces of roads that begin in an area.
pub(crate) fn build(sections: &[&Section], area: &Region, ground: &GroundLevels, blocks: &mut Blocks) {
    for section in sections {
        if !(0..section.s.len() - 1).any(|i| section.inside(i, area)) {
            continue;
        }
        let (Some((right, out_right)), Some((left, out_left))) = (section.edge(0), section.edge(1)) else {
            continue;
        };
        let mut along_m = 0.0;
        for i in 0..right.len() - 1 {
            let step = 0.5 * ((right[i + 1] - right[i]).norm() + (left[i + 1] - left[i]).norm());
            let from_m = along_m;
            along_m += step;
            // Piers and posts stand at fixed distances along the section, wherever it is looked at from.
            let stands = |every_m: f64| (from_m / every_m).ceil() * every_m < along_m;
            if !section.inside(i, area) {
                continue;
            }
            let over = |p: &Point3<f64>| p.z - ground.terrain.height(p.x, p.y);
            let height = over(&right[i]).max(over(&left[i])).max(over(&right[i + 1])).max(over(&left[i + 1]));
            if height < WALL_FROM_M {
                continue;
            }
            let bridge = height >= BRIDGE_FROM_M;
            let lowered = |p: &Point3<f64>| {
                let depth = if bridge { DECK_M } else { over(p) + 0.3 };
                Point3::new(p.x, p.y, p.z - depth)
            };
            let under = [&right[i], &right[i + 1], &left[i + 1], &left[i]].map(lowered);
            // Seen from below, the underside runs the other way round.
            if bridge {
                blocks.quad(Layer::Bridge, DECK, [under[3], under[2], under[1], under[0]]);
            }
            for (side, edge, out, low) in
                [(0, right, &out_right, [under[0], under[1]]), (1, left, &out_left, [under[3], under[2]])]
            {
                // Where another lane goes on at the same height there is no edge.
                let beside = edge[i] + (edge[i + 1] - edge[i]) * 0.5 + out[i] * 0.4;
                if ground.cover.at(beside.x, beside.y).any(|(_, z)| (z - beside.z).abs() < 1.0) {
                    continue;
                }
                let (a, b) = (edge[i], edge[i + 1]);
                let wall = [low[0], low[1], b, a];
                blocks.quad(
                    Layer::Bridge,
                    DECK,
                    if side == 0 { wall } else { [wall[1], wall[0], wall[3], wall[2]] },
                );
                rail(blocks, [a, b], [out[i], out[i + 1]]);
                if stands(POST_EVERY_M) {
                    let foot = a - out[i] * 0.06;
                    column(blocks, Layer::GuardRail, RAIL, foot, 0.05, foot.z, foot.z + RAIL_M[1]);
                }
            }
            if bridge && stands(PIER_EVERY_M) {
                let middle = Point3::from(
                    0.25 * (right[i].coords + left[i].coords + right[i + 1].coords + left[i + 1].coords),
                );
                let free = (0..9).all(|k| {
                    let (x, y) =
                        (middle.x + 1.5 * f64::from(k % 3 - 1), middle.y + 1.5 * f64::from(k / 3 - 1));
                    !ground.cover.at(x, y).any(|(_, z)| z < middle.z - 1.5)
                });
                if free {
                    let low = ground.terrain.height(middle.x, middle.y) - 0.5;
                    column(blocks, Layer::Bridge, DECK, middle, PIER_HALF_M, low, middle.z - DECK_M);
                }
            }
        }
    }
}

/// A beam along an edge, a little inside it.
fn rail(blocks: &mut Blocks, edge: [Point3<f64>; 2], out: [Vector3<f64>; 2]) {
    let [low, high, thick] = RAIL_M;
    let at = |k: usize, inward: f64, up: f64| edge[k] - out[k] * inward + Vector3::z() * up;
    for (inward, sign) in [(0.0, true), (thick, false)] {
        let quad = [at(0, inward, low), at(1, inward, low), at(1, inward, high), at(0, inward, high)];
        // Whether the outer face looks to the right of the way from the first end to the second.
        let along = edge[1] - edge[0];
        let right = Vector3::new(along.y, -along.x, 0.0).dot(&out[0]) > 0.0;
        blocks.quad(
            Layer::GuardRail,
            RAIL,
            if right == sign { quad } else { [quad[1], quad[0], quad[3], quad[2]] },
        );
    }
    let top = [at(0, 0.0, high), at(1, 0.0, high), at(1, thick, high), at(0, thick, high)];
    let along = edge[1] - edge[0];
    let right = Vector3::new(along.y, -along.x, 0.0).dot(&out[0]) > 0.0;
    blocks.quad(Layer::GuardRail, RAIL, if right { top } else { [top[3], top[2], top[1], top[0]] });
}

/// An upright square column without end faces.
fn column(
    blocks: &mut Blocks,
    layer: Layer,
    part: MeshPart,
    middle: Point3<f64>,
    half: f64,
    low: f64,
    high: f64,
) {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let at = |c: (f64, f64), z: f64| Point3::new(middle.x + c.0, middle.y + c.1, z);
        blocks.quad(layer, part, [at(a, low), at(b, low), at(b, high), at(a, high)]);
    }
}
