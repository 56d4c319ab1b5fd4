//! Filling the hollow insides of objects in a voxel grid, class by class, exactly.
//!
//! Surfaces leave closed objects hollow. Three rules fill them ([`FillingRule`]).
//!
//! `chunk`: for each class in [`ORDER`], a free cell becomes that class when the first occupied cell in all
//! six axis directions is of the class, and the class occurs in the cell's chunk. Each pass reads the grid as
//! the last one left it, so the order of the classes is part of the result.
//!
//! `paper`: a free cell takes the label, whatever it is, that the first occupied cell in all six axis
//! directions has. All cells read the grid as it was.
//!
//! `solid`: free cells that no way over faces leads out of, to the grid's border, take the label that most
//! cell faces around them have (of equally many the smaller), if that is a class of [`ORDER`].
//!
//! For the first two a column of cells along z is a bit mask here. "The first occupied cell below (above) is
//! of the class" is one addition whose carries run through free cells. In the four horizontal directions only
//! candidates are followed: a walk away from each run of them, until all that is asked is decided, and a mask
//! that is carried from column to column through the run.

mod bits;
mod lines;
mod met;
mod order;
mod read;
mod solid;
mod sweep;

use schema::Tag;
use settings::{FillingRule, OccupancySettings};

use crate::voxel_grid::VoxelGrid;
pub use order::ORDER;

use crate::fill::read::Entry;

/// A grid that can't be filled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FillError {
    /// More layers than column masks have bits.
    #[error("a grid of {layers} layers can't be filled, {} is the limit", OccupancySettings::MAX_LAYERS)]
    Layers {
        /// Cells along z.
        layers: usize,
    },
    /// The data doesn't fit the shape.
    #[error("a grid of shape {shape:?} can't have {cells} cells")]
    Shape {
        /// Cells along x, y, z.
        shape: [usize; 3],
        /// Cells there are.
        cells: usize,
    },
}

/// The chunk of a class at some cell size: scaled by `max(1, 0.1 / size)`, at most the grid, truncated.
#[must_use]
pub fn chunk_cells(at_tenth_metre: [usize; 3], voxel_m: f64, shape: [usize; 3]) -> [usize; 3] {
    let scale = (0.1 / voxel_m).max(1.0);
    std::array::from_fn(|axis| {
        let scaled = at_tenth_metre[axis] as f64 * scale;
        (scaled.min(shape[axis] as f64) as usize).max(1)
    })
}

/// Fills grids; keeps its working memory (about 0.4 times the grid) between frames.
#[derive(Debug, Default)]
pub struct Filler {
    narrow: sweep::Columns<1>,
    usual: sweep::Columns<2>,
    wide: sweep::Columns<4>,
    widest: sweep::Columns<8>,
    rooms: solid::Rooms,
}

impl Filler {
    /// Fills the grid in place. `voxel_m` is the size of its cells.
    ///
    /// # Errors
    /// The grid has more than 512 layers, or data of another size than its shape.
    pub fn fill(&mut self, grid: &mut VoxelGrid, voxel_m: f64, rule: FillingRule) -> Result<(), FillError> {
        let layers = grid.shape[2];
        if grid.shape.iter().product::<usize>() != grid.data.len() {
            return Err(FillError::Shape { shape: grid.shape, cells: grid.data.len() });
        }
        if grid.data.is_empty() {
            return Ok(());
        }
        match layers {
            _ if layers > OccupancySettings::MAX_LAYERS => return Err(FillError::Layers { layers }),
            _ if rule == FillingRule::Solid => self.rooms.fill(grid),
            0..=64 => run(&mut self.narrow, grid, voxel_m, rule),
            65..=128 => run(&mut self.usual, grid, voxel_m, rule),
            129..=256 => run(&mut self.wide, grid, voxel_m, rule),
            _ => run(&mut self.widest, grid, voxel_m, rule),
        }
        Ok(())
    }
}

/// Fills a grid in place. For many frames a [`Filler`] is faster.
///
/// # Errors
/// As [`Filler::fill`].
pub fn fill(grid: &mut VoxelGrid, voxel_m: f64, rule: FillingRule) -> Result<(), FillError> {
    Filler::default().fill(grid, voxel_m, rule)
}

fn run<const W: usize>(
    columns: &mut sweep::Columns<W>,
    grid: &mut VoxelGrid,
    voxel_m: f64,
    rule: FillingRule,
) {
    let (classes, passes): (_, Vec<(Tag, [usize; 3])>) = if rule == FillingRule::Paper {
        let every = Tag::ALL.into_iter().filter(|tag| *tag != Tag::Unlabeled);
        (&order::EVERY, every.map(|tag| (tag, grid.shape)).collect())
    } else {
        let chunk = |(tag, chunk)| (tag, chunk_cells(chunk, voxel_m, grid.shape));
        (&order::ORDERED, ORDER.into_iter().map(chunk).collect())
    };
    let read = columns.read(grid, classes);
    for (class, (tag, chunk)) in passes.into_iter().enumerate() {
        let parts: Vec<&[Entry<W>]> = read.iter().map(|part| &*part.columns[class]).collect();
        if parts.iter().any(|columns| !columns.is_empty()) {
            columns.fill_class(&parts, tag, chunk, rule != FillingRule::Paper, grid);
        }
    }
}

#[cfg(test)]
mod tests;
