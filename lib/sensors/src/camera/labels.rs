//! Images of labels: tags, object ids, depth; and how many pixels show each object.

use std::collections::BTreeMap;

use rayon::prelude::*;
use schema::{ObjectId, Tag};
use visibility::{SKY, Scene, VisibilityBuffer};

/// Depth at the end of the 24-bit scale, metres.
const DEPTH_SCALE_M: f64 = 1000.0;
/// Largest 24-bit number.
const DEPTH_STEPS: f64 = 16_777_215.0;

/// What each pixel shows, run by run.
pub(super) struct LabelImages<'a> {
    scene: &'a Scene<'a>,
    buffer: &'a VisibilityBuffer,
}

impl<'a> LabelImages<'a> {
    pub(super) fn new(scene: &'a Scene<'a>, buffer: &'a VisibilityBuffer) -> Self {
        Self { scene, buffer }
    }

    /// Calls `each(first pixel, end, tag, id)` for runs of pixels of one row that show one triangle.
    fn runs(&self, y: usize, mut each: impl FnMut(usize, usize, Tag, ObjectId)) {
        let width = self.buffer.width as usize;
        let instances = &self.buffer.instance[y * width..(y + 1) * width];
        let triangles = &self.buffer.triangle[y * width..(y + 1) * width];
        let snapshot = self.scene.snapshot();
        let mut start = 0;
        while start < width {
            let (instance, triangle) = (instances[start], triangles[start]);
            let same = instances[start..]
                .iter()
                .zip(&triangles[start..])
                .take_while(|&(&i, &t)| i == instance && t == triangle)
                .count();
            let (tag, id) = if instance == SKY {
                (Tag::Sky, 0)
            } else {
                let placed = &snapshot.instances[instance as usize];
                (snapshot.mesh(placed).part(triangle as usize).tag, placed.object)
            };
            each(start, start + same, tag, id);
            start += same;
        }
    }

    /// The colour of each pixel's tag; that of [`Tag::Sky`] where nothing is seen.
    pub(super) fn semantic(&self) -> Vec<u8> {
        self.paint(|tag, _| tag.camera_rgb())
    }

    /// Tag, low byte and high byte of the id of each pixel.
    pub(super) fn instances(&self) -> Vec<u8> {
        self.paint(|tag, id| {
            let [low, high] = id.to_le_bytes();
            [tag as u8, low, high]
        })
    }

    /// Three bytes a pixel.
    fn paint(&self, rgb_of: impl Fn(Tag, ObjectId) -> [u8; 3] + Sync) -> Vec<u8> {
        let width = self.buffer.width as usize;
        let mut rgb = vec![0; 3 * self.buffer.instance.len()];
        rgb.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
            self.runs(y, |start, end, tag, id| {
                row[3 * start..3 * end].as_chunks_mut::<3>().0.fill(rgb_of(tag, id));
            });
        });
        rgb
    }

    /// Pixels by object and tag.
    pub(super) fn pixel_counts(&self) -> BTreeMap<(ObjectId, Tag), u32> {
        let objects = self.scene.snapshot().instances.iter().map(|i| usize::from(i.object) + 1).max();
        let mut by_object = vec![[0u32; Tag::COUNT]; objects.unwrap_or(1)];
        for y in 0..self.buffer.height as usize {
            self.runs(y, |start, end, tag, id| {
                by_object[usize::from(id)][tag as usize] += (end - start) as u32;
            });
        }
        // Object 0 is no object: the sky.
        let objects = (0..=ObjectId::MAX).zip(by_object).skip(1);
        objects
            .flat_map(|(id, by_tag)| Tag::ALL.into_iter().zip(by_tag).map(move |(tag, n)| ((id, tag), n)))
            .filter(|(_, pixels)| *pixels > 0)
            .collect()
    }
}

/// Planar depth as 24-bit numbers, red lowest: `round(depth / 1000 m * (2^24 - 1))`, at most that for sky.
pub(super) fn depth_rgb(buffer: &VisibilityBuffer) -> Vec<u8> {
    let mut rgb = vec![0; 3 * buffer.depth_m.len()];
    rgb.par_chunks_mut(3 << 14).zip(buffer.depth_m.par_chunks(1 << 14)).for_each(|(rgb, depth_m)| {
        for (pixel, &depth_m) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(depth_m) {
            let steps = (f64::from(depth_m) * (DEPTH_STEPS / DEPTH_SCALE_M) + 0.5).min(DEPTH_STEPS) as u32;
            let [low, middle, high, _] = steps.to_le_bytes();
            *pixel = [low, middle, high];
        }
    });
    rgb
}

/// Planar depth in metres of a pixel of a depth image.
#[must_use]
pub fn decode_depth_m([low, middle, high]: [u8; 3]) -> f64 {
    f64::from(u32::from_le_bytes([low, middle, high, 0])) * (DEPTH_SCALE_M / DEPTH_STEPS)
}
