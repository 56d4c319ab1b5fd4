//! Drops of rain on the glass before a lens.
//!
//! A drop is a strong lens: it shows most of what is before the camera small, upside down and mirrored, and
//! its rim is dark. It is much nearer than what the camera is set to, so that neither its edge nor its
//! picture is sharp. There is a fixed number of places where drops come and go, each at its own pace; what is
//! there at a time follows from the stream, the time and the rain alone.

use glam::Vec2;
use random::{Stream, unit_f32};
use schema::FRAME_PERIOD_S;

use super::picture::Picture;

/// Places for drops at a strength of 1 and full rain.
const PLACES: f64 = 90.0;
/// A drop stays so long, seconds.
const STAYS_S: [f32; 2] = [2.5, 8.0];
/// Radii, over the height of the picture: few are large.
const RADIUS: [f32; 2] = [0.006, 0.034];
/// Larger ones may run down, over the height of the picture; so fast, heights a second.
const RUNS_FROM: f32 = 0.015;
const RUNS: [f32; 2] = [0.12, 0.45];
/// Behind one that runs beads stay, this far apart in its radii.
const BEADS: f32 = 2.1;
/// Drops come within this time, and dry over this share of theirs.
const COMES_S: f32 = 0.1;
const DRIES: f32 = 0.25;
/// Side of the blocks that drops show the means of, pixels.
const BLOCK: usize = 8;
/// How much of the picture's height is seen in a drop, from its middle to its rim.
const SEES: f32 = 0.55;

/// Drops on one camera's glass.
#[derive(Clone, Debug)]
pub struct Drops {
    /// Times a usual number.
    strength: f64,
    stream: Stream,
}

/// One drop in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drop {
    /// Columns and rows, pixels.
    middle: Vec2,
    /// Half its width and height, pixels.
    half: Vec2,
}

/// A number between two by a share of the way.
fn between([low, high]: [f32; 2], share: f32) -> f32 {
    low + (high - low) * share
}

impl Drops {
    /// `strength` times the usual number of drops, drawn from `stream`.
    #[must_use]
    pub fn new(strength: f64, stream: Stream) -> Self {
        Self { strength, stream }
    }

    /// A picture through the glass at a frame, in rain of a strength between 0 and 1; none where the glass is
    /// dry.
    #[must_use]
    pub fn on(&self, picture: &Picture, frame: u32, rain: f32) -> Option<Picture> {
        let size = Vec2::new(picture.width as f32, picture.height as f32);
        let drops = self.at(f64::from(frame) * FRAME_PERIOD_S, rain, size);
        if drops.is_empty() {
            return None;
        }
        let blocks = Blocks::of(picture);
        let mut wet = picture.clone();
        drops.iter().for_each(|drop| refract(&mut wet, &blocks, drop));
        Some(wet)
    }

