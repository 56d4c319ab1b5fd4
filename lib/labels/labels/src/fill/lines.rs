//! Which candidates meet the class first along the lines of columns to their four sides.

use crate::fill::bits::Bits;
use crate::fill::met::FirstHit;
use crate::fill::read::Entry;

/// A grid's columns in lines, while one class is filled.
pub(super) struct Lines<'a, const W: usize> {
    /// Free cells of each column (i-major).
    free: &'a [Bits<W>],
    /// The class at hand.
    dense: &'a [Bits<W>],
    /// First and last column of the class along y, by row (along x); and the other way round.
    along_y: Vec<[u32; 2]>,
    along_x: Vec<[u32; 2]>,
}

impl<'a, const W: usize> Lines<'a, W> {
    /// `parts` have the columns of the class.
    pub(super) fn new(
        free: &'a [Bits<W>],
        dense: &'a [Bits<W>],
        parts: &[&[Entry<W>]],
        [nx, ny, _]: [usize; 3],
    ) -> Self {
        const NONE: [u32; 2] = [u32::MAX, 0];
        let mut lines = Self { free, dense, along_y: vec![NONE; nx], along_x: vec![NONE; ny] };
        for entry in parts.iter().copied().flatten() {
            let spans = [
                (&mut lines.along_y[entry.i as usize], entry.j),
                (&mut lines.along_x[entry.j as usize], entry.i),
            ];
            for ([first, last], at) in spans {
                (*first, *last) = ((*first).min(at), (*last).max(at));
            }
        }
        lines
    }

    /// Keeps the cells of some columns, in column order, that meet the class first to the left and to the
    /// right.
    pub(super) fn keep_along_y(&self, columns: &mut [Entry<W>]) {
        let ny = self.along_x.len();
        let (mut met, mut next) = (FirstHit::NOTHING_KNOWN, None);
        for column in &mut *columns {
            let Entry { i, j, cells } = *column;
            let row = i as usize * ny;
            if next != Some((i, j)) {
                met = FirstHit::NOTHING_KNOWN;
            }
            let before = (self.along_y[i as usize][0]..j).rev();
            column.cells = met.ask(cells, before.map(|j| self.at(row + j as usize)));
            met.pass(self.at(row + j as usize));
            next = Some((i, j + 1));
        }
        let mut previous = None;
        for column in columns.iter_mut().rev() {
            let Entry { i, j, cells } = *column;
            let row = i as usize * ny;
            if previous != Some((i, j)) {
                met = FirstHit::NOTHING_KNOWN;
            }
            let behind = j + 1..self.along_y[i as usize][1] + 1;
            column.cells = met.ask(cells, behind.map(|j| self.at(row + j as usize)));
            met.pass(self.at(row + j as usize));
            previous = j.checked_sub(1).map(|j| (i, j));
        }
    }

    /// Keeps the cells of some columns, in column order and all of one band of `width` from `first` on along
    /// y, that meet the class first ahead and behind.
    pub(super) fn keep_along_x(&self, columns: &mut [Entry<W>], first: usize, width: usize) {
        let ny = self.along_x.len();
        let place = |i: u32, j: u32| i as usize * ny + j as usize;
        let mut lines = vec![(FirstHit::NOTHING_KNOWN, u32::MAX); width];
        for column in &mut *columns {
            let Entry { i, j, cells } = *column;
            let (met, next) = &mut lines[j as usize - first];
            if *next != i {
                *met = FirstHit::NOTHING_KNOWN;
            }
            let before = (self.along_x[j as usize][0]..i).rev();
            column.cells = met.ask(cells, before.map(|i| self.at(place(i, j))));
            met.pass(self.at(place(i, j)));
            *next = i + 1;
        }
        lines.fill((FirstHit::NOTHING_KNOWN, u32::MAX));
        for column in columns.iter_mut().rev() {
            let Entry { i, j, cells } = *column;
            let (met, previous) = &mut lines[j as usize - first];
            if *previous != i {
                *met = FirstHit::NOTHING_KNOWN;
            }
            let behind = i + 1..self.along_x[j as usize][1] + 1;
            column.cells = met.ask(cells, behind.map(|i| self.at(place(i, j))));
            met.pass(self.at(place(i, j)));
            *previous = i.wrapping_sub(1);
        }
    }

    /// Free cells of a column, and those of the class.
    #[inline]
    fn at(&self, column: usize) -> [Bits<W>; 2] {
        [self.free[column], self.dense[column]]
    }
}
