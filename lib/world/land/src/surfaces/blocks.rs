//! Large surfaces cut into blocks, each a small mesh with its own origin.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use nalgebra::Point3;
use schema::Layer;
use schema::geometry::{MeshPart, SurfaceMesh, TriMesh};
use schema::mesh_textures::MeshTextures;

use crate::surfaces::region::Region;

/// Places along sidewalks are told but for whole multiples of this, metres: a power of two.
const REPEAT_M: f64 = 256.0;
/// What lies along no kerb is laid by the plan of the world, so far away from any, metres: a whole number of
/// patterns.
const NO_KERB_M: f64 = 1024.0;
/// Side of a block, metres.
const BLOCK_M: f64 = 64.0;

#[derive(Debug)]
struct Block {
    origin_m: [f64; 3],
    mesh: TriMesh,
    /// Vertices by the bits of their position.
    known: BTreeMap<[u32; 3], u32>,
    /// Of sidewalks, for each triangle: along the sidewalk and away from its kerb.
    laid: Vec<[Vec2; 3]>,
}

/// A triangle, and how far along its sidewalk and from the kerb its corners are.
type Laid = ([Point3<f64>; 3], [[f64; 2]; 3]);

/// Where what lies along no kerb is said to be.
fn on_plan(p: Point3<f64>) -> [f64; 2] {
    let y = p.y.rem_euclid(REPEAT_M);
    [p.x, NO_KERB_M + y]
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
    pub(crate) fn triangle(&mut self, layer: Layer, part: MeshPart, corners: [Point3<f64>; 3]) {
        let middle = (corners[0].coords + corners[1].coords + corners[2].coords) / 3.0;
        self.place(layer, part, [middle.x, middle.y], &[(corners, corners.map(on_plan))]);
    }

    /// Adds a quad (counter-clockwise seen from outside) to the block that its middle lies in.
    pub(crate) fn quad(&mut self, layer: Layer, part: MeshPart, corners: [Point3<f64>; 4]) {
        self.quad_along(layer, part, corners, corners.map(on_plan));
    }

    /// The same of a sidewalk, with metres along it and away from its kerb.
    pub(crate) fn quad_along(
        &mut self,
        layer: Layer,
        part: MeshPart,
        corners: [Point3<f64>; 4],
        laid: [[f64; 2]; 4],
    ) {
        let [a, b, c, d] = corners;
        let middle = (a.coords + b.coords + c.coords + d.coords) / 4.0;
        let [e, f, g, h] = laid;
        let both = [([a, b, c], [e, f, g]), ([a, c, d], [e, g, h])];
        self.place(layer, part, [middle.x, middle.y], &both);
    }

    fn place(&mut self, layer: Layer, part: MeshPart, middle: [f64; 2], triangles: &[Laid]) {
        let [column, row] = [0, 1].map(|k| {
            let [low, high] = self.range[k];
            ((middle[k] / BLOCK_M).floor() as i32).clamp(low, high.max(low))
        });
        let block = self.blocks.entry((layer, column, row)).or_insert_with(|| Block {
            origin_m: [
                (f64::from(column) + 0.5) * BLOCK_M,
                (f64::from(row) + 0.5) * BLOCK_M,
                triangles[0].0[0].z.round(),
            ],
            mesh: TriMesh::default(),
            known: BTreeMap::new(),
            laid: Vec::new(),
        });
        let part = block.mesh.part_index(part);
        for (corners, laid) in triangles {
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
            if layer == Layer::Sidewalk && block.laid.len() < block.mesh.triangles.len() {
                // All that is laid repeats within that, and small numbers are finer.
                let from = (laid[0][0] / REPEAT_M).floor() * REPEAT_M;
                block.laid.push(laid.map(|[along, away]| Vec2::new((along - from) as f32, away as f32)));
            }
        }
    }

    /// The blocks, by layer and place.
    pub(crate) fn finish(self) -> Vec<SurfaceMesh> {
        let blocks = self.blocks.into_iter().filter(|(_, b)| !b.mesh.triangles.is_empty());
        let whole = |((layer, _, _), mut b): ((Layer, i32, i32), Block)| {
            let laid = std::mem::take(&mut b.laid);
            b.mesh.textures =
                (!laid.is_empty()).then(|| Arc::new(MeshTextures { corners: laid, sets: Vec::new() }));
            SurfaceMesh { layer, origin_m: b.origin_m, mesh: b.mesh }
        };
        blocks.map(whole).collect()
    }
}
