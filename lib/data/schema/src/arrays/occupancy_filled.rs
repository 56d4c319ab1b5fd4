//! Voxel grids with the insides of objects filled.

use super::kind::ArrayKind;

/// Voxel grids with the insides of objects filled: `[x, y, z]`, semantic tags.
pub const FILLED_VOXEL_GRIDS: ArrayKind =
    ArrayKind { folder: "occupancy_filled", stage: "postprocess-valid" };
