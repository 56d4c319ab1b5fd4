//! Motion blur: objects that move while the shutter is open are smeared along their way.
//!
//! The filter gathers along the fastest motion near by, and takes from each place as much as its own motion
//! lets it reach, the nearer before the farther (McGuire et al., "A reconstruction filter for plausible
//! motion blur", 2012). The shutter closes at the frame's time.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Side of the tiles whose fastest motion is looked up, pixels; nothing is smeared farther.
const TILE: usize = 40;
/// Places that are looked at along a way.
const LOOKS: usize = 24;
/// Depths differ softly within this share.
const SOFT: f32 = 0.04;
/// Less motion is not seen, pixels.
const LEAST: f32 = 0.5;

/// Light by pixel, as film values.
pub(super) struct Light<'a> {
    pub(super) width: usize,
    pub(super) values: &'a [Vec3],
    pub(super) depth_m: &'a [f32],
}

/// Film values with what moved smeared: `moved` is how far each pixel's surface came in the picture while the
/// shutter was open, pixels to the right and down.
pub(super) fn smeared(light: &Light<'_>, moved: &[Vec2]) -> Vec<Vec3> {
    let Light { width, values, depth_m } = *light;
    let height = values.len() / width;
    let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
    let bounded = |way: Vec2| way.clamp_length_max(TILE as f32 - 1.0);
    let fastest: Vec<Vec2> = (0..columns * rows)
        .into_par_iter()
        .map(|tile| {
            let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
            let pixels = (y0..height.min(y0 + TILE))
                .flat_map(|y| (x0..width.min(x0 + TILE)).map(move |x| y * width + x));
            faster(pixels.map(|pixel| bounded(moved[pixel])))
        })
        .collect();
    let around = |x: usize, y: usize| {
        let (tx, ty) = (x / TILE, y / TILE);
        let near = (ty.saturating_sub(1)..rows.min(ty + 2))
            .flat_map(|y| (tx.saturating_sub(1)..columns.min(tx + 2)).map(move |x| y * columns + x));
        faster(near.map(|tile| fastest[tile]))
    };
    let mut out = values.to_vec();
    out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let mut way = Vec2::ZERO;
        for (x, out) in row.iter_mut().enumerate() {
            if x % TILE == 0 {
                way = around(x, y);
            }
            if way.length() < LEAST {
                continue;
            }
            let here = y * width + x;
            let own = bounded(moved[here]).length();
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for look in 0..LOOKS {
                // What is here now was on this side before; what was here is now on that side.
                let share = (look as f32 + 0.5) / LOOKS as f32;
                let there = Vec2::new(x as f32, y as f32) + way * share;
                let (tx, ty) = (there.x.round(), there.y.round());
                let inside = tx >= 0.0 && ty >= 0.0 && tx < width as f32 && ty < height as f32;
                let at = if inside { ty as usize * width + tx as usize } else { here };
                let away = way.length() * share;
                let reaches = |length: f32| (length - away + 0.5).clamp(0.0, 1.0);
                let before = nearer(depth_m[at], depth_m[here]);
                // What is nearer comes by; what is farther is seen through what has moved away from here.
                let weight = before * reaches(bounded(moved[at]).length()) + (1.0 - before) * reaches(own);
                sum += values[at] * weight;
                weights += weight;
            }
            // What was not covered is as it is.
            *out = (sum + values[here] * (LOOKS as f32 - weights)) / LOOKS as f32;
        }
    });
    out
}

/// The longest of some ways, the first of equals.
fn faster(ways: impl Iterator<Item = Vec2>) -> Vec2 {
    ways.fold(Vec2::ZERO, |most, way| if way.length_squared() > most.length_squared() { way } else { most })
}

/// 1 where something is as near as something else or nearer, 0 where it is clearly farther.
fn nearer(depth_m: f32, than_m: f32) -> f32 {
    if depth_m <= than_m {
        return 1.0;
    }
    let farther = 1.0 - than_m / depth_m;
    (1.0 - farther / SOFT).clamp(0.0, 1.0)
}
