//! What is met first along a line of columns.

use crate::fill::bits::Bits;

/// For each cell of a column: whether the first occupied cell on one side of it, along a line of columns, is
/// of the class at hand. Carried from column to column; where nothing is known yet, found by a walk that ends
/// when all that is asked is decided.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstHit<const W: usize> {
    /// Cells of which it is known.
    known: Bits<W>,
    /// Those of them of which it is so.
    met: Bits<W>,
}

impl<const W: usize> FirstHit<W> {
    pub(super) const NOTHING_KNOWN: Self = Self { known: Bits::ZERO, met: Bits::ZERO };

    /// Those of some cells whose first occupied cell is of the class. `line` gives the cells of the columns
    /// on that side, the nearest first, up to where none is of the class any more: free ones, and those of
    /// the class.
    #[inline]
    pub(super) fn ask(&mut self, cells: Bits<W>, line: impl Iterator<Item = [Bits<W>; 2]>) -> Bits<W> {
        let mut open = cells & !self.known;
        if !open.is_zero() {
            self.known = self.known | open;
            for [free, of_class] in line {
                self.met = self.met | (open & of_class);
                open = open & free;
                if open.is_zero() {
                    break;
                }
            }
        }
        cells & self.met
    }

    /// Goes on by a column: its free cells, and those of the class.
    #[inline]
    pub(super) fn pass(&mut self, [free, of_class]: [Bits<W>; 2]) {
        self.met = of_class | (free & self.met);
        self.known = self.known | !free;
    }
}
