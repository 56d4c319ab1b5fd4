//! A grid of voxels, whole or listed.

use crate::config::GridConfig;
use crate::space::V3;

/// A grid of tags at one frame.
pub(crate) struct Grid<'a> {
    pub(crate) config: &'a GridConfig,
    pub(crate) sides: [usize; 3],
    pub(super) tags: &'a Tags,
}

/// The tags of a grid's cells, which are numbered in C order.
pub(crate) enum Tags {
    /// One a cell.
    Whole(Vec<u8>),
    /// The occupied cells and their tags, ascending.
    Listed(Vec<(u64, u8)>),
}

impl Tags {
    pub(crate) fn at(&self, cell: u64) -> u8 {
        match self {
            Self::Whole(tags) => tags[cell as usize],
            Self::Listed(cells) => {
                cells.binary_search_by_key(&cell, |listed| listed.0).map_or(0, |place| cells[place].1)
            }
        }
    }

    /// The occupied cells and their tags, ascending.
    pub(crate) fn occupied(&self) -> Box<dyn Iterator<Item = (u64, u8)> + '_> {
        match self {
            Self::Whole(tags) => Box::new((0..).zip(tags.iter().copied()).filter(|(_, tag)| *tag != 0)),
            Self::Listed(cells) => Box::new(cells.iter().copied()),
        }
    }
}

impl Grid<'_> {
    pub(super) fn tag(&self, i: usize, j: usize, k: usize) -> u8 {
        self.tags.at(number([i, j, k], self.sides))
    }

    /// The middle of a cell, in the grid's frame, m.
    pub(crate) fn middle(&self, cell: u64) -> V3 {
        let GridConfig { range_m, voxel_m, lower_m, .. } = *self.config;
        let [_, across, up] = self.sides.map(|side| side as u64);
        let place = [cell / up / across, cell / up % across, cell % up];
        let low = [-range_m, -range_m, lower_m];
        [0, 1, 2].map(|axis| low[axis] + (place[axis] as f64 + 0.5) * voxel_m)
    }
}

/// The number of a cell in C order.
pub(super) fn number([i, j, k]: [usize; 3], [_, across, up]: [usize; 3]) -> u64 {
    (i as u64 * across as u64 + j as u64) * up as u64 + k as u64
}
