//! Semantic voxel grids: which cells the world's triangles touch.
//!
//! The grid turns fully with its agent and its cells are cubes aligned with the grid (not with the world). A cell
//! holds the label of the surface of highest priority ([`Tag::voxel_priority`]) that has a point in it; among
//! equals the smaller label wins, so the order of triangles doesn't matter. Cells are half open: a point on the
//! face between two cells belongs to the upper one.
//!
//! Exactness: a triangle meets a column of cells in one connected piece, so the cells it touches there are those
//! from the piece's lowest to its highest point. Both lie on the border of the triangle's slice between two
//! planes of constant x; walking that border finds exactly the cells that separating axes would, at a small part
//! of the cost.

mod column;
mod picture;

use frames::{Agent, Pose, World};
use glam::{Affine3A, Mat3A, Vec3A};
use rayon::prelude::*;
use schema::ObjectId;
use schema::geometry::{Instance, Snapshot, TriMesh};
use schema::settings::OccupancySettings;

use column::{GridTriangle, Span};
use culling::{MeshCache, MeshFacts};
use voxelgrid::VoxelGrid;

/// Slices along x that one task works on: their cells stay in a core's own cache.
const SLAB_SLICES: usize = 8;

/// A grid that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VoxelError {
    /// The settings give no sensible grid ([`OccupancySettings::problem`]).
    #[error("occupancy grid: {problem}")]
    Shape {
        /// What is wrong.
        problem: String,
    },
}

/// Makes voxel grids; keeps its working memory between frames.
#[derive(Debug)]
pub struct Voxelizer {
    settings: OccupancySettings,
    shape: [usize; 3],
    meshes: MeshCache,
    triangles: Vec<GridTriangle>,
    bins: Bins,
}

impl Voxelizer {
    /// For grids of these settings.
    ///
    /// # Errors
    /// The settings give an empty or immense grid.
    pub fn new(settings: &OccupancySettings) -> Result<Self, VoxelError> {
        if let Some(problem) = settings.problem() {
            return Err(VoxelError::Shape { problem });
        }
        Ok(Self {
            settings: settings.clone(),
            shape: settings.shape(),
            meshes: MeshCache::default(),
            triangles: Vec::new(),
            bins: Bins::default(),
        })
    }

    /// Writes the grid around an agent into `grid` (whose memory is reused). The object `self_id` is left out.
    pub fn voxelize(
        &mut self,
        snapshot: &Snapshot,
        world_from_agent: &Pose<World, Agent>,
        self_id: Option<ObjectId>,
        grid: &mut VoxelGrid,
    ) {
        let [nx, ny, nz] = self.shape;
        grid.shape = self.shape;
        // Only growth writes here; every slab clears its own cells below, while they are in its cache.
        grid.data.resize(nx * ny * nz, 0);

        let cells_from_local = self.cells_from_local(snapshot, world_from_agent);
        let facts = self.meshes.facts(&snapshot.meshes);
        collect_triangles(snapshot, facts, self.shape, &cells_from_local, self_id, &mut self.triangles);
        self.bins.sort(&self.triangles, nx);

        let (triangles, bins) = (&self.triangles, &self.bins);
        let slabs = grid.data.par_chunks_mut(SLAB_SLICES * ny * nz).enumerate();
        slabs.for_each_init(
            || vec![Span::EMPTY; ny],
            |heights, (slab, cells)| {
                cells.fill(0);
                let slices = slab * SLAB_SLICES..((slab + 1) * SLAB_SLICES).min(nx);
                for &triangle in bins.of(slab) {
                    triangles[triangle as usize].write(slices.clone(), nz, cells, heights);
                }
            },
        );
    }

