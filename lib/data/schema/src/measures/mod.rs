//! Names of the counts in [`PartialRow::measure`](crate::tables::PartialRow), and the bins of the histograms.
//!
//! A stage writes rows of its measures while it has the data in hand; the statistics stage adds up the rows
//! of one (measure, class, bin). Unless said otherwise `class` is empty and `bin` is 0. Each stage's measures
//! are a module of their own. [`counts`] adds them up.

pub mod bev;
mod bins;
pub mod counts;
pub mod sensors;
pub mod sightings;
pub mod simulation;
pub mod tracks;
pub mod voxels;

pub use bins::Bins;
