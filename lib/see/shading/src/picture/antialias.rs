//! Smooths the stairs of edges in a finished picture.
//!
//! A small form of Lottes, "FXAA" (2009): where brightness jumps, the pixel is mixed with its neighbours
//! along the edge.

use rayon::prelude::*;

use super::picture::Picture;

/// Jumps below this (of 255), or below this share of the brighter side, stay.
const LEAST_JUMP: u8 = 14;
const LEAST_SHARE: u8 = 8;

/// Smooths a picture in place.
pub(super) fn smooth_edges(picture: &mut Picture) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    if width < 3 || height < 3 {
        return;
    }
    let source = picture.rgb.clone();
    let pixels = source.as_chunks::<3>().0;
    let luma: Vec<u8> = pixels
        .iter()
        .map(|[r, g, b]| ((u32::from(*r) + 2 * u32::from(*g) + u32::from(*b)) / 4) as u8)
        .collect();
    picture.rgb.par_chunks_mut(3 * width).enumerate().skip(1).take(height - 2).for_each(|(y, row)| {
        let row = row.as_chunks_mut::<3>().0;
        let lines = [
            &luma[(y - 1) * width..y * width],
            &luma[y * width..(y + 1) * width],
            &luma[(y + 1) * width..(y + 2) * width],
        ];
        for first in (1..width - 1).step_by(STRETCH) {
            let jumps = jumps(&lines, first, STRETCH.min(width - 1 - first));
            if jumps == [false; STRETCH] {
                continue;
            }
            for x in (first..).zip(jumps).filter_map(|(x, jump)| jump.then_some(x)) {
                row[x] = smoothed(&lines, pixels, (width, height), (x, y));
            }
        }
    });
}

/// Pixels that are looked at together.
const STRETCH: usize = 32;

/// Where brightness jumps between a pixel and its neighbours, of up to [`STRETCH`] pixels of the middle line.
#[inline]
fn jumps(lines: &[&[u8]; 3], first: usize, length: usize) -> [bool; STRETCH] {
    let mut jumps = [false; STRETCH];
    // As arrays, so that it is done in wide registers; the last stretch of a row pixel by pixel.
    let take = |line: &[u8], from: usize| -> [u8; STRETCH] {
        let mut taken = [0; STRETCH];
        if length == STRETCH {
            taken.copy_from_slice(&line[from..from + STRETCH]);
        } else {
            taken[..length].copy_from_slice(&line[from..from + length]);
        }
        taken
    };
    let [up, here, down] = [take(lines[0], first), take(lines[1], first), take(lines[2], first)];
    let [left, right] = [take(lines[1], first - 1), take(lines[1], first + 1)];
    for (i, jump) in jumps.iter_mut().enumerate() {
        let high = up[i].max(left[i]).max(here[i]).max(right[i]).max(down[i]);
        let low = up[i].min(left[i]).min(here[i]).min(right[i]).min(down[i]);
        *jump = high - low >= LEAST_JUMP.max(high / LEAST_SHARE);
    }
    jumps
}

/// A pixel mixed with its neighbours along the edge that it is on; `lines` are the brightness of the rows
/// around.
fn smoothed(
    lines: &[&[u8]; 3],
    pixels: &[[u8; 3]],
    (width, height): (usize, usize),
    (x, y): (usize, usize),
) -> [u8; 3] {
    let at = |dy: usize, dx: usize| i32::from(lines[dy][x + dx - 1]);
    let cross = [at(0, 1), at(1, 0), at(1, 1), at(1, 2), at(2, 1)];
    let (high, low) = cross.iter().fold((0, 255), |(high, low), &v| (v.max(high), v.min(low)));
    let corners = [at(0, 0), at(0, 2), at(2, 0), at(2, 2)];
    // Along the edge, by the gradients of the corners.
    let dx = (corners[2] + corners[3]) - (corners[0] + corners[1]);
    let dy = (corners[0] + corners[2]) - (corners[1] + corners[3]);
    let least = dx.abs().min(dy.abs()).max(1);
    let scale = |d: i32| (d as f32 / least as f32).clamp(-6.0, 6.0);
    let length = ((dx * dx + dy * dy) as f32).sqrt().max(1.0);
    let (dx, dy) = if dx == 0 || dy == 0 {
        (2.0 * dx as f32 / length, 2.0 * dy as f32 / length)
    } else {
        (0.5 * scale(dx), 0.5 * scale(dy))
    };
    let sample = |t: f32| -> [f32; 3] {
        let (sx, sy) = (
            (x as f32 + t * dx).clamp(0.0, (width - 1) as f32 - 1e-3),
            (y as f32 + t * dy).clamp(0.0, (height - 1) as f32 - 1e-3),
        );
        let (x0, y0) = (sx as usize, sy as usize);
        let (fx, fy) = (sx - x0 as f32, sy - y0 as f32);
        let i = y0 * width + x0;
        std::array::from_fn(|c| {
            let p = |j: usize| f32::from(pixels[j][c]);
            let upper = p(i) + (p(i + 1) - p(i)) * fx;
            let lower = p(i + width) + (p(i + width + 1) - p(i + width)) * fx;
            upper + (lower - upper) * fy
        })
    };
    let (a, b) = (sample(-1.0 / 6.0), sample(1.0 / 6.0));
    let (c, d) = (sample(-0.5), sample(0.5));
    let narrow: [f32; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    let wide: [f32; 3] = std::array::from_fn(|i| 0.5 * narrow[i] + 0.25 * (c[i] + d[i]));
    let brightness = (wide[0] + 2.0 * wide[1] + wide[2]) * 0.25;
    // The wide mix may reach over another edge.
    let mixed = if brightness < low as f32 || brightness > high as f32 { narrow } else { wide };
    mixed.map(|v| (v + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_pictures_stay_and_stairs_get_middle_tones() {
        let (width, height) = (32u32, 32u32);
        let paint = |f: &dyn Fn(u32, u32) -> u8| Picture {
            width,
            height,
            rgb: (0..width * height).flat_map(|i| [f(i % width, i / width); 3]).collect(),
            electrons: 1,
        };
        let mut flat = paint(&|x, _| 100 + (x / 4) as u8);
        let before = flat.clone();
        smooth_edges(&mut flat);
        assert_eq!(flat, before, "gentle slopes are no edges");
        let mut stairs = paint(&|x, y| if 2 * y > x { 220 } else { 20 });
        smooth_edges(&mut stairs);
        let middle = stairs.rgb.iter().filter(|&&v| (40..200).contains(&v)).count();
        assert!(middle > 20, "{middle}");
    }
}
