//! The seam for voxel grids.

use std::sync::Arc;

use glam::Affine3A;
use schema::ObjectId;
use schema::geometry::{Snapshot, TriMesh};

use crate::error::RenderError;

/// A block of cubic cells somewhere in a snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelBlock {
    /// The snapshot's local frame to the block's, in which cells are unit cubes and cell (0, 0, 0) starts at
    /// the origin.
    pub cells_from_local: Affine3A,
    /// Cells along x, y and z.
    pub shape: [usize; 3],
    /// An object that is left out.
    pub without: Option<ObjectId>,
}

/// Owns the meshes of a world and tells which cells they touch.
///
/// Apart from [`Renderer`](crate::Renderer), so that voxelising needs no rasteriser and the other way
/// round. A back end that does both implements both over the same meshes. All give the same cells, bit for
/// bit.
pub trait VoxelRenderer: Send + Sync {
    /// Prepares more meshes, as [`Renderer::prepare`](crate::Renderer::prepare).
    ///
    /// # Errors
    /// The device behind the renderer failed.
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError>;

    /// Fills blocks with the tags ([`schema::Tag`]) of what touches each cell, 0 where nothing does; z runs
    /// fastest, then y. Of several the greatest [`schema::Tag::voxel_priority`] wins, among equals the
    /// smaller tag. Cells are half open: a point on the face between two belongs to the upper one.
    ///
    /// `cells` has a list for each block, whose memory (131 MB of a usual grid) is used again.
    ///
    /// # Errors
    /// The snapshot lists more meshes than were prepared, or the device failed.
    fn voxelize(
        &self,
        snapshot: &Snapshot,
        blocks: &[VoxelBlock],
        cells: &mut [Vec<u8>],
    ) -> Result<(), RenderError>;
}
