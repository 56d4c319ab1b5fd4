//! What roads go through: cracks that were sealed, patches, stains.

use crate::textures::canvas::{Canvas, Spot, clouds};
use crate::textures::noise::{hash2, unit};
use crate::textures::texture::Texture;

/// Texels of the tile's side, which is 32 m long.
const SIDE: usize = 1024;

/// Numbers one after the other, 0 to 1.
struct Draws(i32);

impl Draws {
    fn next(&mut self) -> f32 {
        self.0 += 1;
        unit(hash2(self.0, 7, 83))
    }
}

/// 32 m of road.
pub(crate) fn wear() -> Texture {
    let mut canvas = Canvas::new(SIDE, |x, y| {
        let (large, small) = (clouds(x, y, 2.0, 31), clouds(x, y, 6.0, 32));
        Spot { height: 0.0, shade: 0.86 + 0.16 * large + 0.12 * small, tint: 0.0 }
    });
    let mut draws = Draws(0);
    for _ in 0..9 {
        patch(&mut canvas, &mut draws);
    }
    for _ in 0..26 {
        crack(&mut canvas, &mut draws);
    }
    for _ in 0..150 {
        stain(&mut canvas, &mut draws);
    }
    Texture::new(&canvas, 32.0)
}

/// A rectangle that was dug up and filled, with sealed edges.
fn patch(canvas: &mut Canvas, draws: &mut Draws) {
    let start = [0; 2].map(|_| (draws.next() * SIDE as f32) as i32);
    let size = [20.0 + 70.0 * draws.next(), 24.0 + 40.0 * draws.next()].map(|v| v as i32);
    let tone = if draws.next() > 0.3 { 0.72 + 0.12 * draws.next() } else { 1.14 };
    for y in 0..size[1] {
        for x in 0..size[0] {
            let edge = x.min(size[0] - 1 - x).min(y).min(size[1] - 1 - y);
            let spot = canvas.spot(start[0] + x, start[1] + y);
            spot.shade = spot.shade * 0.3 + 0.7 * tone;
            if edge < 2 {
                (spot.shade, spot.tint) = (0.62, 0.8);
            }
        }
    }
}

/// A crack that wanders some metres, filled with tar here, open there.
fn crack(canvas: &mut Canvas, draws: &mut Draws) {
    let [mut x, mut y] = [0; 2].map(|_| draws.next() * SIDE as f32);
    let (mut dx, mut dy) = (draws.next() - 0.5, draws.next() - 0.5);
    let steps = 60 + (260.0 * draws.next()) as i32;
    let sealed = draws.next() > 0.35;
    for _ in 0..steps {
        dx += 0.5 * (draws.next() - 0.5);
        dy += 0.5 * (draws.next() - 0.5);
        let length = (dx * dx + dy * dy).sqrt().max(1e-3);
        (dx, dy) = (dx / length, dy / length);
        (x, y) = (x + dx, y + dy);
        let (column, row) = (x.floor() as i32, y.floor() as i32);
        let (shade, tint) = if sealed { (0.55, 0.8) } else { (0.66, 0.0) };
        let spot = canvas.spot(column, row);
        (spot.shade, spot.tint) = (shade, tint);
        if sealed {
            // As wide as a hand where it was poured.
            let aside =
                canvas.spot(column + i32::from(dy.abs() > dx.abs()), row + i32::from(dy.abs() <= dx.abs()));
            (aside.shade, aside.tint) = (shade, tint);
        }
    }
}

/// A drop of oil, as large as a plate.
fn stain(canvas: &mut Canvas, draws: &mut Draws) {
    let [x, y] = [0; 2].map(|_| (draws.next() * SIDE as f32) as i32);
    let radius = 1.0 + 5.0 * draws.next() * draws.next();
    let depth = 0.12 + 0.2 * draws.next();
    let reach = radius as i32 + 1;
    for v in -reach..=reach {
        for u in -reach..=reach {
            let away = ((u * u + v * v) as f32).sqrt() / radius;
            if away < 1.0 {
                canvas.spot(x + u, y + v).shade *= 1.0 - depth * (1.0 - away * away);
            }
        }
    }
}
