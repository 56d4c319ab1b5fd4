//! Glare: a lens scatters some of the light over the picture; of what is brighter than white, that is seen.

use glam::Vec3;
use rayon::prelude::*;
use simd::{LANES, Vec3x8};

use super::film::Film;
use super::picture::Picture;

/// Side of a block of pixels, over which bright light is added up.
pub(super) const BLOCK: usize = 8;
/// Film values up to this are no glare, and no pixel counts for more than so much beyond it.
const WHITE: f32 = 1.0;
const MOST_OVER: f32 = 60.0;
/// Scattered light falls off in three steps: reach in blocks of a box that is laid over three times, and
/// share.
const SPREADS: [(usize, f32); 3] = [(1, 0.45), (4, 0.30), (14, 0.25)];
/// What a lamp scatters close around it: half as wide as this share of the picture, and so many times as
/// far at most.
const CORE: f32 = 1.0 / 360.0;
const CORES: f32 = 11.0;
/// Less than this, as film value, is not seen.
const LEAST: f32 = 0.001;

/// Columns of blocks in a row of pixels.
pub(super) fn blocks(width: usize) -> usize {
    width.div_ceil(BLOCK)
}

/// Adds what is brighter than white in the first of eight pixels from a column on to the blocks of their row.
#[inline]
pub(super) fn gather(value: &Vec3x8, column: usize, pixels: usize, row: &mut [Vec3]) {
    let over = |v: simd::F32x8| v.simd_gt(WHITE).any();
    if !(over(value.x) || over(value.y) || over(value.z)) {
        return;
    }
    for i in 0..pixels.min(LANES) {
        gather_one(value.lane(i), column + i, row);
    }
}

/// The same of one pixel.
#[inline]
pub(super) fn gather_one(value: Vec3, column: usize, row: &mut [Vec3]) {
    row[column / BLOCK] += (value - Vec3::splat(WHITE)).clamp(Vec3::ZERO, Vec3::splat(MOST_OVER));
}

/// A lamp that is smaller than a pixel, or not much larger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Halo {
    /// Where it is in the picture, pixels.
    pub(super) x: f32,
    pub(super) y: f32,
    /// Film values of all its pixels together.
    pub(super) film: Vec3,
}

impl Halo {
    /// Adds the part of it that is closest around to a row of pixels. Round: a fall with the fourth power of
    /// the distance, which ends softly.
    fn add_core(&self, (y, row): (usize, &mut [Vec3]), share: f32) {
        let core_px = (CORE * row.len() as f32).max(1.0);
        let reach_px = CORES * core_px;
        let off = y as f32 + 0.5 - self.y;
        let across = reach_px * reach_px - off * off;
        if across <= 0.0 {
            return;
        }
        let half = across.sqrt();
        let from = (self.x - half).max(0.0) as usize;
        let end = ((self.x + half).max(0.0) as usize + 1).min(row.len());
        let most = self.film * (share / (std::f32::consts::PI * core_px * core_px));
        for (x, to) in (from..).zip(&mut row[from.min(end)..end]) {
            let aside = x as f32 + 0.5 - self.x;
            let r2 = aside * aside + off * off;
            let fall = 1.0 / (1.0 + r2 / (core_px * core_px));
            let left = (1.0 - r2 / (reach_px * reach_px)).max(0.0);
            *to += most * (fall * fall * left * left);
        }
    }

    /// Adds it to the four blocks around it.
    fn add_to_blocks(&self, over: &mut [Vec3], [columns, rows]: [usize; 2]) {
        let place = [(self.x, columns), (self.y, rows)].map(|(v, end)| {
            let at = (v / BLOCK as f32 - 0.5).clamp(0.0, (end - 1) as f32);
            let first = (at as usize).min(end - 1);
            [(first, 1.0 - (at - first as f32)), ((first + 1).min(end - 1), at - first as f32)]
        });
        for (row, up) in place[1] {
            for (column, right) in place[0] {
                over[row * columns + column] += self.film * (up * right / (BLOCK * BLOCK) as f32);
            }
        }
    }
}

