//! Images of labels: tags and object ids; and how many pixels show each object.

use std::collections::BTreeMap;

use rayon::prelude::*;
use render::{SKY, VisibilityBuffer};
use schema::geometry::Snapshot;
use schema::images::{Instance, Semantic};
use schema::tables::CameraRow;
use schema::{ObjectId, Tag};

use super::encode::{self, Content};
use super::image::Image;
use crate::error::SensorError;
use shading::Sight;

/// [`Tag::camera_rgb`] of each pixel, that of [`Tag::Sky`] where nothing is seen.
impl Image for Semantic {
    type Row = CameraRow;

    fn of(snapshot: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let rgb = Labels { snapshot, seen: &sight.seen }.paint(|tag, _| tag.camera_rgb());
        Ok(encode::camera_row(frame, encode::png_rgb(&rgb, Content::Flat, &sight.seen)?))
    }
}

impl Image for Instance {
    type Row = CameraRow;

    fn of(snapshot: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let rgb = Labels { snapshot, seen: &sight.seen }.paint(|tag, id| {
            let [low, high] = id.to_le_bytes();
            [tag as u8, low, high]
        });
        Ok(encode::camera_row(frame, encode::png_rgb(&rgb, Content::Flat, &sight.seen)?))
    }
}

/// How many pixels show each object's parts of each tag; what has no pixel is not listed.
#[must_use]
pub fn pixel_counts(snapshot: &Snapshot, seen: &VisibilityBuffer) -> BTreeMap<(ObjectId, Tag), u32> {
    let objects = snapshot.instances.iter().map(|i| usize::from(i.object) + 1).max();
    let mut by_object = vec![[0u32; Tag::COUNT]; objects.unwrap_or(1)];
    let labels = Labels { snapshot, seen };
    for y in 0..seen.height as usize {
        labels.runs(y, |start, end, tag, id| {
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

/// What each pixel shows, run by run.
struct Labels<'a> {
    snapshot: &'a Snapshot,
    seen: &'a VisibilityBuffer,
}

impl Labels<'_> {
    /// Calls `each(first pixel, end, tag, id)` for runs of pixels of one row that show one triangle.
    fn runs(&self, y: usize, mut each: impl FnMut(usize, usize, Tag, ObjectId)) {
        let width = self.seen.width as usize;
        let instances = &self.seen.instance[y * width..(y + 1) * width];
        let triangles = &self.seen.triangle[y * width..(y + 1) * width];
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
                let placed = &self.snapshot.instances[instance as usize];
                (self.snapshot.mesh(placed).part(triangle as usize).tag, placed.object)
            };
            each(start, start + same, tag, id);
            start += same;
        }
    }

    /// Three bytes a pixel.
    fn paint(&self, rgb_of: impl Fn(Tag, ObjectId) -> [u8; 3] + Sync) -> Vec<u8> {
        let width = self.seen.width as usize;
        let mut rgb = vec![0; 3 * self.seen.instance.len()];
        rgb.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
            self.runs(y, |start, end, tag, id| {
                row[3 * start..3 * end].as_chunks_mut::<3>().0.fill(rgb_of(tag, id));
            });
        });
        rgb
    }
}
