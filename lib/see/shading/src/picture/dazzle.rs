//! Lamps that shine into the lens: they are small, so what they scatter does not hang on which pixel's centre
//! meets one.

use glam::Vec3;
use render::{CameraView, VisibilityBuffer};
use simd::{F32x8, LANES};

use super::bloom::Halo;
use super::shader::Shader;
use crate::light::Shining;

/// Something this much nearer than a lamp is before it, metres, and as a share of its distance.
const BEFORE_M: f32 = 0.4;
const BEFORE: f32 = 0.01;
/// A lamp is in as many pixels around the one that it is in the middle of, each way.
const AROUND: i64 = 1;
/// No lamp counts for more than so many pixels of film value 1: an eye, or a driver, looks away.
const MOST: f32 = 150_000.0;
/// Less is not seen.
const LEAST: f32 = 20.0;

/// What lamps that a picture shows scatter in its lens.
pub(super) fn halos(shader: &Shader<'_>, view: &CameraView) -> Vec<Halo> {
    let buffer = shader.buffer;
    let mut halos = Vec::new();
    let optical_from_local = buffer.camera.local_from_optical.inverse();
    for Shining { position, klx } in shader.lighting.lamps.shining_on(shader.camera) {
        let optical = optical_from_local.transform_point3(position);
        let (at, is_shown) = view.model.project(optical);
        let [width, height] = [buffer.width, buffer.height].map(|pixels| pixels as f32);
        if !(is_shown && (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y)) {
            continue;
        }
        let (x, y) = (at.x as u32, at.y as u32);
        let away_m = optical.length();
        let seen = seen(buffer, [x, y], away_m * (1.0 - BEFORE) - BEFORE_M);
        if seen == 0.0 {
            continue;
        }
        let fog = shader.lighting.fog.passes(shader.camera.z, F32x8::splat(position.z), F32x8::splat(away_m));
        let passes = fog * shader.vignette.passes(&[x; LANES], y);
        // Film values of all pixels together: light at the lens over the solid angle of a pixel.
        let film = klx * (shader.exposure * seen * passes.to_array()[0] / pixel_sr(buffer, [x, y]));
        let film = film * shader.balance;
        let most = film.max_element();
        if most > LEAST {
            halos.push(Halo { x: at.x, y: at.y, film: film * (MOST / most).min(1.0) });
        }
    }
    halos
}

/// Share of the pixels around one that see nothing nearer than a distance.
fn seen(buffer: &VisibilityBuffer, [x, y]: [u32; 2], nearest_m: f32) -> f32 {
    let (mut seen, mut all) = (0.0, 0.0);
    for row in i64::from(y) - AROUND..=i64::from(y) + AROUND {
        for column in i64::from(x) - AROUND..=i64::from(x) + AROUND {
            if (0..i64::from(buffer.width)).contains(&column) && (0..i64::from(buffer.height)).contains(&row)
            {
                let (column, row) = (column as u32, row as u32);
                let away_m = buffer.depth_m[buffer.index(column, row)]
                    * buffer.direction_optical(column, row).length();
                all += 1.0;
                seen += if away_m > nearest_m { 1.0 } else { 0.0 };
            }
        }
    }
    if all > 0.0 { seen / all } else { 0.0 }
}

/// The solid angle of a pixel.
fn pixel_sr(buffer: &VisibilityBuffer, [x, y]: [u32; 2]) -> f32 {
    // Of its neighbours to the left and above at the last column and row.
    let beside = |v: u32, end: u32| if v + 1 < end { v + 1 } else { v.saturating_sub(1) };
    let way = |x: u32, y: u32| buffer.direction_optical(x, y).normalize_or(Vec3::Z);
    let here = way(x, y);
    let (right, down) = (way(beside(x, buffer.width), y), way(x, beside(y, buffer.height)));
    (right - here).cross(down - here).length().max(1e-12)
}
