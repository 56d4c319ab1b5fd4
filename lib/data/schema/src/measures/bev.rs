//! What `bev-gt` counts.

/// True cells of BEV masks. Class: BEV class.
pub const BEV_CELLS: &str = "bev_cells";
/// BEV masks (one has all channels). Class: the rule by which they were drawn.
pub const BEV_GRIDS: &str = "bev_grids";
/// True cells by place. Class: BEV class; bin: [`bin_of_block`].
pub const BEV_HEAT: &str = "bev_heat";

/// Blocks of cells along each side of a heat map; fewer where masks have fewer cells.
const HEAT_BLOCKS: usize = 50;

/// Blocks along each side of a heat map of masks with so many cells along theirs.
#[must_use]
pub const fn heat_blocks(cells: usize) -> usize {
    if cells < HEAT_BLOCKS { cells } else { HEAT_BLOCKS }
}

/// The block that a row (or column) of cells belongs to: blocks differ by a cell at most.
#[must_use]
pub const fn heat_block(cell: usize, cells: usize) -> usize {
    cell * heat_blocks(cells) / cells
}

/// The bin of a block: row by row from the far left, as masks are.
#[must_use]
pub const fn bin_of_block(row: usize, column: usize, cells: usize) -> usize {
    row * heat_blocks(cells) + column
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_as_even_as_cells_allow() {
        for (cells, sizes) in [(400, [8, 8]), (50, [1, 1]), (7, [1, 1]), (120, [2, 3]), (51, [1, 2])] {
            let mut counts = vec![0; heat_blocks(cells)];
            (0..cells).for_each(|cell| counts[heat_block(cell, cells)] += 1);
            assert_eq!(
                [*counts.iter().min().unwrap_or(&0), *counts.iter().max().unwrap_or(&0)],
                sizes,
                "{cells}"
            );
        }
        assert_eq!((heat_block(399, 400), bin_of_block(1, 2, 400)), (49, 52));
    }
}
