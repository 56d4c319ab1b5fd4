//! Voxelising on the CPU: triangles are sorted into slabs of slices, slabs are written in parallel.

use std::sync::{Arc, Mutex};

use culling::MeshFacts;
use glam::{Affine3A, Vec3A};
use rayon::prelude::*;
use renderer::{RenderError, VoxelBlock, VoxelRenderer};
use schema::geometry::{Instance, Snapshot, TriMesh};

use crate::column::{GridTriangle, Span};

/// Slices along x that one task works on: their cells stay in a core's own cache.
const SLAB_SLICES: usize = 8;

/// Voxelises with the processor's cores, all those of the rayon pool it is called in.
#[derive(Debug, Default)]
pub struct CpuVoxelRenderer {
    /// By mesh.
    facts: Vec<MeshFacts>,
    /// Working memory that waits to be used again.
    free: Mutex<Vec<Work>>,
}

/// What one block needs while it is filled.
#[derive(Debug, Default)]
struct Work {
    triangles: Vec<GridTriangle>,
    bins: Bins,
}

impl VoxelRenderer for CpuVoxelRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        self.facts.extend(meshes.iter().map(|mesh| MeshFacts::of(mesh)));
        Ok(())
    }

    fn voxelize(
        &self,
        snapshot: &Snapshot,
        blocks: &[VoxelBlock],
        cells: &mut [Vec<u8>],
    ) -> Result<(), RenderError> {
        let (in_snapshot, prepared) = (snapshot.meshes.len(), self.facts.len());
        if in_snapshot > prepared {
            return Err(RenderError::Unprepared { in_snapshot, prepared });
        }
        let mut work = self.free.lock().ok().and_then(|mut free| free.pop()).unwrap_or_default();
        for (block, cells) in blocks.iter().zip(cells) {
            work.fill(snapshot, &self.facts, block, cells);
        }
        if let Ok(mut free) = self.free.lock() {
            free.push(work);
        }
        Ok(())
    }
}

impl Work {
    fn fill(&mut self, snapshot: &Snapshot, facts: &[MeshFacts], block: &VoxelBlock, cells: &mut Vec<u8>) {
        let [nx, ny, nz] = block.shape;
        // Only growth writes here; every slab clears its own cells below, while they are in its cache.
        cells.resize(nx * ny * nz, 0);
        if cells.is_empty() {
            return;
        }
        collect_triangles(snapshot, facts, block, &mut self.triangles);
        self.bins.sort(&self.triangles, nx);

        let (triangles, bins) = (&self.triangles, &self.bins);
        let slabs = cells.par_chunks_mut(SLAB_SLICES * ny * nz).enumerate();
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
}

/// All triangles that reach into the grid, in grid coordinates.
fn collect_triangles(
    snapshot: &Snapshot,
    facts: &[MeshFacts],
    block: &VoxelBlock,
    out: &mut Vec<GridTriangle>,
) {
    out.clear();
    let size = Vec3A::from(block.shape.map(|n| n as f32));
    let inside: Vec<(&Instance, Affine3A)> = snapshot
        .instances
        .iter()
        .filter(|instance| Some(instance.object) != block.without)
        .map(|instance| (instance, block.cells_from_local * instance.local_from_object))
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
