//! Voxelising on the CPU: triangles are sorted into slabs of slices, slabs are written in parallel.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use crate::culling::MeshFacts;
use glam::{Affine3A, Vec3A};
use rayon::prelude::*;
use render::{RenderError, VoxelBlock, VoxelRenderer};
use schema::geometry::{Instance, Snapshot, TriMesh};

use crate::voxels::column::{GridTriangle, Span};

/// Slices along x that one task works on: their cells stay in a core's own cache.
pub(crate) const SLAB_SLICES: usize = 8;

/// Voxelises with the processor's cores, all those of the rayon pool it is called in.
#[derive(Debug, Default)]
pub struct CpuVoxelRenderer {
    /// By mesh.
    pub(crate) facts: Vec<MeshFacts>,
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
        self.check(snapshot)?;
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

impl CpuVoxelRenderer {
    /// Whether all meshes of a snapshot were prepared.
    pub(crate) fn check(&self, snapshot: &Snapshot) -> Result<(), RenderError> {
        let (in_snapshot, prepared) = (snapshot.meshes.len(), self.facts.len());
        if in_snapshot > prepared { Err(RenderError::Unprepared { in_snapshot, prepared }) } else { Ok(()) }
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
        self.bins.sort(&self.triangles, nx, |triangle| triangle.slices(nx));

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
    collect(snapshot, facts, block, 0.0, out, |_, triangle| triangle);
}

/// Something of all triangles that come nearer to the grid than `margin` cells: of the instance's number and
/// the triangle in grid coordinates.
pub(crate) fn collect<T: Send>(
    snapshot: &Snapshot,
    facts: &[MeshFacts],
    block: &VoxelBlock,
    margin: f32,
    out: &mut Vec<T>,
    of: impl Fn(u32, GridTriangle) -> T + Sync,
) {
    out.clear();
    let size = Vec3A::from(block.shape.map(|n| n as f32));
    let inside: Vec<(u32, &Instance, Affine3A)> = (0..)
        .zip(&snapshot.instances)
        .filter(|(_, instance)| Some(instance.object) != block.without)
        .map(|(number, instance)| (number, instance, block.cells_from_local * instance.local_from_object))
        .filter(|(_, instance, to_cells)| {
            let bounds = facts[instance.mesh as usize].bounds(to_cells);
            let (low, high) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
            low.cmplt(size + margin).all() && high.cmpge(Vec3A::splat(-margin)).all()
        })
        .collect();
    let of = &of;
    // Collected in the order of instances, whichever thread computed them.
    out.par_extend(inside.par_iter().flat_map_iter(|(number, instance, to_cells)| {
        let mesh = snapshot.mesh(instance);
        let corners: Vec<Vec3A> =
            mesh.positions.iter().map(|&p| to_cells.transform_point3a(Vec3A::from(p))).collect();
        triangles_of(mesh, corners, size, margin).map(move |triangle| of(*number, triangle))
    }));
}

fn triangles_of(
    mesh: &TriMesh,
    corners: Vec<Vec3A>,
    size: Vec3A,
    margin: f32,
) -> impl Iterator<Item = GridTriangle> + '_ {
    mesh.triangles.iter().enumerate().filter_map(move |(index, vertices)| {
        let tag = mesh.part(index).tag;
        let triangle = GridTriangle::new(vertices.map(|v| corners[v as usize]), tag)?;
        triangle.reaches_about(size, margin).then_some(triangle)
    })
}

/// Which triangles touch which slab of slices.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    /// Where each slab's list starts in `triangles`, and at last where the last one ends.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Bins {
    /// A counting sort: no comparison, two runs over the triangles.
    pub(crate) fn sort<T>(&mut self, triangles: &[T], slices: usize, slices_of: impl Fn(&T) -> Range<usize>) {
        let slabs = slices.div_ceil(SLAB_SLICES);
        let slabs_of = |t: &T| {
            let touched = slices_of(t);
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

    /// Numbers of a slab's triangles.
    pub(crate) fn of(&self, slab: usize) -> &[u32] {
        &self.triangles[self.starts[slab] as usize..self.starts[slab + 1] as usize]
    }
}
