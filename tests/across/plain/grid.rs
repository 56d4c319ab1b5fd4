//! The grid of an agent's masks, and what its cells should hold.

use nalgebra::Vector3;
use schema::BevClass;

pub(super) const SIDE: usize = 400;
pub(super) const CELL_M: f64 = 0.4;
/// The way over the ground is looked for this many cells beyond the mask, too: 60 m.
pub(super) const BEYOND: usize = 150;
pub(super) const WIDE: usize = SIDE + 2 * BEYOND;
/// Nearer to an edge than this, rounding decides on which side a centre lies, cells; and nearer in height,
/// metres.
pub(super) const TIE: f64 = 2e-3;
/// Ground surfaces this near above one another are one layer, metres.
pub(super) const LAYER_M: f64 = 1.5;

/// An agent's grid: column, row (cells), height above the agent (metres).
pub(super) struct Grid {
    pub(super) origin: [f64; 3],
    pub(super) ahead: (f64, f64),
}

impl Grid {
    pub(super) fn of(&self, p: Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.ahead;
        let (dx, dy) = (p.x - self.origin[0], p.y - self.origin[1]);
        let middle = 0.5 * SIDE as f64;
        let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
        Vector3::new(middle - left / CELL_M, middle - ahead / CELL_M, p.z - self.origin[2])
    }
}

pub(super) fn bit(class: BevClass) -> u16 {
    1 << class as u16
}

/// The bits that each cell surely has, and those that it may have.
pub(super) struct Bits {
    pub(super) sure: Vec<u16>,
    pub(super) perhaps: Vec<u16>,
}

impl Bits {
    pub(super) fn set(&mut self, cell: usize, class: BevClass, is_sure: bool) {
        self.perhaps[cell] |= bit(class);
        if is_sure {
            self.sure[cell] |= bit(class);
        }
    }
}
