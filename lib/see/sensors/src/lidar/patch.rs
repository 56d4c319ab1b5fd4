//! Which beams are fired at one moment, and which of them are followed together.

use std::ops::Range;

use settings::LidarSpec;

/// Columns and channels of the blocks in which rays are followed: 16 neighbours make a packet.
const BLOCK: [usize; 2] = [4, 4];
/// Beams of a patch, about.
const BEAMS: usize = 4096;

/// Columns that are fired at one moment.
#[derive(Clone, Debug)]
pub(super) struct Slice {
    /// The moment: 0 at the frame, 1 a period ago.
    pub(super) before: f32,
    /// Its channels from the highest on, as many patches as every other slice has.
    pub(super) patches: Vec<Patch>,
}

/// Some channels of a slice: what one task fires and receives. Which beams these are does not depend on
/// threads.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub(super) rows: Range<usize>,
    pub(super) columns: Range<usize>,
    /// Its beams, which are numbered row by row, in the order in which they are followed: neighbours
    /// together.
    pub(super) order: Vec<u32>,
}

impl Patch {
    fn new(rows: Range<usize>, columns: Range<usize>) -> Self {
        let (height, width) = (rows.len(), columns.len());
        let mut order = Vec::with_capacity(height * width);
        for row in (0..height).step_by(BLOCK[1]) {
            for column in (0..width).step_by(BLOCK[0]) {
                for r in row..(row + BLOCK[1]).min(height) {
                    order.extend((column..(column + BLOCK[0]).min(width)).map(|c| (r * width + c) as u32));
                }
            }
        }
        Self { rows, columns, order }
    }

    /// Numbers among all beams of the lidar of those of the patch in a row.
    pub(super) fn beams(&self, row: usize, spec: &LidarSpec) -> Range<usize> {
        let first = row * spec.scan.columns as usize;
        first + self.columns.start..first + self.columns.end
    }
}

/// The slices of a revolution; all of it at the frame's time unless it rolls.
pub(super) fn slices(spec: &LidarSpec) -> Vec<Slice> {
    let (rows, columns) = (spec.scan.channels as usize, spec.scan.columns as usize);
    let count = spec.rolling.as_ref().map_or(1, |rolling| (rolling.slices as usize).clamp(1, columns.max(1)));
    let blocks = (BEAMS / columns.div_ceil(count).max(1)).div_ceil(BLOCK[1]).max(1);
    let height = blocks * BLOCK[1];
    let slice = |k: usize| {
        let [first, end] = [k, k + 1].map(|k| k * columns / count);
        let middle = (first + end) as f64 / (2 * columns.max(1)) as f64;
        let before = if spec.rolling.is_some() { (1.0 - middle) as f32 } else { 0.0 };
        let bands = (0..rows).step_by(height).map(|row| row..(row + height).min(rows));
        Slice { before, patches: bands.map(|rows| Patch::new(rows, first..end)).collect() }
    };
    (0..count).map(slice).collect()
}
