//! Semantic voxel grids as plain values: what voxelising makes and filling changes.

use rayon::prelude::*;
use schema::Tag;
use schema::measures::counts::PartialCounts;
use schema::measures::voxels as measures;

/// Which voxel grids are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// As voxelised.
    Hollow,
    /// After filling.
    Filled,
}

/// A semantic voxel grid.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VoxelGrid {
    /// Cells along x (forward), y (left), z (up).
    pub shape: [usize; 3],
    /// Label of each cell, 0 is free; z runs fastest, then y; index 0 is the most negative side of every
    /// axis.
    pub data: Vec<u8>,
}

impl VoxelGrid {
    /// A free grid.
    #[must_use]
    pub fn free(shape: [usize; 3]) -> Self {
        Self { shape, data: vec![0; shape.iter().product()] }
    }

    /// Where cell `(i, j, k)` is in `data`.
    #[must_use]
    pub fn index(&self, i: usize, j: usize, k: usize) -> usize {
        (i * self.shape[1] + j) * self.shape[2] + k
    }

    /// Cells per label.
    #[must_use]
    pub fn count(&self) -> [u64; Tag::COUNT] {
        // Chunks add up in any order: integer sums.
        self.data.par_chunks(1 << 20).map(count_chunk).reduce(
            || [0; Tag::COUNT],
            |mut a, b| {
                for (to, from) in a.iter_mut().zip(b) {
                    *to += from;
                }
                a
            },
        )
    }

    /// Counts the grid as one of an agent: cells per label (free space too), for labels that occur. A hollow
    /// grid also counts as one of [`measures::VOXEL_GRIDS`].
    pub fn add_to(&self, counts: &mut PartialCounts, agent: &str, filling: Filling) {
        add_cells(self.count(), counts, agent, filling);
    }
}

/// Counts a grid of so many cells per label, as [`VoxelGrid::add_to`] does.
pub fn add_cells(cells: [u64; Tag::COUNT], counts: &mut PartialCounts, agent: &str, filling: Filling) {
    let measure = match filling {
        Filling::Hollow => {
            counts.add(agent, measures::VOXEL_GRIDS, "", 0, 1);
            measures::VOXEL_CELLS
        }
        Filling::Filled => measures::VOXEL_CELLS_FILLED,
    };
    for (tag, cells) in Tag::ALL.into_iter().zip(cells) {
        if cells > 0 {
            counts.add(agent, measure, tag.name(), 0, cells);
        }
    }
}

fn count_chunk(cells: &[u8]) -> [u64; Tag::COUNT] {
    let mut counts = [0_u64; 256];
    // Nearly all cells are free: look at sixteen at a time.
    let (groups, rest) = cells.as_chunks::<16>();
    for group in groups {
        if u128::from_ne_bytes(*group) == 0 {
            counts[0] += 16;
        } else {
            for &cell in group {
                counts[usize::from(cell)] += 1;
            }
        }
    }
    for &cell in rest {
        counts[usize::from(cell)] += 1;
    }
    std::array::from_fn(|tag| counts[tag])
}

#[cfg(test)]
mod tests {
    use schema::tables::PartialRow;

    use super::*;

    fn count(rows: &[PartialRow], measure: &str, class: &str, bin: i32) -> u64 {
        rows.iter()
            .filter(|r| r.measure == measure && r.class == class && r.bin == bin)
            .map(|r| r.count)
            .sum()
    }

    #[test]
    fn grids_add_up() {
        let mut grid = VoxelGrid::free([2, 2, 20]);
        grid.data[5] = Tag::Car as u8;
        grid.data[79] = Tag::Road as u8;
        let mut counts = PartialCounts::new();
        grid.add_to(&mut counts, "vehicle_0", Filling::Hollow);
        let mut again = PartialCounts::new();
        grid.add_to(&mut again, "vehicle_0", Filling::Hollow);
        counts.merge(again);
        let got = counts.rows();
        assert_eq!(count(&got, measures::VOXEL_CELLS, "car", 0), 2);
        assert_eq!(count(&got, measures::VOXEL_CELLS, "unlabeled", 0), 156);
        assert_eq!(count(&got, measures::VOXEL_GRIDS, "", 0), 2);
        assert!(!got.iter().any(|r| r.class == "bus"));
    }
}
