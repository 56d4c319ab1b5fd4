//! What a camera sees, per pixel.

use std::sync::Arc;

use glam::Vec3;
use simd::{F32x8, LANES, Vec3x8};

use crate::camera::PinholeCamera;

/// In [`VisibilityBuffer::instance`] and [`VisibilityBuffer::triangle`]: nothing is seen here.
pub const SKY: u32 = u32::MAX;

/// Which surface each pixel's centre sees; rows from the top, row-major. `Surfaces` reads the surface
/// points out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibilityBuffer {
    /// The camera that saw it.
    pub camera: PinholeCamera,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Index into the snapshot's instances, or [`SKY`].
    pub instance: Vec<u32>,
    /// Index into the triangles of that instance's mesh, or [`SKY`].
    pub triangle: Vec<u32>,
    /// A surface is at so many times the pixel's direction, which is planar depth where no rays say
    /// otherwise, metres; infinite for sky.
    pub depth_m: Vec<f32>,
    /// Where a lens bends light: the direction of each pixel in the optical frame.
    pub rays: Option<Arc<[Vec3]>>,
}

impl VisibilityBuffer {
    /// A picture of the sky alone.
    #[must_use]
    pub fn empty(camera: &PinholeCamera) -> Self {
        let depths = Self::empty_depths(camera);
        let pixels = depths.depth_m.len();
        Self { instance: vec![SKY; pixels], triangle: vec![SKY; pixels], ..depths }
    }

    /// A picture of the sky with depths alone: instances and triangles are empty.
    #[must_use]
    pub fn empty_depths(camera: &PinholeCamera) -> Self {
        let pixels = camera.width as usize * camera.height as usize;
        Self {
            camera: *camera,
            width: camera.width,
            height: camera.height,
            instance: Vec::new(),
            triangle: Vec::new(),
            depth_m: vec![f32::INFINITY; pixels],
            rays: None,
        }
    }

    /// The direction in the optical frame in which a pixel's centre looks; of pinholes 1 long along the axis.
    #[must_use]
    pub fn direction_optical(&self, x: u32, y: u32) -> Vec3 {
        match &self.rays {
            Some(rays) => rays[self.index(x, y)],
            None => self.camera.direction_optical(x as f32 + 0.5, y as f32 + 0.5),
        }
    }

    /// The same of eight pixels of a row, whose columns are given.
    #[must_use]
    #[inline]
    pub fn directions_optical(&self, x: &[u32; LANES], y: u32) -> Vec3x8 {
        match &self.rays {
            Some(rays) => Vec3x8::from_fn(|i| rays[self.index(x[i], y)]),
            None => {
                let camera = &self.camera;
                let column = F32x8::from(x.map(|x| x as f32 + 0.5));
                let down = (y as f32 + 0.5 - camera.cy) / camera.fy;
                Vec3x8::new((column - camera.cx) / camera.fx, F32x8::splat(down), F32x8::ONE)
            }
        }
    }

    /// Index of a pixel in the three lists.
    #[must_use]
    pub fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }
}