    /// Takes points of the snapshot's local frame to grid coordinates, in cells.
    fn cells_from_local(&self, snapshot: &Snapshot, world_from_agent: &Pose<World, Agent>) -> Affine3A {
        let grid_origin = Pose::<Agent, Agent>::from_xyz_rpy([0.0, 0.0, self.settings.mount_z_m], [0.0; 3]);
        let local_from_grid = snapshot.origin.local_from_body(&(*world_from_agent * grid_origin));
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

/// The grid around an agent, in new memory. For many frames a [`Voxelizer`] is faster.
///
/// # Errors
/// The settings give an empty or immense grid.
pub fn voxelize(
    snapshot: &Snapshot,
    world_from_agent: &Pose<World, Agent>,
    settings: &OccupancySettings,
    self_id: Option<ObjectId>,
) -> Result<VoxelGrid, VoxelError> {
    let mut grid = VoxelGrid::default();
    Voxelizer::new(settings)?.voxelize(snapshot, world_from_agent, self_id, &mut grid);
    Ok(grid)
}

/// All triangles that reach into the grid, in grid coordinates.
fn collect_triangles(
    snapshot: &Snapshot,
    facts: &[MeshFacts],
    shape: [usize; 3],
    cells_from_local: &Affine3A,
    self_id: Option<ObjectId>,
    out: &mut Vec<GridTriangle>,
) {
    out.clear();
    let size = Vec3A::new(shape[0] as f32, shape[1] as f32, shape[2] as f32);
    let inside: Vec<(&Instance, Affine3A)> = snapshot
        .instances
        .iter()
        .filter(|instance| Some(instance.object) != self_id)
        .map(|instance| (instance, *cells_from_local * instance.local_from_object))
        .filter(|(instance, to_cells)| {
            let bounds = facts[instance.mesh as usize].bounds(to_cells);
            Vec3A::from(bounds.min).cmplt(size).all() && Vec3A::from(bounds.max).cmpge(Vec3A::ZERO).all()
        })
        .collect();
    // Collected in the order of instances, whoever did which part.
    out.par_extend(inside.par_iter().flat_map_iter(|(instance, to_cells)| {
        let mesh = snapshot.mesh(instance);
        let corners: Vec<Vec3A> =
            mesh.positions.iter().map(|&p| to_cells.transform_point3a(Vec3A::from(p))).collect();
        triangles_of(mesh, corners, size)
    }));
}

fn triangles_of(mesh: &TriMesh, corners: Vec<Vec3A>, size: Vec3A) -> impl Iterator<Item = GridTriangle> + '_ {
    mesh.triangles.iter().enumerate().filter_map(move |(index, vertices)| {
        let tag = mesh.part(index).tag;
        let triangle = GridTriangle::new(vertices.map(|v| corners[v as usize]), tag)?;
        triangle.reaches(size).then_some(triangle)
    })
}

/// Which triangles touch which slab of slices.
#[derive(Debug, Default)]
struct Bins {
    /// Where each slab's list starts in `triangles`, and at last where the last one ends.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Bins {
    /// A counting sort: no comparison, two runs over the triangles.
    fn sort(&mut self, triangles: &[GridTriangle], slices: usize) {
        let slabs = slices.div_ceil(SLAB_SLICES);
        let slabs_of = |t: &GridTriangle| {
            let touched = t.slices(slices);
            touched.start / SLAB_SLICES..touched.end.div_ceil(SLAB_SLICES)
        };
        self.starts.clear();
        self.starts.resize(slabs + 1, 0);
        for triangle in triangles {
            for slab in slabs_of(triangle) {
                self.starts[slab + 1] += 1;
            }
        }
        for slab in 0..slabs {
            self.starts[slab + 1] += self.starts[slab];
        }
        self.triangles.clear();
        self.triangles.resize(self.starts[slabs] as usize, 0);
        let mut next = self.starts.clone();
        for (index, triangle) in triangles.iter().enumerate() {
            for slab in slabs_of(triangle) {
                self.triangles[next[slab] as usize] = index as u32;
                next[slab] += 1;
            }
        }
    }

    fn of(&self, slab: usize) -> &[u32] {
        &self.triangles[self.starts[slab] as usize..self.starts[slab + 1] as usize]
    }
}

pub use picture::{oblique_view, top_view};

#[cfg(test)]
#[path = "../../../tests/scenes/small_town.rs"]
mod scene;
#[cfg(test)]
mod tests;
