//! Semantic voxel grids: which cells the world's triangles touch.
//!
//! The grid turns fully with its agent and its cells are cubes aligned with the grid (not with the world). A
//! cell holds the label of the surface of highest priority ([`Tag::voxel_priority`]) that has a point in it;
//! among equals the smaller label wins, so the order of triangles doesn't matter. Cells are half open: a
//! point on the face between two cells belongs to the upper one.
//!
//! Exactness: a triangle meets a column of cells in one connected piece, so the cells it touches there are
//! those from the piece's lowest to its highest point. Both lie on the border of the triangle's slice between
//! two planes of constant x; walking that border finds exactly the cells that separating axes would, at a
//! small part of the cost.
//!
//! [`CpuVoxelRenderer::cell_rows`] lists the same cells with their objects and velocities, slab by slab, so
//! that grids of any size fit; [`CpuVoxelRenderer::sweep`] gives the shells that sweeps along the axes meet
//! first.
//!
//! [`CpuVoxelRenderer`] does this behind the seam of [`render::VoxelRenderer`]; [`GridPlacement`] says where
//! the grid of an agent is.
//!
//! ```
//! use settings::OccupancySettings;
//! use labels::voxels::GridPlacement;
//!
//! let placement = GridPlacement::new(&OccupancySettings { voxel_m: 0.5, ..OccupancySettings::default() })?;
//! let here = frames::Pose::<frames::World, frames::Agent>::from_xyz_rpy([0.0; 3], [0.0; 3]);
//! let block = placement.block(&frames::LocalOrigin::near([0.0; 3]), &here, None);
//! // A metre ahead is two cells further.
//! let cells = |x: f32| block.cells_from_local.transform_point3(glam::Vec3::new(x, 0.0, 0.0));
//! assert!((cells(1.0).x - cells(0.0).x - 2.0).abs() < 1e-5);
//! # Ok::<(), labels::voxels::VoxelError>(())
//! ```

mod column;
mod cpu;
mod picture;
mod placement;
mod rows;
mod sweeps;

pub use cpu::CpuVoxelRenderer;
pub use picture::{oblique_view, top_view};
pub use placement::{GridPlacement, VoxelError, voxelize};
pub use rows::{CellRows, Wanted};

#[cfg(test)]
mod tests;
