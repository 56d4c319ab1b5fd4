//! What is nearer or farther than the lens is set to is blurred.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::shutter::Light;

/// Nothing is blurred wider, pixels (radius).
const WIDEST: f32 = 24.0;
/// Smaller discs are sharp, pixels (radius).
const LEAST: f32 = 0.5;
/// Places of a disc that are looked at, and the turn from one to the next: the golden angle.
const LOOKS: usize = 64;
const TURN: f32 = 2.399_963;
/// Side of the tiles whose widest disc is looked up, pixels.
const TILE: usize = 24;

/// A lens that is set to a distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Focus {
    /// Diameter of the opening, metres.
    pub(super) opening_m: f32,
    /// What is so far away is sharp, metres.
    pub(super) focus_m: f32,
    /// Focal length, pixels.
    pub(super) focal_px: f32,
}

impl Focus {
    /// Radius of the disc that a point becomes, pixels; of a thin lens that is much nearer to its picture
    /// than to what it shows.
    fn disc_px(&self, depth_m: f32) -> f32 {
        let off = (1.0 / self.focus_m - 1.0 / depth_m.max(1e-2)).abs();
        (0.5 * self.opening_m * self.focal_px * off).min(WIDEST)
    }
}

/// Film values as a lens shows them.
pub(super) fn defocused(light: &Light<'_>, focus: &Focus) -> Vec<Vec3> {
    let Light { width, values, depth_m } = *light;
    let height = values.len() / width;
    let discs: Vec<f32> = depth_m.par_iter().map(|depth_m| focus.disc_px(*depth_m)).collect();
    let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
    let widest: Vec<f32> = (0..columns * rows)
        .into_par_iter()
        .map(|tile| {
            let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
            let rows =
                (y0..height.min(y0 + TILE)).map(|y| &discs[y * width + x0..y * width + width.min(x0 + TILE)]);
            rows.flatten().fold(0.0, |most, disc| if *disc > most { *disc } else { most })
        })
        .collect();
    let spiral: Vec<Vec2> = (0..LOOKS)
        .map(|look| {
            let (sin, cos) = frames::math::f32::sin_cos(TURN * look as f32);
            Vec2::new(cos, sin) * ((look as f32 + 0.5) / LOOKS as f32).sqrt()
        })
        .collect();
    let mut out = values.to_vec();
    out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let mut reach = 0.0;
        for (x, out) in row.iter_mut().enumerate() {
            if x % TILE == 0 {
                let (tx, ty) = (x / TILE, y / TILE);
                let near = (ty.saturating_sub(1)..rows.min(ty + 2))
                    .flat_map(|y| (tx.saturating_sub(1)..columns.min(tx + 2)).map(move |x| y * columns + x));
                reach = near.fold(0.0, |most, tile| if widest[tile] > most { widest[tile] } else { most });
            }
            if reach < LEAST {
                continue;
            }
            let here = y * width + x;
            // Each look stands for its share of the widest disc's area, the pixel itself for the middle.
            let own = discs[here].max(LEAST);
            let (mut sum, mut weights) = (values[here] / (own * own), 1.0 / (own * own));
            let area = reach * reach / LOOKS as f32;
            for step in &spiral {
                let there = Vec2::new(x as f32, y as f32) + *step * reach;
                let (tx, ty) = (there.x.round(), there.y.round());
                if tx < 0.0 || ty < 0.0 || tx >= width as f32 || ty >= height as f32 {
                    continue;
                }
                let at = ty as usize * width + tx as usize;
                // What is farther does not spread over what is sharp before it.
                let disc = if depth_m[at] > depth_m[here] { discs[at].min(discs[here]) } else { discs[at] };
                let disc = disc.max(LEAST);
                let within = (disc - step.length() * reach + 0.5).clamp(0.0, 1.0);
                let weight = within * area / (disc * disc);
                sum += values[at] * weight;
                weights += weight;
            }
            *out = sum / weights;
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_discs_of_the_size_that_optics_have() {
        // 10 mm wide, set to 5 m; a point at 1.25 m: the disc is 10 mm (1 / 1.25 - 1 / 5) wide a metre behind
        // the lens.
        let focus = Focus { opening_m: 0.01, focus_m: 5.0, focal_px: 2000.0 };
        assert!((focus.disc_px(1.25) - 6.0).abs() < 1e-4);
        assert!((focus.disc_px(f32::INFINITY) - 2.0).abs() < 1e-4 && focus.disc_px(5.0) == 0.0);
        let (width, height) = (120usize, 96usize);
        let mut values = vec![Vec3::ZERO; width * height];
        values[48 * width + 60] = Vec3::splat(100.0);
        let blurred = |depth_m: f32| {
            let depth_m = vec![depth_m; width * height];
            defocused(&Light { width, values: &values, depth_m: &depth_m }, &focus)
        };
        assert!(blurred(5.0) == values, "what it is set to is sharp");
        let out = blurred(1.25);
        for (pixel, value) in out.iter().enumerate() {
            let away = Vec2::new((pixel % width) as f32 - 60.0, (pixel / width) as f32 - 48.0).length();
            assert!(away < 7.5 || *value == Vec3::ZERO, "{away}");
        }
        // About all of the light is still there.
        let sum: f32 = out.iter().map(|v| v.x).sum();
        assert!((60.0..140.0).contains(&sum), "{sum}");
    }

    #[test]
    fn what_is_far_does_not_spread_over_what_is_sharp() {
        let focus = Focus { opening_m: 0.02, focus_m: 4.0, focal_px: 2000.0 };
        let (width, height) = (80usize, 40usize);
        let near = |pixel: usize| pixel % width < 40;
        let depth_m: Vec<f32> = (0..width * height).map(|p| if near(p) { 4.0 } else { 400.0 }).collect();
        let values: Vec<Vec3> =
            (0..width * height).map(|p| Vec3::splat(if near(p) { 0.2 } else { 3.0 })).collect();
        let out = defocused(&Light { width, values: &values, depth_m: &depth_m }, &focus);
        for (pixel, value) in out.iter().enumerate().filter(|(pixel, _)| near(*pixel)) {
            assert!((value.x - 0.2).abs() < 0.12 || pixel % width == 39, "{pixel}: {value}");
        }
    }
}
