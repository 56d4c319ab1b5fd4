//! Where the grid of an agent is.

use crate::voxel_grid::VoxelGrid;
use frames::{Agent, LocalOrigin, Pose, World};
use glam::{Affine3A, Mat3A, Vec3A};
use render::{RenderError, VoxelBlock, VoxelRenderer};
use schema::ObjectId;
use schema::geometry::Snapshot;
use settings::OccupancySettings;

use crate::voxels::cpu::CpuVoxelRenderer;

/// A grid that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum VoxelError {
    /// The settings give no sensible grid ([`OccupancySettings::problem`]).
    #[error("occupancy grid: {problem}")]
    Shape {
        /// What is wrong.
        problem: String,
    },
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Grids of some settings around agents.
#[derive(Clone, Debug)]
pub struct GridPlacement {
    settings: OccupancySettings,
    shape: [usize; 3],
}

impl GridPlacement {
    /// For grids of these settings.
    ///
    /// # Errors
    /// The settings give an empty or immense grid.
    pub fn new(settings: &OccupancySettings) -> Result<Self, VoxelError> {
        if let Some(problem) = settings.problem() {
            return Err(VoxelError::Shape { problem });
        }
        Ok(Self { settings: settings.clone(), shape: settings.shape() })
    }

    /// The block of an agent's grid in a snapshot with this origin. The object `without` is left out.
    #[must_use]
    pub fn block(
        &self,
        origin: &LocalOrigin,
        world_from_agent: &Pose<World, Agent>,
        without: Option<ObjectId>,
    ) -> VoxelBlock {
        let cells_from_local = self.cells_from_local(origin, world_from_agent);
        VoxelBlock { cells_from_local, shape: self.shape, without }
    }

    /// Cells along x, y, z.
    #[must_use]
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Writes the grid around an agent into `grid`, whose memory is used again. The object `without` is left
    /// out.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn voxelize(
        &self,
        renderer: &dyn VoxelRenderer,
        snapshot: &Snapshot,
        world_from_agent: &Pose<World, Agent>,
        without: Option<ObjectId>,
        grid: &mut VoxelGrid,
    ) -> Result<(), RenderError> {
        let block = self.block(&snapshot.origin, world_from_agent, without);
        grid.shape = self.shape;
        renderer.voxelize(snapshot, &[block], std::slice::from_mut(&mut grid.data))
    }

    /// Takes points of the snapshot's local frame to grid coordinates, in cells.
    fn cells_from_local(&self, origin: &LocalOrigin, world_from_agent: &Pose<World, Agent>) -> Affine3A {
        let grid_origin = Pose::<Agent, Agent>::from_xyz_rpy([0.0, 0.0, self.settings.mount_z_m], [0.0; 3]);
        let local_from_grid = origin.local_from_body(&(*world_from_agent * grid_origin));
        let per_m = (1.0 / self.settings.voxel_m) as f32;
        let range_m = 0.5 * self.shape[0] as f64 * self.settings.voxel_m;
        let corner_m = Vec3A::new(-range_m as f32, -range_m as f32, self.settings.lower_m as f32);
        let cells_from_grid = Affine3A {
            matrix3: Mat3A::from_diagonal(glam::Vec3::splat(per_m)),
            translation: -corner_m * per_m,
        };
        cells_from_grid * local_from_grid.inverse()
    }
}

/// The grid around an agent, by the CPU and in new memory.
///
/// # Errors
/// The settings give an empty or immense grid.
pub fn voxelize(
    snapshot: &Snapshot,
    world_from_agent: &Pose<World, Agent>,
    settings: &OccupancySettings,
    without: Option<ObjectId>,
) -> Result<VoxelGrid, VoxelError> {
    let placement = GridPlacement::new(settings)?;
    let mut renderer = CpuVoxelRenderer::default();
    renderer.prepare(&snapshot.meshes)?;
    let mut grid = VoxelGrid::default();
    placement.voxelize(&renderer, snapshot, world_from_agent, without, &mut grid)?;
    Ok(grid)
}
