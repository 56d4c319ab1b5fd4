//! The rasteriser: instances sorted into tiles, tiles drawn in parallel.
//!
//! Each tile walks the trees of the instances that may touch it, front to back, and leaves out what lies outside
//! the tile or behind everything drawn. Triangles are drawn in homogeneous coordinates (Olano and Greer,
//! "Triangle scan conversion using 2D homogeneous coordinates", 1997): the edge functions of a triangle are
//! evaluated along the pixel's ray, so triangles that cross the camera's plane need no clipping. Depth is kept
//! as its inverse, which is linear over the picture and leaves `f32` its precision where it is needed.

mod tile;
mod view;

use rayon::prelude::*;
use renderer::{PinholeCamera, VisibilityBuffer};

use crate::placed::Placed;
use tile::Tile;
use view::{TILE_HEIGHT, TILE_WIDTH, View};

/// Sees instances, given with their numbers, through a pinhole camera, in parallel.
pub(crate) fn rasterize<'p, 'a: 'p>(
    placed: impl Iterator<Item = (u32, &'p Option<Placed<'a>>)>,
    camera: &PinholeCamera,
) -> VisibilityBuffer {
    let mut buffer = VisibilityBuffer::empty(camera);
    let width = camera.width as usize;
    if width == 0 || camera.height == 0 {
        return buffer;
    }
    let view = View::new(placed, camera);
    let band = width * TILE_HEIGHT;
    let instances = buffer.instance.par_chunks_mut(band);
    let triangles = buffer.triangle.par_chunks_mut(band);
    let depths = buffer.depth_m.par_chunks_mut(band);
    instances.zip(triangles).zip(depths).enumerate().for_each(|(row, ((instance, triangle), depth_m))| {
        let columns = width.div_ceil(TILE_WIDTH);
        let tiles: Vec<Option<Tile>> =
            (0..columns).into_par_iter().map(|column| Tile::draw(&view, column, row)).collect();
        for (column, tile) in tiles.iter().enumerate() {
            if let Some(tile) = tile {
                tile.copy_to(width, column * TILE_WIDTH, instance, triangle, depth_m);
            }
        }
    });
    buffer
}
