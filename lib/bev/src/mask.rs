//! The result, and its picture.

use counts::PartialCounts;
use schema::BevClass;
use schema::measures::bev as measures;
use schema::settings::BevSettings;

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

    /// Counts the mask as one of an agent: [`measures::BEV_GRIDS`] of the rule and the true cells of every class that is
    /// written.
    pub fn add_to(&self, counts: &mut PartialCounts, agent: &str, settings: &BevSettings) {
        counts.add(agent, measures::BEV_GRIDS, settings.rule.name(), 0, 1);
        let cells = self.counts();
        for class in &settings.classes {
            counts.add(agent, measures::BEV_CELLS, class.name(), 0, cells[*class as usize]);
        }
    }
}

/// A picture of a mask, three bytes (sRGB) a cell: white, then the channels painted in order, later ones on top.
#[must_use]
pub fn to_rgb(mask: &BevMask) -> Vec<u8> {
    // The last channel that is set is the one on top.
    let colour = |bits: u16| match bits.checked_ilog2() {
        Some(top) => BevClass::ALL[top as usize].rgb(),
        None => [255; 3],
    };
    mask.bits().iter().flat_map(|&bits| colour(bits)).collect()
}
