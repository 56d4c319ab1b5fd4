//! Per-mesh data that rasteriser and tracer read, built once for a scene.

use std::sync::Arc;

use frames::Aabb;
use rayon::prelude::*;
use schema::geometry::TriMesh;

use crate::prepared::bvh::{Bvh, THOROUGH};

/// Triangles a block.
pub const BLOCK: usize = 8;

/// Corners of eight triangles, `[corner][axis][lane]`, so that a vector register holds one coordinate of all.
#[derive(Clone, Copy, Debug)]
pub struct Block(pub [[[f32; BLOCK]; 3]; 3]);

/// One mesh, ready to be looked at.
#[derive(Debug)]
pub struct MeshData {
    /// Tree over the triangles of non-zero area; [`Bvh::order`] maps slots of `blocks` to triangles.
    pub bvh: Bvh,
    /// Corners in the tree's order, slot `i` in lane `i % BLOCK` of block `i / BLOCK`.
    pub blocks: Vec<Block>,
    /// Around those triangles.
    pub aabb: Aabb,
    /// Which slots are panes, a bit for each lane of each block; empty where the mesh has none.
    pub panes: Vec<u8>,
}

impl MeshData {
    fn build(source: &TriMesh) -> Self {
        let visible: Vec<u32> = (0..source.triangles.len())
            .filter(|&t| {
                let [a, b, c] = source.corners(t);
                // Also false for numbers that are not finite: they make the area NaN or infinite.
                let area = (b - a).cross(c - a).length_squared();
                area > 0.0 && area.is_finite() && a.is_finite()
            })
            .map(|t| t as u32)
            .collect();
        let boxes: Vec<Aabb> =
            visible.iter().map(|&t| Aabb::from_points(&source.corners(t as usize))).collect();
        let mut bvh = Bvh::build(&boxes, THOROUGH);
        for slot in &mut bvh.order {
            *slot = visible[*slot as usize];
        }
        let mut blocks = vec![Block([[[0.0; BLOCK]; 3]; 3]); bvh.order.len().div_ceil(BLOCK)];
        for (slot, &triangle) in bvh.order.iter().enumerate() {
            let block = &mut blocks[slot / BLOCK].0;
            for (corner, position) in block.iter_mut().zip(source.corners(triangle as usize)) {
                for (axis, value) in corner.iter_mut().zip(position.to_array()) {
                    axis[slot % BLOCK] = value;
                }
            }
        }
        let aabb = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
        let mut panes = Vec::new();
        if source.parts.iter().any(|part| part.surface.is_window()) {
            panes.resize(blocks.len(), 0);
            for (slot, &triangle) in bvh.order.iter().enumerate() {
                let is_pane = source.part(triangle as usize).surface.is_window();
                panes[slot / BLOCK] |= u8::from(is_pane) << (slot % BLOCK);
            }
        }
        Self { bvh, blocks, aabb, panes }
    }
}

/// The meshes of a scene with their search trees.
#[derive(Debug, Default)]
pub struct Meshes {
    data: Vec<MeshData>,
}

impl Meshes {
    /// Prepares more meshes, in parallel; they take the next indices.
    pub(crate) fn extend(&mut self, more: &[Arc<TriMesh>]) {
        self.data.par_extend(more.par_iter().map(|mesh| MeshData::build(mesh)));
    }

    /// How many meshes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.data.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// All of them, by their numbers.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &MeshData> {
        self.data.iter()
    }

    pub(crate) fn get(&self, mesh: u32) -> Option<&MeshData> {
        self.data.get(mesh as usize)
    }
}
