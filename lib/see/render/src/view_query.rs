//! What cameras see: rasterised where rays are straight, traced pixel by pixel where a lens bends them.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use crate::{
    CameraQuery, CameraView, Hits, PinholeCamera, RayBatch, RayQuery, RenderError, Scene, VisibilityBuffer,
};

/// Rows and columns of the blocks in which rays are followed: 16 neighbours make a packet.
const BLOCK: u32 = 4;
/// Rows of blocks of a batch.
const BLOCKS: u32 = 4;

/// A rectangle of whole pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column and row.
    pub corner: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// What a camera of a rig is asked. [`ViewQuery::of`] asks for the whole picture of all instances.
#[derive(Clone, Copy, Debug)]
pub struct ViewQuery<'a> {
    /// The camera.
    pub view: &'a CameraView,
    /// The part of the picture that is wanted, within the picture.
    pub window: Window,
    /// Numbers of instances, ascending: the picture is as if there were no others. `None`: all instances.
    pub among: Option<&'a [u32]>,
}

/// Rays of some pixels of a query.
struct Bundle<'a> {
    query: &'a ViewQuery<'a>,
    /// Numbers of the pixels in the window, and how long their directions are in the optical frame.
    pixels: Vec<(usize, f32)>,
    /// Unit directions in the snapshot's local frame.
    directions: Vec<Vec3>,
}

impl<'a> ViewQuery<'a> {
    /// The whole picture of all instances.
    #[must_use]
    pub fn of(view: &'a CameraView) -> Self {
        let camera = view.pinhole();
        let window = Window { corner: [0, 0], size: [camera.width, camera.height] };
        Self { view, window, among: None }
    }

    /// The window as a camera of its own. Its axis lies at a 1024th of a pixel: every pixel keeps its ray,
    /// bit for bit.
    fn camera(&self) -> PinholeCamera {
        let (camera, Window { corner: [left, top], size: [width, height] }) =
            (self.view.pinhole(), self.window);
        PinholeCamera { width, height, cx: camera.cx - left as f32, cy: camera.cy - top as f32, ..camera }
    }

    /// The rays of a camera with a lens, as the whole picture has them.
    fn rays(&self) -> Option<&'a Arc<[Vec3]>> {
        self.view.model.rays()
    }

    fn is_whole(&self) -> bool {
        self.window == Self::of(self.view).window
    }

    fn bundles(&'a self) -> Vec<Bundle<'a>> {
        let bands = self.window.size[1].div_ceil(BLOCK * BLOCKS);
        let rays = self.rays().map_or(&[][..], |rays| &rays[..]);
        (0..bands).into_par_iter().map(|band| self.bundle(rays, band)).collect()
    }

    fn bundle(&'a self, rays: &[Vec3], band: u32) -> Bundle<'a> {
        let Window { corner: [left, top], size: [width, height] } = self.window;
        let columns = self.view.pinhole().width as usize;
        let mut bundle = Bundle { query: self, pixels: Vec::new(), directions: Vec::new() };
        let rows = band * BLOCK * BLOCKS..height.min((band + 1) * BLOCK * BLOCKS);
        for row in rows.clone().step_by(BLOCK as usize) {
            for column in (0..width).step_by(BLOCK as usize) {
                for y in row..rows.end.min(row + BLOCK) {
                    for x in column..width.min(column + BLOCK) {
                        let ray = rays[(top + y) as usize * columns + (left + x) as usize];
                        let length = ray.length();
                        bundle.pixels.push((y as usize * width as usize + x as usize, length));
                        let local = self.view.local_from_optical.transform_vector3(ray / length);
                        bundle.directions.push(local.normalize());
                    }
                }
            }
        }
        bundle
    }
}

/// What cameras see, in the order of the queries: all of them are asked at once.
///
/// # Errors
/// The renderer failed, or left a query without an answer.
pub fn render_views(
    scene: &dyn Scene,
    queries: &[ViewQuery<'_>],
) -> Result<Vec<VisibilityBuffer>, RenderError> {
    let straight: Vec<CameraQuery<'_>> = queries
        .iter()
        .filter(|query| query.rays().is_none())
        .map(|query| CameraQuery { among: query.among, ..CameraQuery::of(query.camera()) })
        .collect();
    let bent: Vec<Vec<Bundle<'_>>> =
        queries.iter().filter(|query| query.rays().is_some()).map(ViewQuery::bundles).collect();
    let rays: Vec<RayQuery<'_>> = bent.iter().flatten().map(Bundle::query).collect();
    let mut straight = all_of(straight.len(), scene.render(&straight)?)?;
    let mut hits = all_of(rays.len(), if rays.is_empty() { Vec::new() } else { scene.trace(&rays)? })?;
    let mut bent = bent.iter();
    let seen = |query: &ViewQuery<'_>| match query.rays() {
        None => straight.next(),
        Some(rays) => bent.next().map(|bundles| {
            let mut buffer = VisibilityBuffer::empty(&query.camera());
            buffer.rays = query.is_whole().then(|| Arc::clone(rays));
            bundles.iter().zip(&mut hits).for_each(|(bundle, hits)| bundle.store(&hits, &mut buffer));
            buffer
        }),
    };
    Ok(queries.iter().filter_map(seen).collect())
}

/// The answers, if each question has one.
fn all_of<T>(asked: usize, answers: Vec<T>) -> Result<std::vec::IntoIter<T>, RenderError> {
    match answers.len() {
        answered if answered == asked => Ok(answers.into_iter()),
        answered => Err(RenderError::Unanswered { asked, answered }),
    }
}

impl Bundle<'_> {
    fn query(&self) -> RayQuery<'_> {
        let (view, camera) = (self.query.view, self.query.view.pinhole());
        let rays = RayBatch {
            origin: view.local_from_optical.translation.into(),
            directions: &self.directions,
            range_m: [camera.near_m, camera.far_m],
            nearest_m: &[],
        };
        RayQuery { among: self.query.among, ..RayQuery::of(rays) }
    }

    fn store(&self, hits: &Hits, buffer: &mut VisibilityBuffer) {
        for (&(pixel, length), hit) in self.pixels.iter().zip(hits.iter()) {
            let Some(hit) = hit else { continue };
            buffer.instance[pixel] = hit.instance;
            buffer.triangle[pixel] = hit.triangle;
            buffer.depth_m[pixel] = hit.t / length;
        }
    }
}
