//! Voxel grids as seen.

use super::kind::ArrayKind;

/// Voxel grids as seen: `[x, y, z]`, semantic tags.
pub const VOXEL_GRIDS: ArrayKind = ArrayKind { folder: "occupancy", stage: "occupancy-gt" };
/// Occupied cells of a grid in C order instead of the grid: `[n, 4]`, u16, place along x, y, z and semantic
/// tag.
pub const VOXEL_CELLS: ArrayKind = ArrayKind { folder: "occupancy_cells", stage: "occupancy-gt" };
/// Object of each occupied cell, in C order: `[n]`, u16.
pub const VOXEL_IDS: ArrayKind = ArrayKind { folder: "occupancy_ids", stage: "occupancy-gt" };
/// Velocity of each occupied cell over the ground, in C order: `[n, 3]`, f32, along the grid's axes, m/s.
pub const VOXEL_FLOW: ArrayKind = ArrayKind { folder: "occupancy_flow", stage: "occupancy-gt" };