    /// The drops on a picture of a size at a time, in the order in which they lie.
    fn at(&self, time_s: f64, rain: f32, size: Vec2) -> Vec<Drop> {
        let mut drops = Vec::new();
        for place in 0..(PLACES * self.strength) as u64 {
            // In rain of which strength there are drops here, and when they come.
            let [threshold, stays, phase, _] = self.stream.at(place << 32).map(unit_f32);
            let grown = ((rain - threshold) * 10.0).clamp(0.0, 1.0);
            if grown <= 0.0 {
                continue;
            }
            let stays_s = between(STAYS_S, stays);
            let turns = time_s / f64::from(stays_s) + f64::from(phase);
            let age_s = (turns - turns.floor()) as f32 * stays_s;
            let number = turns.floor() as u64;
            let draw = |salt: u64| self.stream.at(place << 32 | (4 * number + salt + 1)).map(unit_f32);
            let [x, y, large, wide] = draw(0);
            let radius = between(RADIUS, large * large * large) * grown;
            let middle = Vec2::new(x, y) * size;
            let [runs, starts, fast, sways] = draw(1);
            let dried = ((stays_s - age_s) / (DRIES * stays_s)).clamp(0.0, 1.0).sqrt();
            let half_px = radius * size.y * (age_s / COMES_S).clamp(0.2, 1.0);
            if radius < RUNS_FROM || runs > 0.6 {
                let half = Vec2::new(between([0.85, 1.15], wide), 1.0) * (half_px * dried);
                drops.push(Drop { middle, half });
                continue;
            }
            // It hangs, then runs faster and faster down to where it is held again, and leaves beads.
            let running_s = (age_s - between([0.25, 0.6], starts) * stays_s).max(0.0);
            // By radii down: it sways a little.
            let path = |down: f32| {
                let (sway, _) = frames::math::f32::sin_cos(down * 0.35 + 6.3 * sways);
                Vec2::new(0.25 * sway, down) * half_px
            };
            let down = between(RUNS, fast) * size.y * running_s * running_s / (running_s + 0.6);
            let bead_px = BEADS * half_px;
            for bead in 0..(down / bead_px.max(1.0)).min(40.0) as u64 {
                let [small, aside, ..] =
                    draw(2 + bead % 2).map(|share| (share + 0.618 * bead as f32).fract());
                if small < 0.35 {
                    continue;
                }
                let at = path((bead as f32 + 0.8 * aside) * BEADS);
                let half = Vec2::splat(half_px * dried * between([0.02, 0.3], small));
                drops
                    .push(Drop { middle: middle + at + Vec2::new((aside - 0.5) * 0.3 * half_px, 0.0), half });
            }
            let stretched = if running_s > 0.0 { 1.35 } else { 1.1 };
            let at = path(down / half_px);
            drops.push(Drop { middle: middle + at, half: Vec2::new(0.9, stretched) * half_px });
        }
        drops.retain(|drop| drop.half.min_element() > 0.6);
        drops
    }
}

/// A picture in means of blocks.
struct Blocks {
    columns: usize,
    rows: usize,
    means: Vec<[f32; 3]>,
}

impl Blocks {
    fn of(picture: &Picture) -> Self {
        let (width, height) = (picture.width as usize, picture.height as usize);
        let (columns, rows) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
        let pixels = picture.rgb.as_chunks::<3>().0;
        let mut means = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let (mut sum, mut count) = ([0u32; 3], 0);
                for y in row * BLOCK..height.min((row + 1) * BLOCK) {
                    let start = y * width + column * BLOCK;
                    let end = y * width + width.min((column + 1) * BLOCK);
                    for pixel in &pixels[start..end] {
                        for (sum, value) in sum.iter_mut().zip(pixel) {
                            *sum += u32::from(*value);
                        }
                        count += 1;
                    }
                }
                means.push(sum.map(|sum| sum as f32 / count.max(1) as f32));
            }
        }
        Self { columns, rows, means }
    }

    /// The picture around a place, pixels; beyond its edge as at it.
    fn at(&self, place: Vec2) -> [f32; 3] {
        let q = place / BLOCK as f32 - Vec2::splat(0.5);
        let (x, y) = (q.x.clamp(0.0, (self.columns - 1) as f32), q.y.clamp(0.0, (self.rows - 1) as f32));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.columns - 1), (y0 + 1).min(self.rows - 1));
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let mean = |column: usize, row: usize| self.means[row * self.columns + column];
        let mix = |a: [f32; 3], b: [f32; 3], share: f32| [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share);
        mix(mix(mean(x0, y0), mean(x1, y0), fx), mix(mean(x0, y1), mean(x1, y1), fx), fy)
    }
}

