//! Ground truth as pure functions: boxes, HD-map records, BEV masks, voxel grids, validity, tracks, counts.
//!
//! Every label is computed from the scene log and from the very triangles the sensors see
//! ([`schema::geometry::Snapshot`]). Nothing here reads or writes files, and no result depends on the number of
//! threads.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`boxes`] | actors and poses of a frame | raw 3-D boxes of every agent |
//! | [`hd_map`] | the map and a pose | the lane an agent is in |
//! | [`bev`] | a snapshot and a pose | a mask of 14 classes |
//! | [`voxels`] | a snapshot and a pose | a semantic voxel grid |
//! | [`fill`](mod@fill) | a voxel grid | the same with the insides of objects filled |
//! | [`validity`] | boxes, points, pixels | points per box, valid flag, difficulty |
//! | [`tracks`] | boxes of all agents | one object list per frame, tracks over the scene |
//! | [`counts`] | any of these | partial statistics that add up |

pub mod bev;
pub mod boxes;
pub mod counts;
pub mod fill;
pub mod hd_map;
mod mesh_cache;
pub mod tracks;
pub mod validity;
pub mod voxels;

#[cfg(test)]
#[path = "../benches/scene/mod.rs"]
mod scene;
