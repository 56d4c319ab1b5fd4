//! Cells around scattered points (Worley, "A cellular texture basis function", 1996).

use crate::textures::noise::{hash2, unit};

/// The cell that a place lies in.
pub(crate) struct Cell {
    /// Distance from its point, in lattice steps.
    pub(crate) near: f32,
    /// How much farther the next point is.
    pub(crate) gap: f32,
    /// A number of its own, 0 to 1.
    pub(crate) own: f32,
}

/// The cell at a place of a tile with one point in each of `across[0]` by `across[1]` lattice squares.
pub(crate) fn cell(x: f32, y: f32, across: [i32; 2], seed: u32) -> Cell {
    let (x, y) = (x * across[0] as f32, y * across[1] as f32);
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let (mut first, mut second, mut own) = (f32::MAX, f32::MAX, 0);
    for r in row - 1..=row + 1 {
        for c in column - 1..=column + 1 {
            let word = hash2(c.rem_euclid(across[0]), r.rem_euclid(across[1]), seed);
            let at = |v: i32, bits: u32| v as f32 + 0.1 + 0.8 * (bits & 0xff) as f32 * (1.0 / 255.0);
            let (dx, dy) = (at(c, word) - x, at(r, word >> 8) - y);
            let away = dx * dx + dy * dy;
            if away < first {
                (second, first, own) = (first, away, word);
            } else if away < second {
                second = away;
            }
        }
    }
    let near = first.sqrt();
    Cell { near, gap: second.sqrt() - near, own: unit(own.wrapping_mul(0x9e37_79b1)) }
}