/// Spreads a share of what was gathered (row by row of pixels), and of lamps, over a picture.
pub(super) fn bloom(picture: &mut Picture, film: &Film, (gathered, halos): (&[Vec3], &[Halo]), share: f32) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let columns = blocks(width);
    if share <= 0.0 || (halos.is_empty() && gathered.iter().all(|v| *v == Vec3::ZERO)) {
        return;
    }
    let rows = height.div_ceil(BLOCK);
    let mut over = vec![Vec3::ZERO; columns * rows];
    for (y, row) in gathered.chunks(columns).enumerate() {
        let sums = &mut over[y / BLOCK * columns..][..columns];
        sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += *v / (BLOCK * BLOCK) as f32);
    }
    let mut glare = vec![Vec3::ZERO; columns * rows];
    for (step, (reach, part)) in SPREADS.into_iter().enumerate() {
        if step == 1 {
            // What lamps scatter less far is finer than blocks.
            halos.iter().for_each(|halo| halo.add_to_blocks(&mut over, [columns, rows]));
        }
        let mut blurred = over.clone();
        for _ in 0..3 {
            blurred = boxed(&blurred, columns, reach);
            blurred = turned(&boxed(&turned(&blurred, columns), rows, reach), rows);
        }
        glare.iter_mut().zip(&blurred).for_each(|(sum, v)| *sum += *v * (share * part));
    }
    let values = film.values();
    picture.rgb.par_chunks_mut(3 * width).enumerate().for_each(|(y, row)| {
        let glare = Rows::at(&glare, columns, y);
        let mut cores = vec![Vec3::ZERO; if halos.is_empty() { 0 } else { width }];
        halos.iter().for_each(|halo| halo.add_core((y, &mut cores), share * SPREADS[0].1));
        let core = |x: usize| cores.get(x).copied().unwrap_or_default();
        for (block, pixels) in row.as_chunks_mut::<3>().0.chunks_mut(BLOCK).enumerate() {
            let first = block * BLOCK;
            let has_core = || (first..first + BLOCK).any(|x| core(x).max_element() > LEAST);
            if glare.most(block) < LEAST && !has_core() {
                continue;
            }
            for (x, pixel) in (first..).zip(pixels) {
                let more = (glare.of(x) + core(x)).to_array();
                *pixel = std::array::from_fn(|k| film.code(values[usize::from(pixel[k])] + more[k]));
            }
        }
    });
}

/// Means over `2 reach + 1` neighbours in a row; beyond its ends there is nothing.
fn boxed(values: &[Vec3], columns: usize, reach: usize) -> Vec<Vec3> {
    let mut out = Vec::with_capacity(values.len());
    let per = 1.0 / (2 * reach + 1) as f32;
    for row in values.chunks(columns) {
        let mut sum: Vec3 = row.iter().take(reach).sum();
        for x in 0..columns {
            sum += row.get(x + reach).copied().unwrap_or_default();
            out.push(sum * per);
            if x >= reach {
                sum -= row[x - reach];
            }
            // What rounding leaves of nothing.
            sum = sum.max(Vec3::ZERO);
        }
    }
    out
}

/// Rows as columns.
fn turned(values: &[Vec3], columns: usize) -> Vec<Vec3> {
    let rows = values.len() / columns;
    (0..columns).flat_map(|x| (0..rows).map(move |y| values[y * columns + x])).collect()
}

/// The two rows of blocks whose middles a row of pixels lies between.
struct Rows<'a> {
    upper: &'a [Vec3],
    lower: &'a [Vec3],
    share: f32,
}

impl<'a> Rows<'a> {
    fn at(glare: &'a [Vec3], columns: usize, y: usize) -> Self {
        let last = glare.len() / columns - 1;
        let place = ((y as f32 + 0.5) / BLOCK as f32 - 0.5).clamp(0.0, last as f32);
        let first = (place as usize).min(last);
        let row = |r: usize| &glare[r * columns..(r + 1) * columns];
        Self { upper: row(first), lower: row((first + 1).min(last)), share: place - first as f32 }
    }

    fn block(&self, column: usize) -> Vec3 {
        self.upper[column].lerp(self.lower[column], self.share)
    }

    fn most(&self, block: usize) -> f32 {
        let near = block.saturating_sub(1)..(block + 2).min(self.upper.len());
        near.map(|b| self.block(b).max_element()).fold(0.0, f32::max)
    }

