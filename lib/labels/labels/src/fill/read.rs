//! A grid as column masks: free cells, and which columns hold which class.

use crate::voxel_grid::VoxelGrid;
use rayon::prelude::*;

use crate::fill::bits::Bits;
use crate::fill::order::Classes;

/// Slices along x that one task takes.
pub(super) const SLICES: usize = 16;

/// Cells of one class in one column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<const W: usize> {
    pub(super) i: u32,
    pub(super) j: u32,
    pub(super) cells: Bits<W>,
}

impl<const W: usize> Entry<W> {
    /// Its column's place among all of a grid (i-major) of `ny` along y.
    pub(super) fn at(&self, ny: usize) -> usize {
        self.i as usize * ny + self.j as usize
    }
}

/// The columns that hold a class, in column order, of the slices that one task takes; by class.
#[derive(Debug)]
pub(super) struct SliceColumns<'c, const W: usize> {
    classes: &'c Classes,
    pub(super) columns: Vec<Vec<Entry<W>>>,
}

/// Reads a grid, part by part, and sets the free cells of each column (i-major).
pub(super) fn read<'c, const W: usize>(
    grid: &VoxelGrid,
    classes: &'c Classes,
    free: &mut [Bits<W>],
) -> Vec<SliceColumns<'c, W>> {
    let [_, ny, nz] = grid.shape;
    free.par_chunks_mut(SLICES * ny)
        .zip(grid.data.par_chunks(SLICES * ny * nz))
        .enumerate()
        .map(|(part, (free, cells))| {
            let mut found = SliceColumns { classes, columns: vec![Vec::new(); classes.count] };
            for (slice, (free, cells)) in free.chunks_mut(ny).zip(cells.chunks(ny * nz)).enumerate() {
                for (j, (free, column)) in free.iter_mut().zip(cells.chunks_exact(nz)).enumerate() {
                    *free = found.column((part * SLICES + slice) as u32, j as u32, column);
                }
            }
            found
        })
        .collect()
}

impl<const W: usize> SliceColumns<'_, W> {
    /// Notes the classes of a column and returns its free cells.
    fn column(&mut self, i: u32, j: u32, column: &[u8]) -> Bits<W> {
        let mut occupied = Bits::ZERO;
        let (groups, rest) = column.as_chunks::<8>();
        for (group, cells) in groups.iter().enumerate() {
            self.cells(i, j, group, u64::from_le_bytes(*cells), &mut occupied);
        }
        if !rest.is_empty() {
            let mut cells = [0; 8];
            cells[..rest.len()].copy_from_slice(rest);
            self.cells(i, j, groups.len(), u64::from_le_bytes(cells), &mut occupied);
        }
        Bits::range_below(column.len()) & !occupied
    }

    /// Notes a group of eight cells, the lowest in the lowest byte.
    #[inline]
    fn cells(&mut self, i: u32, j: u32, group: usize, cells: u64, occupied: &mut Bits<W>) {
        if cells == 0 {
            return;
        }
        let (word, shift) = (group / 8, 8 * (group % 8));
        let mut left = bytes_set(cells);
        occupied.0[word] |= left << shift;
        while left != 0 {
            let label = (cells >> (8 * left.trailing_zeros())) as u8;
            let same = left & !bytes_set(cells ^ (u64::from(label) * EVERY_BYTE));
            self.note(i, j, label, word, same << shift);
            left &= !same;
        }
    }

    fn note(&mut self, i: u32, j: u32, label: u8, word: usize, mask: u64) {
        let class = usize::from(self.classes.of[usize::from(label)]);
        let Some(columns) = self.columns.get_mut(class) else { return };
        match columns.last_mut() {
            Some(last) if last.i == i && last.j == j => last.cells.0[word] |= mask,
            _ => {
                let mut cells = Bits::ZERO;
                cells.0[word] = mask;
                columns.push(Entry { i, j, cells });
            }
        }
    }
}

/// One in each byte.
const EVERY_BYTE: u64 = 0x0101_0101_0101_0101;

/// Which bytes are not zero, the lowest in the lowest bit.
#[inline]
fn bytes_set(bytes: u64) -> u64 {
    const LOW_BITS: u64 = 0x7f * EVERY_BYTE;
    // No byte's sum runs over into the next.
    let highest = (((bytes & LOW_BITS) + LOW_BITS) | bytes) & !LOW_BITS;
    // Bit 8 k goes to bit 56 + k, and no two products meet.
    ((highest >> 7).wrapping_mul(0x0102_0408_1020_4080)) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_that_are_set_have_a_bit_each(bytes: [u8; 8], zeros: u8) {
            let bytes: [u8; 8] = std::array::from_fn(|k| if zeros >> k & 1 == 1 { 0 } else { bytes[k] });
            let want = (0..8).filter(|k| bytes[*k] != 0).map(|k| 1_u64 << k).sum::<u64>();
            prop_assert_eq!(bytes_set(u64::from_le_bytes(bytes)), want);
        }
    }
}
