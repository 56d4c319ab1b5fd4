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
pub(crate) use view::is_within;
use view::{TILE_HEIGHT, TILE_WIDTH, View};

/// Sees instances, given with their numbers, through a pinhole camera, in parallel.
pub(crate) fn rasterize<'p, 'a: 'p>(
    placed: impl Iterator<Item = (u32, &'p Option<Placed<'a>>)>,
    camera: &PinholeCamera,
) -> VisibilityBuffer {
    let mut buffer = VisibilityBuffer::empty(camera);
    let Some(band) = band(camera) else { return buffer };
    let view = View::new(placed, camera, false);
    let instances = buffer.instance.par_chunks_mut(band);
    let triangles = buffer.triangle.par_chunks_mut(band);
    let depths = buffer.depth_m.par_chunks_mut(band);
    instances.zip(triangles).zip(depths).enumerate().for_each(|(row, ((instance, triangle), depth_m))| {
        for (column, tile) in tiles::<true>(&view, row) {
            tile.copy_depths(camera, column, depth_m);
            tile.copy_numbers(camera, column, [instance, triangle]);
        }
    });
    buffer
}

/// Depths alone of what [`rasterize`] sees; `through_panes`, panes with something behind them are chequered.
pub(crate) fn depths<'p, 'a: 'p>(
    placed: impl Iterator<Item = (u32, &'p Option<Placed<'a>>)>,
    camera: &PinholeCamera,
    through_panes: bool,
) -> Vec<f32> {
    let mut depth_m = vec![f32::INFINITY; camera.width as usize * camera.height as usize];
    let Some(band) = band(camera) else { return depth_m };
    let view = View::new(placed, camera, through_panes);
    depth_m.par_chunks_mut(band).enumerate().for_each(|(row, depth_m)| {
        for (column, tile) in tiles::<false>(&view, row) {
            tile.copy_depths(camera, column, depth_m);
        }
    });
    depth_m
}

/// Pixels of a row of tiles; none where the picture has none.
fn band(camera: &PinholeCamera) -> Option<usize> {
    (camera.width > 0 && camera.height > 0).then_some(camera.width as usize * TILE_HEIGHT)
}

/// Draws a row of tiles: those that anything may be in, with their first columns.
fn tiles<const NUMBERED: bool>(view: &View<'_>, row: usize) -> Vec<(usize, Tile<NUMBERED>)> {
    let columns = (view.camera.width as usize).div_ceil(TILE_WIDTH);
    let tile = |column: usize| Some((column * TILE_WIDTH, Tile::draw(view, column, row)?));
    (0..columns).into_par_iter().filter_map(tile).collect()
}
