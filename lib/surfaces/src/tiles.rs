//! Large surfaces cut into tiles, each a small mesh with its own origin.

use std::collections::BTreeMap;

use glam::Vec3;
use nalgebra::Point3;
use schema::geometry::{Part, TriMesh};

use crate::layer::Layer;

/// Side of a tile, metres.
const TILE_M: f64 = 64.0;

#[derive(Debug)]
struct Tile {
    origin_m: [f64; 3],
    mesh: TriMesh,
    /// Vertices by the bits of their position.
    known: BTreeMap<[u32; 3], u32>,
}

/// Tiles in the making, by layer and place.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    tiles: BTreeMap<(Layer, i32, i32), Tile>,
}

/// A finished tile: triangles relative to `origin_m`, axes of the world.
#[derive(Debug)]
pub struct TileMesh {
    /// Its surface.
    pub layer: Layer,
    /// Where its frame's origin is in the world, metres.
    pub origin_m: [f64; 3],
    /// Its triangles.
    pub mesh: TriMesh,
}

impl Tiles {
    /// Adds a triangle to the tile that its middle lies in.
    pub(crate) fn triangle(&mut self, layer: Layer, part: Part, corners: [Point3<f64>; 3]) {
        let middle = (corners[0].coords + corners[1].coords + corners[2].coords) / 3.0;
        self.place(layer, part, middle.x, middle.y, &[corners]);
    }

    /// Adds a quad (counter-clockwise seen from outside) to the tile that its middle lies in.
    pub(crate) fn quad(&mut self, layer: Layer, part: Part, corners: [Point3<f64>; 4]) {
        let [a, b, c, d] = corners;
        let middle = (a.coords + b.coords + c.coords + d.coords) / 4.0;
        self.place(layer, part, middle.x, middle.y, &[[a, b, c], [a, c, d]]);
    }

    fn place(&mut self, layer: Layer, part: Part, x: f64, y: f64, triangles: &[[Point3<f64>; 3]]) {
        let (column, row) = ((x / TILE_M).floor() as i32, (y / TILE_M).floor() as i32);
        let tile = self.tiles.entry((layer, column, row)).or_insert_with(|| Tile {
            origin_m: [
                (f64::from(column) + 0.5) * TILE_M,
                (f64::from(row) + 0.5) * TILE_M,
                triangles[0][0].z.round(),
            ],
            mesh: TriMesh::default(),
            known: BTreeMap::new(),
        });
        let part = tile.mesh.part_index(part);
        for corners in triangles {
            let ids = corners.map(|p| {
                let local = Vec3::new(
                    (p.x - tile.origin_m[0]) as f32,
                    (p.y - tile.origin_m[1]) as f32,
                    (p.z - tile.origin_m[2]) as f32,
                );
                let mesh = &mut tile.mesh;
                *tile
                    .known
                    .entry(local.to_array().map(f32::to_bits))
                    .or_insert_with(|| mesh.add_vertex(local))
            });
            tile.mesh.add_triangle(part, ids);
        }
    }

    /// The tiles, by layer and place.
    pub(crate) fn finish(self) -> Vec<TileMesh> {
        let tiles = self.tiles.into_iter().filter(|(_, t)| !t.mesh.triangles.is_empty());
        tiles.map(|((layer, _, _), t)| TileMesh { layer, origin_m: t.origin_m, mesh: t.mesh }).collect()
    }
}
