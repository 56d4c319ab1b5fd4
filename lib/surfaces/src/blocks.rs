//! Large surfaces cut into blocks, each a small mesh with its own origin.

use std::collections::BTreeMap;

use glam::Vec3;
use nalgebra::Point3;
use schema::Layer;
use schema::geometry::{Part, SurfaceMesh, TriMesh};

use crate::region::Region;

/// Side of a block, metres.
const BLOCK_M: f64 = 64.0;

#[derive(Debug)]
struct Block {
    origin_m: [f64; 3],
    mesh: TriMesh,
    /// Vertices by the bits of their position.
    known: BTreeMap<[u32; 3], u32>,
}

/// Blocks of an area in the making, by layer and place.
#[derive(Debug)]
pub(crate) struct Blocks {
    /// Lowest and highest column and row of the area.
    range: [[i32; 2]; 2],
    blocks: BTreeMap<(Layer, i32, i32), Block>,
}

impl Blocks {
    /// Empty ones of an area: what overhangs it belongs to those at its edge.
    pub(crate) fn new(area: &Region) -> Self {
        let range = [0, 1].map(|k| {
            let [low, high] = [area.min[k] / BLOCK_M, area.max[k] / BLOCK_M];
            [low.floor() as i32, high.ceil() as i32 - 1]
        });
        Self { range, blocks: BTreeMap::new() }
    }

    /// Adds a triangle to the block that its middle lies in.
    pub(crate) fn triangle(&mut self, layer: Layer, part: Part, corners: [Point3<f64>; 3]) {
        let middle = (corners[0].coords + corners[1].coords + corners[2].coords) / 3.0;
        self.place(layer, part, [middle.x, middle.y], &[corners]);
    }

    /// Adds a quad (counter-clockwise seen from outside) to the block that its middle lies in.
    pub(crate) fn quad(&mut self, layer: Layer, part: Part, corners: [Point3<f64>; 4]) {
        let [a, b, c, d] = corners;
        let middle = (a.coords + b.coords + c.coords + d.coords) / 4.0;
        self.place(layer, part, [middle.x, middle.y], &[[a, b, c], [a, c, d]]);
    }

    fn place(&mut self, layer: Layer, part: Part, middle: [f64; 2], triangles: &[[Point3<f64>; 3]]) {
        let [column, row] = [0, 1].map(|k| {
            let [low, high] = self.range[k];
            ((middle[k] / BLOCK_M).floor() as i32).clamp(low, high.max(low))
        });
        let block = self.blocks.entry((layer, column, row)).or_insert_with(|| Block {
            origin_m: [
                (f64::from(column) + 0.5) * BLOCK_M,
                (f64::from(row) + 0.5) * BLOCK_M,
                triangles[0][0].z.round(),
            ],
            mesh: TriMesh::default(),
            known: BTreeMap::new(),
        });
        let part = block.mesh.part_index(part);
        for corners in triangles {
            let ids = corners.map(|p| {
                let local = Vec3::new(
                    (p.x - block.origin_m[0]) as f32,
                    (p.y - block.origin_m[1]) as f32,
                    (p.z - block.origin_m[2]) as f32,
                );
                let mesh = &mut block.mesh;
                *block
                    .known
                    .entry(local.to_array().map(f32::to_bits))
                    .or_insert_with(|| mesh.add_vertex(local))
            });
            block.mesh.add_triangle(part, ids);
        }
    }

    /// The blocks, by layer and place.
    pub(crate) fn finish(self) -> Vec<SurfaceMesh> {
        let blocks = self.blocks.into_iter().filter(|(_, b)| !b.mesh.triangles.is_empty());
        blocks.map(|((layer, _, _), b)| SurfaceMesh { layer, origin_m: b.origin_m, mesh: b.mesh }).collect()
    }
}
