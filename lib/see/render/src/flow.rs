//! Where each pixel's surface was one frame ago.

use glam::{Affine3A, Mat3};
use rayon::prelude::*;
use schema::geometry::Snapshot;
use simd::{F32x8, LANES, Vec3x8};

use crate::{CameraView, Surfaces, VisibilityBuffer};

/// Largest flow: the whole picture.
const LIMIT: f32 = 2.0;
/// Flow is a multiple of this, 0.006 pixels of a picture 1600 wide: about the accuracy of the positions it is
/// made of, and the digits beyond would not compress.
const STEP: f32 = 1.0 / 131_072.0;

/// Current minus previous position on the screen of the surface at each pixel, right and up, row by row; the
/// picture is 2 units wide and high.
pub fn flow(snapshot: &Snapshot, view: &CameraView, buffer: &VisibilityBuffer) -> (Vec<f32>, Vec<f32>) {
    let camera = &buffer.camera;
    let width = buffer.width as usize;
    let surfaces = Surfaces::new(buffer, snapshot);
    let instances = &snapshot.instances;
    let optical_before = view.previous_local_from_optical.inverse();
    // Per instance: from its frame to the previous optical frame.
    let before: Vec<Affine3A> =
        instances.iter().map(|i| optical_before * i.previous_local_from_object).collect();
    let camera_stands = view.previous_local_from_optical == camera.local_from_optical;
    let stands = |i: u32| {
        let instance = &instances[i as usize];
        camera_stands && instance.previous_local_from_object == instance.local_from_object
    };
    let pixels = buffer.instance.len();
    let (mut dx, mut dy) = (vec![0.0; pixels], vec![0.0; pixels]);
    let rows = dx.par_chunks_mut(width).zip(dy.par_chunks_mut(width));
    let turned = Mat3::from(camera.local_from_optical.matrix3);
    let turned_before = Mat3::from(optical_before.matrix3);
    rows.enumerate().for_each(|(y, (dx, dy))| {
        let y = y as u32;
        surfaces.for_each_span(y, |span, triangle| {
            if triangle.map_or(camera_stands, |triangle| stands(triangle.instance)) {
                return;
            }
            for first in span.clone().step_by(LANES) {
                let columns: [u32; LANES] = std::array::from_fn(|i| (first + i as u32).min(span.end - 1));
                let was = match triangle {
                    Some(triangle) => {
                        let before = &before[triangle.instance as usize];
                        let there = triangle.points(buffer, &columns, y).position_object;
                        there.turned(&Mat3::from(before.matrix3)) + Vec3x8::splat(before.translation.into())
                    }
                    None => buffer.directions_optical(&columns, y).turned(&turned).turned(&turned_before),
                };
                let [column, row] = view.model.project_all(&was);
                let now = F32x8::from(columns.map(|x| x as f32 + 0.5));
                let right = rounded((now - column) * 2.0 / camera.width as f32);
                let up = rounded((y as f32 + 0.5 - row) * -2.0 / camera.height as f32);
                let pixels = first as usize..(first as usize + LANES).min(span.end as usize);
                let length = pixels.len();
                dx[pixels.clone()].copy_from_slice(&right.to_array()[..length]);
                dy[pixels].copy_from_slice(&up.to_array()[..length]);
            }
        });
    });
    (dx, dy)
}

/// Limited and rounded, ties to even; without negative zeros, which would only cost bytes.
#[inline]
fn rounded(flow: F32x8) -> F32x8 {
    // A product with a power of 2 is exact. Adding 0 turns -0 into 0.
    (flow.fast_clamp(F32x8::splat(-LIMIT), F32x8::splat(LIMIT)) / STEP).round() * STEP + 0.0
}
