//! Blur of a finished picture that follows from how long the shutter is open and what the lens is set to.

use glam::Vec2;
use rayon::prelude::*;
use render::VisibilityBuffer;
use schema::FRAME_PERIOD_S;
use schema::geometry::Snapshot;

use super::defocus::{Focus, defocused};
use super::film::Film;
use super::picture::Picture;
use super::shutter::{Light, smeared};
use render::CameraView;
use render::flow;

/// Blurs a picture as the camera's settings have it; by default they leave it alone.
pub(super) fn soften(
    picture: &mut Picture,
    film: &Film,
    snapshot: &Snapshot,
    view: &CameraView,
    buffer: &VisibilityBuffer,
) {
    let settings = &view.settings;
    let (opens_s, opening_mm) = (settings.exposure_time_s, settings.aperture_mm);
    if opens_s <= 0.0 && opening_mm <= 0.0 {
        return;
    }
    let codes = film.values();
    let pixels = picture.rgb.as_chunks::<3>().0;
    let mut values: Vec<_> = pixels
        .par_iter()
        .map(|rgb| glam::Vec3::from_array(rgb.map(|code| codes[usize::from(code)])))
        .collect();
    let (width, depth_m) = (picture.width as usize, buffer.depth_m.as_slice());
    if opening_mm > 0.0 {
        let focus = Focus {
            opening_m: opening_mm as f32 * 1e-3,
            focus_m: settings.focus_m as f32,
            focal_px: buffer.camera.fx,
        };
        values = defocused(&Light { width, values: &values, depth_m }, &focus);
    }
    if opens_s > 0.0 {
        let (right, up) = flow(snapshot, view, buffer);
        let share = 0.5 * (opens_s / FRAME_PERIOD_S) as f32;
        let pixels = Vec2::new(share * buffer.width as f32, -share * buffer.height as f32);
        let moved: Vec<Vec2> = right.iter().zip(&up).map(|(x, y)| Vec2::new(*x, *y) * pixels).collect();
        values = smeared(&Light { width, values: &values, depth_m }, &moved);
    }
    picture.rgb.as_chunks_mut::<3>().0.par_iter_mut().zip(values).for_each(|(rgb, value)| {
        *rgb = value.to_array().map(|value| film.code(value));
    });
}
