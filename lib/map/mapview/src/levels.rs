//! Which piece of road lies over which.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;

use crate::stretch::{Carrier, Stretch};

/// Roads at least this far above others are over them, metres.
const CLEARANCE_M: f64 = 2.5;
/// Side of the cells in which roads are compared, metres.
const CELL_M: f64 = 3.0;
/// Most decks one over the other.
const MAX_LEVEL: i8 = 12;

/// Raises the level of every piece above that of all pieces under it.
pub(crate) fn assign(stretches: &mut [Stretch]) {
    let mut over: BTreeSet<[(usize, usize); 2]> = BTreeSet::new();
    for here in cells(stretches).values() {
        for (i, (a, za)) in here.iter().enumerate() {
            for (b, zb) in &here[i + 1..] {
                if a != b && (za - zb).abs() > CLEARANCE_M {
                    over.insert(if za < zb { [*a, *b] } else { [*b, *a] });
                }
            }
        }
    }
    // Each pass carries the levels one deck higher.
    for _ in 0..MAX_LEVEL {
        let mut changed = false;
        for [low, high] in &over {
            let below = stretches[low.0].pieces[low.1].level;
            let piece = &mut stretches[high.0].pieces[high.1];
            if piece.carrier != Carrier::Tunnel && piece.level <= below && below < MAX_LEVEL {
                piece.level = below + 1;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// Stretch and piece, with its height.
type PieceHeight = ((usize, usize), f64);

/// What lies in each cell of a grid over the world: each piece once, with one of its heights there.
fn cells(stretches: &[Stretch]) -> BTreeMap<[i32; 2], Vec<PieceHeight>> {
    let mut cells: BTreeMap<[i32; 2], Vec<PieceHeight>> = BTreeMap::new();
    for (k, stretch) in stretches.iter().enumerate() {
        let Some([right, left]) = stretch.edges() else { continue };
        for (p, piece) in stretch.pieces.iter().enumerate() {
            let [from, to] = piece.samples;
            for i in from..to {
                let steps = |a: f64, b: f64| (a.max(b) / (0.9 * CELL_M)).ceil().clamp(1.0, 1000.0) as usize;
                let along = steps((right[i + 1] - right[i]).norm(), (left[i + 1] - left[i]).norm());
                let across = steps((left[i] - right[i]).norm(), (left[i + 1] - right[i + 1]).norm());
                for a in 0..=along {
                    let u = a as f64 / along as f64;
                    let mix = |chain: &[Point3<f64>]| chain[i] + (chain[i + 1] - chain[i]) * u;
                    let (r, l) = (mix(right), mix(left));
                    for b in 0..=across {
                        let at = r + (l - r) * (b as f64 / across as f64);
                        let cell = [at.x, at.y].map(|v| (v / CELL_M).floor() as i32);
                        let here = cells.entry(cell).or_default();
                        if here.iter().rev().take(4).all(|(place, _)| *place != (k, p)) {
                            here.push(((k, p), at.z));
                        }
                    }
                }
            }
        }
    }
    cells
}
