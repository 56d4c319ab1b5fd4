//! The result, and its picture.

use schema::BevClass;
use schema::measures::bev as measures;
use schema::measures::counts::PartialCounts;
use settings::BevSettings;

/// A mask of 14 classes over a square grid; a cell may carry several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BevMask {
    cells: usize,
    /// One bit per class, row by row.
    bits: Vec<u16>,
}

impl BevMask {
    pub(crate) fn new(cells: usize, bits: Vec<u16>) -> Self {
        Self { cells, bits }
    }

    /// Rows and columns.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The classes of each cell as bits (bit `n` is channel `n`), row by row; row 0 is ahead, column 0 left.
    #[must_use]
    pub fn bits(&self) -> &[u16] {
        &self.bits
    }

    /// Whether a cell carries a class; no cell outside the grid does.
    #[must_use]
    pub fn get(&self, class: BevClass, row: usize, column: usize) -> bool {
        column < self.cells
            && self.bits.get(row * self.cells + column).is_some_and(|bits| bits >> class as u16 & 1 == 1)
    }

    /// Some classes of the mask as an array of bool bytes of shape `[classes, cells, cells]`, C order.
    #[must_use]
    pub fn to_bytes(&self, classes: &[BevClass]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(classes.len() * self.bits.len());
        for &class in classes {
            bytes.extend(self.bits.iter().map(|bits| (bits >> class as u16 & 1) as u8));
        }
        bytes
    }

    /// True cells of each class.
    #[must_use]
    pub fn counts(&self) -> [u64; BevClass::COUNT] {
        std::array::from_fn(|channel| self.bits.iter().map(|bits| u64::from(bits >> channel & 1)).sum())
    }

    /// True cells of each class in each block of the mask ([`measures::bin_of_block`]), class by class.
    fn blocks(&self) -> Vec<u32> {
        let side = measures::heat_blocks(self.cells);
        let of: Vec<usize> = (0..self.cells).map(|cell| measures::heat_block(cell, self.cells)).collect();
        let mut blocks = vec![0_u32; BevClass::COUNT * side * side];
        for (row, bits) in self.bits.chunks_exact(self.cells.max(1)).enumerate() {
            for (column, &bits) in bits.iter().enumerate().filter(|(_, bits)| **bits != 0) {
                let block = measures::bin_of_block(of[row], of[column], self.cells);
                let mut rest = bits;
                while rest != 0 {
                    blocks[rest.trailing_zeros() as usize * side * side + block] += 1;
                    rest &= rest - 1;
                }
            }
        }
        blocks
    }

    /// Counts the mask as one of an agent: [`measures::BEV_GRIDS`] of the rule and the true cells of every
    /// class that is written, altogether and by place.
    pub fn add_to(&self, counts: &mut PartialCounts, agent: &str, settings: &BevSettings) {
        counts.add(agent, measures::BEV_GRIDS, settings.rule.name(), 0, 1);
        let blocks = self.blocks();
        let size = blocks.len() / BevClass::COUNT;
        for class in &settings.classes {
            let blocks = &blocks[size * *class as usize..][..size];
            let cells = blocks.iter().map(|&n| u64::from(n)).sum();
            counts.add(agent, measures::BEV_CELLS, class.name(), 0, cells);
            if cells > 0 {
                counts.add_bins(agent, measures::BEV_HEAT, class.name(), blocks);
            }
        }
    }
}

/// A picture of a mask, three bytes (sRGB) a cell: white, then the channels painted in order, later ones on
/// top.
#[must_use]
pub fn to_rgb(mask: &BevMask) -> Vec<u8> {
    // The last channel that is set is the one on top.
    let colour = |bits: u16| match bits.checked_ilog2() {
        Some(top) => BevClass::ALL[top as usize].rgb(),
        None => [255; 3],
    };
    mask.bits().iter().flat_map(|&bits| colour(bits)).collect()
}