    fn of(&self, x: usize) -> Vec3 {
        let last = self.upper.len() - 1;
        let place = ((x as f32 + 0.5) / BLOCK as f32 - 0.5).clamp(0.0, last as f32);
        let first = (place as usize).min(last);
        self.block(first).lerp(self.block((first + 1).min(last)), place - first as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark(width: u32, height: u32) -> Picture {
        Picture { width, height, rgb: vec![40; 3 * (width * height) as usize], electrons: 1000 }
    }

    /// A lamp of 4 x 4 pixels, film value 50, red.
    fn lamp(width: usize, height: usize, at: (usize, usize)) -> Vec<Vec3> {
        let mut gathered = vec![Vec3::ZERO; blocks(width) * height];
        for y in at.1..at.1 + 4 {
            let row = &mut gathered[y * blocks(width)..][..blocks(width)];
            gather(&Vec3x8::splat(Vec3::new(50.0, 0.5, 0.5)), at.0, 4, row);
        }
        gathered
    }

    #[test]
    fn lamps_glow_round_and_less_with_distance() {
        let film = Film::new();
        let (width, height) = (640usize, 480usize);
        let mut picture = dark(640, 480);
        let gathered = lamp(width, height, (318, 238));
        assert_eq!(gathered.iter().sum::<Vec3>(), Vec3::new(16.0 * 49.0, 0.0, 0.0));
        bloom(&mut picture, &film, (&gathered, &[]), 0.03);
        let red = |x: usize, y: usize| picture.rgb[3 * (y * width + x)];
        let falling = [0, 12, 24, 60, 140].map(|d| red(320 + d, 240));
        assert!(falling[..4].windows(2).all(|w| w[0] > w[1]), "{falling:?}");
        assert!(falling[0] > 46 && falling[4] == 40, "{falling:?}");
        // As far to any side, and in its own colour alone.
        for (x, y) in [(296, 240), (344, 240), (320, 216), (320, 264)] {
            assert!(red(x, y).abs_diff(red(344, 240)) <= 3, "{x} {y}");
        }
        assert!(picture.rgb.chunks(3).all(|p| p[1] == 40 && p[2] == 40));
    }

    #[test]
    fn what_is_scattered_is_the_share_that_was_asked_for() {
        let film = Film::new();
        let (width, height) = (1600usize, 1200usize);
        let mut picture = dark(1600, 1200);
        // Broad and bright, so that steps of 8 bits average out.
        let mut gathered = vec![Vec3::ZERO; blocks(width) * height];
        for y in 560..640 {
            for x in (760..840).step_by(8) {
                gather(
                    &Vec3x8::splat(Vec3::splat(3.0)),
                    x,
                    8,
                    &mut gathered[y * blocks(width)..][..blocks(width)],
                );
            }
        }
        bloom(&mut picture, &film, (&gathered, &[]), 0.05);
        let values = film.values();
        let more: f64 = picture.rgb.iter().map(|&v| f64::from(values[usize::from(v)] - values[40])).sum();
        let want = 0.05 * 2.0 * 80.0 * 80.0 * 3.0;
        assert!((more / want - 1.0).abs() < 0.15, "{more} {want}");
    }

    #[test]
    fn a_lamp_glows_round_wherever_it_is_in_its_pixel() {
        let mut sums = Vec::new();
        for (x, y) in [(200.0, 150.0), (200.3, 150.9), (203.5, 146.5)] {
            let halo = Halo { x, y, film: Vec3::new(1000.0, 0.0, 0.0) };
            let mut rows = vec![vec![Vec3::ZERO; 400]; 300];
            rows.iter_mut().enumerate().for_each(|(y, row)| halo.add_core((y, row), 0.5));
            // As far to either side; nothing beyond its end.
            let at = |dx: f32, dy: f32| rows[(y + dy) as usize][(x + dx) as usize].x;
            if x == 200.0 {
                assert!(
                    (at(-6.0, 0.0) - at(5.0, 0.0)).abs() < 1e-3 && (at(0.0, 5.0) - at(5.0, 0.0)).abs() < 1e-3
                );
            }
            assert!(at(0.0, 0.0) > 4.0 * at(6.0, 0.0) && at(14.0, 0.0) == 0.0, "{}", at(14.0, 0.0));
            sums.push(rows.iter().flatten().map(|v| f64::from(v.x)).sum::<f64>());
        }
        // The integral of 1 / (1 + r2)2 is pi; its end takes some hundredths.
        assert!(sums.iter().all(|sum| (460.0..505.0).contains(sum)), "{sums:?}");
        let mut blocks = vec![Vec3::ZERO; 50 * 38];
        Halo { x: 203.5, y: 146.5, film: Vec3::X * 64.0 }.add_to_blocks(&mut blocks, [50, 38]);
        assert!((blocks.iter().map(|v| v.x).sum::<f32>() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn nothing_bright_changes_nothing() {
        let (mut picture, film) = (dark(100, 60), Film::new());
        let before = picture.clone();
        let mut gathered = vec![Vec3::ZERO; blocks(100) * 60];
        gather(&Vec3x8::splat(Vec3::splat(0.99)), 0, 8, &mut gathered[..blocks(100)]);
        bloom(&mut picture, &film, (&gathered, &[]), 0.5);
        assert_eq!(picture, before);
    }
}
