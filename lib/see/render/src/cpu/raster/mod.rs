//! The rasteriser: instances sorted into tiles, tiles drawn in parallel.
//!
//! Each tile walks the trees of the instances that may touch it, front to back, and leaves out what lies
//! outside the tile or behind everything drawn. Triangles are drawn in homogeneous coordinates (Olano and
//! Greer, "Triangle scan conversion using 2D homogeneous coordinates", 1997): the edge functions of a
//! triangle are evaluated along the pixel's ray, so triangles that cross the camera's plane need no clipping.
//! Depth is kept as its inverse, which is linear over the picture and leaves `f32` its precision where it is
//! needed.

mod tile;

use crate::{Outputs, PinholeCamera, VisibilityBuffer};
use rayon::prelude::*;

use crate::prepared::{TILE_HEIGHT, TILE_WIDTH, TiledView};
use tile::Tile;

/// Draws a view in parallel.
pub(crate) fn rasterize(view: &TiledView<'_>, outputs: Outputs) -> VisibilityBuffer {
    let camera = &view.camera;
    let mut buffer = match outputs {
        Outputs::Surfaces => VisibilityBuffer::empty(camera),
        Outputs::Depths => VisibilityBuffer::empty_depths(camera),
    };
    let Some(band) = band(camera) else { return buffer };
    let depths = buffer.depth_m.par_chunks_mut(band).enumerate();
    match outputs {
        Outputs::Surfaces => {
            let instances = buffer.instance.par_chunks_mut(band);
            let numbers = instances.zip(buffer.triangle.par_chunks_mut(band));
            depths.zip(numbers).for_each(|((row, depth_m), (instance, triangle))| {
                for (column, tile) in tiles::<true>(view, row) {
                    tile.copy_depths(camera, column, depth_m);
                    tile.copy_numbers(camera, column, [instance, triangle]);
                }
            });
        }
        Outputs::Depths => depths.for_each(|(row, depth_m)| {
            for (column, tile) in tiles::<false>(view, row) {
                tile.copy_depths(camera, column, depth_m);
            }
        }),
    }
    buffer
}

/// Pixels of a row of tiles; none where the picture has none.
fn band(camera: &PinholeCamera) -> Option<usize> {
    (camera.width > 0 && camera.height > 0).then_some(camera.width as usize * TILE_HEIGHT)
}

/// Draws a row of tiles: those that anything may be in, with their first columns.
fn tiles<const NUMBERED: bool>(view: &TiledView<'_>, row: usize) -> Vec<(usize, Tile<NUMBERED>)> {
    let columns = (view.camera.width as usize).div_ceil(TILE_WIDTH);
    let tile = |column: usize| Some((column * TILE_WIDTH, Tile::draw(view, column, row)?));
    (0..columns).into_par_iter().filter_map(tile).collect()
}
