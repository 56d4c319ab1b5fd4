//! What cameras see: rasterised where rays are straight, traced pixel by pixel where a lens bends them.

use glam::Vec3;
use rayon::prelude::*;
use render::{CameraQuery, PinholeCamera, RayBatch, RayQuery, Scene, VisibilityBuffer};

use crate::error::SensorError;
use render::CameraView;

/// Rows and columns of the blocks in which rays are followed: 16 neighbours make a packet.
const BLOCK: u32 = 4;
/// Rows of blocks of a batch.
const BLOCKS: u32 = 4;

/// A rectangle of whole pixels of a picture: first column and row, columns and rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) corner: [u32; 2],
    pub(super) size: [u32; 2],
}

/// Rays of some pixels.
struct Bundle {
    /// Numbers of the pixels in the window, and how long their directions are in the optical frame.
    pixels: Vec<(usize, f32)>,
    /// Unit directions in the snapshot's local frame.
    directions: Vec<Vec3>,
}

/// What cameras see, in their order.
///
/// # Errors
/// The renderer failed.
pub(crate) fn render_views(
    scene: &dyn Scene,
    views: &[CameraView],
) -> Result<Vec<VisibilityBuffer>, SensorError> {
    let straight: Vec<CameraQuery<'_>> = views
        .iter()
        .filter(|view| view.model.rays().is_none())
        .map(|view| CameraQuery::of(view.pinhole()))
        .collect();
    let mut straight = scene.render(&straight)?.into_iter();
    let mut seen = Vec::with_capacity(views.len());
    for view in views {
        let buffer = if view.model.rays().is_none() { straight.next() } else { None };
        seen.push(match buffer {
            Some(buffer) => buffer,
            None => {
                let camera = view.pinhole();
                let window = Window { corner: [0, 0], size: [camera.width, camera.height] };
                let mut buffer = render_bent(view, window, None, scene)?;
                buffer.rays = view.model.rays().cloned();
                buffer
            }
        });
    }
    Ok(seen)
}

/// What a window of a camera with a lens would show if there were nothing but some instances.
///
/// # Errors
/// The renderer failed.
pub(super) fn render_bent_views(
    scene: &dyn Scene,
    view: &CameraView,
    window: Window,
    instances: &[u32],
) -> Result<VisibilityBuffer, SensorError> {
    render_bent(view, window, Some(instances), scene)
}

fn render_bent(
    view: &CameraView,
    window: Window,
    among: Option<&[u32]>,
    scene: &dyn Scene,
) -> Result<VisibilityBuffer, SensorError> {
    let whole = view.pinhole();
    let [width, height] = window.size;
    let mut buffer = VisibilityBuffer::empty(&PinholeCamera { width, height, ..whole });
    let Some(rays) = view.model.rays() else { return Ok(buffer) };
    let bands: Vec<u32> = (0..height.div_ceil(BLOCK * BLOCKS)).collect();
    let bundle = |&band: &u32| {
        let mut bundle = Bundle { pixels: Vec::new(), directions: Vec::new() };
        let rows = band * BLOCK * BLOCKS..height.min((band + 1) * BLOCK * BLOCKS);
        for row in rows.clone().step_by(BLOCK as usize) {
            for column in (0..width).step_by(BLOCK as usize) {
                for y in row..rows.end.min(row + BLOCK) {
                    for x in column..width.min(column + BLOCK) {
                        let [left, top] = window.corner;
                        let ray = rays[(top + y) as usize * whole.width as usize + (left + x) as usize];
                        let length = ray.length();
                        bundle.pixels.push((y as usize * width as usize + x as usize, length));
                        let local = view.local_from_optical.transform_vector3(ray / length);
                        bundle.directions.push(local.normalize());
                    }
                }
            }
        }
        bundle
    };
    let bundles: Vec<Bundle> = bands.par_iter().map(bundle).collect();
    let (origin, range_m) = (Vec3::from(view.local_from_optical.translation), [whole.near_m, whole.far_m]);
    let query = |directions| RayQuery {
        among,
        ..RayQuery::of(RayBatch { origin, directions, range_m, nearest_m: &[] })
    };
    let queries: Vec<RayQuery<'_>> = bundles.iter().map(|bundle| query(&bundle.directions)).collect();
    for (bundle, hits) in bundles.iter().zip(scene.trace(&queries)?) {
        for (&(pixel, length), hit) in bundle.pixels.iter().zip(hits.iter()) {
            let Some(hit) = hit else { continue };
            buffer.instance[pixel] = hit.instance;
            buffer.triangle[pixel] = hit.triangle;
            buffer.depth_m[pixel] = hit.t / length;
        }
    }
    Ok(buffer)
}