/// Lays a drop over a picture.
fn refract(wet: &mut Picture, blocks: &Blocks, drop: &Drop) {
    let size = Vec2::new(wet.width as f32, wet.height as f32);
    // Out of focus by as much as four tenths of its width, and two pixels.
    let soft = (0.4 + 2.0 / drop.half.max_element()).min(0.9);
    let reach = drop.half * (1.0 + 0.5 * soft);
    let [first, end] =
        [drop.middle - reach, drop.middle + reach + Vec2::ONE].map(|p| p.clamp(Vec2::ZERO, size));
    let see_px = SEES * size.y;
    for y in first.y as usize..end.y as usize {
        for x in first.x as usize..end.x as usize {
            let pixel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let off = (pixel - drop.middle) / drop.half;
            let away = off.length();
            let edge = ((1.0 + 0.5 * soft - away) / soft).clamp(0.0, 1.0);
            let cover = edge * edge * (3.0 - 2.0 * edge);
            if cover <= 0.0 {
                continue;
            }
            // Steeper towards the rim, as a bulging surface is.
            let bend = 0.55 + 0.45 * away * away;
            let seen = blocks.at(drop.middle - off * (see_px * bend));
            let rim = 1.0 - 0.34 * (away * away * away).min(1.0);
            let at = 3 * (y * wet.width as usize + x);
            for (value, seen) in wet.rgb[at..at + 3].iter_mut().zip(seen) {
                let v = f32::from(*value);
                *value = (v + (seen * rim - v) * cover + 0.5) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture that is white above and black below, or red to the left.
    fn halves() -> Picture {
        let (width, height) = (320, 180);
        let colour = |i: u32| {
            if i / width < height / 2 { [255, if i % width < 160 { 0 } else { 255 }, 255] } else { [0; 3] }
        };
        let rgb = (0..width * height).flat_map(colour).collect();
        Picture { width, height, rgb, electrons: 1 }
    }

    fn drops(strength: f64, entity: u64) -> Drops {
        Drops::new(strength, Stream::new(7, 2, "sensors/test/drops", entity))
    }

    #[test]
    fn a_drop_shows_the_picture_upside_down() {
        let (before, mut wet) = (halves(), halves());
        let blocks = Blocks::of(&before);
        refract(&mut wet, &blocks, &Drop { middle: Vec2::new(160.0, 90.0), half: Vec2::splat(30.0) });
        let at = |x: usize, y: usize| &wet.rgb[3 * (320 * y + x)..][..3];
        // Dark above and light below its middle, and what is green on the right is so on the left.
        assert!(
            at(160, 75).iter().all(|v| *v < 20) && at(150, 108)[0] > 150,
            "{:?} {:?}",
            at(160, 75),
            at(150, 108)
        );
        assert!(at(148, 108)[1] > 150 && at(172, 108)[1] < 60, "{:?} {:?}", at(148, 108), at(172, 108));
        // Beyond its soft edge nothing changes.
        for (i, (a, b)) in wet.rgb.chunks(3).zip(before.rgb.chunks(3)).enumerate() {
            let away = Vec2::new((i % 320) as f32 - 159.5, (i / 320) as f32 - 89.5).length();
            assert!(away < 40.0 || a == b, "{i}");
        }
    }

    #[test]
    fn there_are_as_many_as_it_rains_and_none_when_it_is_dry() {
        let size = Vec2::new(1600.0, 900.0);
        let count = |strength: f64, rain: f32| {
            let all = (0..40).map(|k| drops(strength, k).at(3.7 * f64::from(k as u32), rain, size).len());
            all.sum::<usize>()
        };
        assert_eq!(count(1.0, 0.0), 0);
        assert_eq!(count(0.0, 1.0), 0);
        let (some, many, twice) = (count(1.0, 0.2), count(1.0, 0.9), count(2.0, 0.9));
        assert!(some > 100 && many > 3 * some && twice > many * 7 / 4, "{some} {many} {twice}");
        assert!(drops(1.0, 1).on(&halves(), 3, 0.0).is_none());
    }

    #[test]
    fn they_stay_and_go_and_run_down() {
        let size = Vec2::new(1600.0, 900.0);
        let drops = drops(1.0, 4);
        let at = |frame: u32| drops.at(f64::from(frame) * FRAME_PERIOD_S, 1.0, size);
        // From frame to frame nearly all are where they were, or a little lower; after ten seconds none is.
        let near = |a: &Drop, all: &[Drop]| {
            all.iter().any(|b| {
                (a.middle.x - b.middle.x).abs() < 9.0 && (-1.0..40.0).contains(&(b.middle.y - a.middle.y))
            })
        };
        let (first, next, later) = (at(100), at(101), at(300));
        let stay = first.iter().filter(|drop| near(drop, &next)).count();
        assert!(first.len() > 40 && stay * 100 > first.len() * 90, "{stay} of {}", first.len());
        let same = first.iter().filter(|drop| later.contains(drop)).count();
        assert!(same * 10 < first.len(), "{same}");
        let lower =
            first.iter().filter(|a| next.iter().any(|b| a.middle.x == b.middle.x && b.middle.y > a.middle.y));
        assert!(lower.count() < first.len() / 2);
        assert_eq!(first, at(100));
    }
}
