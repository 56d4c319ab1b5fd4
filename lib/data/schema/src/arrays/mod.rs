//! Archives of arrays that stages write for each agent, one array a frame. Each is a file of its own: a new
//! kind makes no stage stale.

mod bev;
mod kind;
mod occupancy;
mod occupancy_filled;
mod occupancy_observed;

pub use bev::{BEV_HEIGHTS, BEV_IDS, BEV_MASKS, BEV_PAINT};
pub use kind::ArrayKind;
pub use occupancy::{VOXEL_CELLS, VOXEL_FLOW, VOXEL_GRIDS, VOXEL_IDS};
pub use occupancy_filled::FILLED_VOXEL_GRIDS;
pub use occupancy_observed::OBSERVED_VOXELS;
