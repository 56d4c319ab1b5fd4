//! Voxel grids as seen.

use super::kind::ArrayKind;

/// Voxel grids as seen: `[x, y, z]`, semantic tags.
pub const VOXEL_GRIDS: ArrayKind = ArrayKind { folder: "occupancy", stage: "occupancy-gt" };
