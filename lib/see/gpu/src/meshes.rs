//! The meshes of a scene on a device.

use std::sync::Arc;

use render::prepared::{BLOCK, MeshData, Meshes};

use crate::device::{Gpu, Resident};
use crate::error::GpuError;
use crate::memory::{Held, Memory};

/// Triangles that a kernel takes together.
const BATCH: u32 = 16;
/// Levels of a tree for which kernels keep room on their stacks.
pub(crate) const DEEPEST: u32 = 60;
/// Coordinates beyond which numbers may overflow on the way: nobody's world is so large.
pub(crate) const FARTHEST_M: f32 = 1e9;
/// In the list of triangles: it is a pane.
const PANE: u32 = 1 << 31;
/// Words of a node.
const NODE: usize = 8;

/// The meshes of a scene on a device.
#[derive(Debug)]
pub(crate) struct ResidentMeshes {
    pub(crate) nodes: Resident,
    pub(crate) corners: Resident,
    pub(crate) order: Resident,
    places: Vec<Option<Place>>,
    _held: Held,
}

/// Where a mesh begins in the buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Its first node.
    pub(crate) node: u32,
    /// Its first slot.
    pub(crate) slot: u32,
}

/// What the buffers hold.
#[derive(Default)]
struct Words {
    nodes: Vec<u32>,
    corners: Vec<f32>,
    order: Vec<u32>,
    places: Vec<Option<Place>>,
}

impl ResidentMeshes {
    /// Uploads meshes.
    ///
    /// # Errors
    /// There is no room for them, in a buffer or at all, or the device failed.
    pub(crate) fn upload(gpu: &Gpu, memory: &Arc<Memory>, meshes: &Meshes) -> Result<Self, GpuError> {
        let slots: usize = meshes.iter().map(|mesh| mesh.blocks.len() * BLOCK).sum();
        let nodes: usize = meshes.iter().map(|mesh| mesh.bvh.nodes.len()).sum();
        let (largest_bytes, buffer_bytes) = (4 * (9 * slots).max(NODE * nodes) as u64, gpu.largest_buffer());
        if largest_bytes > buffer_bytes {
            let problem = format!("{largest_bytes} bytes are more than the {buffer_bytes} of a buffer");
            return Err(GpuError::Memory { problem });
        }
        let held = memory.keep(4 * (10 * slots + NODE * nodes) as u64)?;
        let mut words = Words::default();
        meshes.iter().for_each(|mesh| words.add(mesh));
        let Words { mut nodes, mut corners, mut order, places } = words;
        // There is no empty buffer.
        if order.is_empty() {
            (nodes, corners, order) = (vec![0], vec![0.0], vec![0]);
        }
        Ok(Self {
            nodes: gpu.upload(bytemuck::cast_slice(&nodes))?,
            corners: gpu.upload(bytemuck::cast_slice(&corners))?,
            order: gpu.upload(bytemuck::cast_slice(&order))?,
            places,
            _held: held,
        })
    }

    /// Where a mesh is; `None` if kernels cannot walk its tree.
    pub(crate) fn place(&self, mesh: u32) -> Option<Place> {
        self.places.get(mesh as usize).copied().flatten()
    }
}

impl Words {
    fn add(&mut self, mesh: &MeshData) {
        self.places.push(
            is_walkable(mesh)
                .then_some(Place { node: (self.nodes.len() / NODE) as u32, slot: self.order.len() as u32 }),
        );
        for node in &mesh.bvh.nodes {
            let is_batch = node.child == 0 || node.count <= BATCH;
            let [first, count] = if is_batch { [node.first, node.count] } else { [node.child, 0] };
            let corner = |p: glam::Vec3, word| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), word];
            self.nodes.extend(corner(node.min, first));
            self.nodes.extend(corner(node.max, count));
        }
        for (number, slots) in mesh.bvh.order.chunks(BLOCK).enumerate() {
            self.corners.extend(mesh.blocks[number].0.as_flattened().as_flattened());
            let panes = mesh.panes.get(number).copied().unwrap_or(0);
            let word = |lane: usize| {
                let pane = if panes >> lane & 1 != 0 { PANE } else { 0 };
                slots.get(lane).map_or(0, |triangle| triangle | pane)
            };
            self.order.extend((0..BLOCK).map(word));
        }
    }
}

/// Whether kernels can walk a mesh's tree and tell its triangles: none of usual meshes is too deep.
fn is_walkable(mesh: &MeshData) -> bool {
    let has_small_leaves = mesh.bvh.nodes.iter().all(|node| node.child != 0 || node.count <= BATCH);
    has_small_leaves && mesh.bvh.depth() <= DEEPEST && mesh.bvh.order.iter().all(|triangle| *triangle < PANE)
}
