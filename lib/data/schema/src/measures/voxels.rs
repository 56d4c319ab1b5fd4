//! What `occupancy-gt` and `postprocess-valid` count.

/// Cells of voxel grids before filling. Class: tag name; `unlabeled` is free space.
pub const VOXEL_CELLS: &str = "voxel_cells";
/// Cells of voxel grids after filling. Class: tag name; `unlabeled` is free space.
pub const VOXEL_CELLS_FILLED: &str = "voxel_cells_filled";
/// Voxel grids (before filling; there are as many after it).
pub const VOXEL_GRIDS: &str = "voxel_grids";
