//! What lidars saw of a voxel grid.

use super::kind::ArrayKind;

/// What lidars saw of each voxel: `[x, y, z]`, 0 unobserved, 1 free, 2 occupied.
pub const OBSERVED_VOXELS: ArrayKind = ArrayKind { folder: "occupancy_observed", stage: "postprocess-valid" };
