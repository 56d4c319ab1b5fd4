//! What archives of arrays say of themselves.

use serde::Deserialize;

/// The grid of BEV masks.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct BevGrid {
    pub(crate) classes: Vec<String>,
    /// Side of a cell; not every import knows it.
    #[serde(default)]
    pub(crate) cell_m: Option<f64>,
    pub(crate) every_n_frames: u32,
}

/// The grid of voxels.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct OccupancyGrid {
    pub(crate) range_m: f64,
    pub(crate) voxel_m: f64,
    pub(crate) lower_m: f64,
    pub(crate) upper_m: f64,
    pub(crate) mount_z_m: f64,
    pub(crate) every_n_frames: u32,
}
