//! What grows: grass, bark, leaves.

use crate::textures::canvas::{Canvas, Spot, clouds, smooth};
use crate::textures::noise::{hash2, unit};
use crate::textures::texture::Texture;

/// Numbers of the `k`-th piece, 0 to 1.
fn draw<const N: usize>(k: i32, seed: u32) -> [f32; N] {
    std::array::from_fn(|i| unit(hash2(k, i as i32, seed)))
}

/// A direction of the plane by a share of a whole turn (not of even density).
fn direction(turn: f32) -> [f32; 2] {
    let side = |t: f32| 1.0 - 4.0 * (t - t.floor() - 0.5).abs();
    let (x, y) = (side(turn), side(turn + 0.25));
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

/// Blades of 3 to 8 cm over soil, the later the higher.
pub(crate) fn grass() -> Texture {
    let mut canvas = Canvas::new(512, |x, y| {
        let soil = clouds(x, y, 2.0, 21);
        Spot { height: 0.0, shade: 0.25 + 0.2 * soil, tint: 0.5 }
    });
    const BLADES: i32 = 14_000;
    for k in 0..BLADES {
        let [x, y, turn, length, tone, dry] = draw(k, 61);
        let [dx, dy] = direction(turn);
        let steps = 8.0 + 12.0 * length;
        let tint = if dry > 0.86 { 1.0 } else { 0.25 * dry };
        let rise = k as f32 / BLADES as f32;
        for step in 0..steps as i32 {
            let along = step as f32 / steps;
            let at = |start: f32, d: f32| (start * 512.0 + d * step as f32).floor() as i32;
            let shade = (0.4 + 0.45 * rise + 0.5 * along) * (0.6 + 0.7 * tone);
            let spot = Spot { height: 1.5 * rise + along, shade, tint };
            *canvas.spot(at(x, dx), at(y, dy)) = spot;
            if along < 0.7 {
                *canvas.spot(at(x, dx) + 1, at(y, dy)) = Spot { shade: 0.9 * shade, ..spot };
            }
        }
    }
    Texture::new(&canvas, 256.0)
}

/// Even noise with so many lattice cells across and along a tile: 0 to 1.
fn streaks(x: f32, y: f32, cells: [i32; 2], seed: u32) -> f32 {
    let (x, y) = (x * cells[0] as f32, y * cells[1] as f32);
    let (column, row) = (x.floor(), y.floor());
    let at = |right: i32, down: i32| {
        let [c, r] = [column as i32 + right, row as i32 + down];
        unit(hash2(c.rem_euclid(cells[0]), r.rem_euclid(cells[1]), seed))
    };
    let (across, along) = (smooth(0.0, 1.0, x - column), smooth(0.0, 1.0, y - row));
    let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
    mix(mix(at(0, 0), at(1, 0), across), mix(at(0, 1), at(1, 1), across), along)
}

/// Furrows that part and meet again, some 4 cm apart and five times as long, with finer ones between them.
pub(crate) fn bark() -> Texture {
    let canvas = Canvas::new(256, |x, y| {
        let bend = (clouds(x, y, 1.0, 23) - 0.5) * 0.03;
        // Where stretched noise passes its mean there is a furrow.
        let [coarse, fine] = [([32, 5], 67, 0.24), ([60, 13], 68, 0.3)]
            .map(|(cells, seed, wide)| smooth(0.0, wide, (streaks(x + bend, y, cells, seed) - 0.5).abs()));
        let (plate, rough) = (streaks(x, y, [9, 4], 69), clouds(x, y, 3.0, 24));
        let top = coarse * (0.7 + 0.3 * fine);
        Spot {
            height: 1.2 * top + 0.5 * rough,
            shade: (0.6 + 0.4 * top) * (0.8 + 0.35 * plate) * (0.85 + 0.3 * rough),
            tint: 0.0,
        }
    });
    Texture::new(&canvas, 256.0)
}

/// Leaves of 6 to 12 cm that overlap, lighter towards the upper ones, each tilted its own way.
pub(crate) fn leaves() -> Texture {
    let mut canvas =
        Canvas::new(256, |x, y| Spot { height: 0.0, shade: 0.2 + 0.2 * clouds(x, y, 1.0, 25), tint: 0.0 });
    const LEAVES: i32 = 900;
    for k in 0..LEAVES {
        let [x, y, turn, size, tone, yellow, tilt] = draw(k, 71);
        let [dx, dy] = direction(turn);
        let (half_long, half_wide) = (4.0 + 3.5 * size, 2.2 + 1.6 * size);
        let rise = k as f32 / LEAVES as f32;
        let reach = half_long as i32 + 1;
        for v in -reach..=reach {
            for u in -reach..=reach {
                let (long, wide) = (u as f32 * dx + v as f32 * dy, v as f32 * dx - u as f32 * dy);
                // Pointed: narrower towards the ends.
                let room = half_wide * (1.0 - (long / half_long) * (long / half_long));
                if wide.abs() > room {
                    continue;
                }
                let rib = if wide.abs() < 0.6 { 1.18 } else { 1.0 };
                *canvas.spot((x * 256.0) as i32 + u, (y * 256.0) as i32 + v) = Spot {
                    height: 2.0 * rise + (tilt - 0.5) * long + 0.3 * wide.abs(),
                    shade: (0.35 + 0.65 * rise) * (0.7 + 0.6 * tone) * rib,
                    tint: if yellow > 0.9 { 1.0 } else { 0.4 * yellow },
                };
            }
        }
    }
    Texture::new(&canvas, 128.0)
}
