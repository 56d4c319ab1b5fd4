//! The depth image.

use rayon::prelude::*;
use render::VisibilityBuffer;
use schema::geometry::Snapshot;
use schema::images::Depth;
use schema::tables::CameraRow;

use super::encode::{self, Content};
use super::image::Image;
use crate::error::SensorError;
use shading::Sight;

/// Depth at the end of the 24-bit scale, metres.
const DEPTH_SCALE_M: f64 = 1000.0;
/// Largest 24-bit number.
const DEPTH_STEPS: f64 = 16_777_215.0;

impl Image for Depth {
    type Row = CameraRow;

    fn of(_: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let image = encode::png_rgb(&depth_rgb(&sight.seen), Content::Smooth, &sight.seen)?;
        Ok(encode::camera_row(frame, image))
    }
}

/// Planar depth as 24-bit numbers, red lowest: `round(depth / 1000 m * (2^24 - 1))`, at most that for sky.
fn depth_rgb(buffer: &VisibilityBuffer) -> Vec<u8> {
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
