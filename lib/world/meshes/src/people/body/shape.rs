//! Lofts of rounded slices, the stuff that bodies are made of.

use crate::solids::MeshBuilder;
use frames::math::f32::{pow, sin_cos};
use glam::Vec3;
use schema::geometry::MeshPart;

/// A horizontal slice: its height, the place it is about, and how far it reaches ahead, back and to either
/// side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slice {
    pub(crate) z: f32,
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) front: f32,
    pub(crate) back: f32,
    pub(crate) half: f32,
}

/// A slice about the bone's axis.
pub(crate) fn slice(z: f32, front: f32, back: f32, half: f32) -> Slice {
    Slice { z, x: 0.0, y: 0.0, front, back, half }
}

/// A round slice about the bone's axis.
pub(crate) fn round(z: f32, radius: f32) -> Slice {
    slice(z, radius, radius, radius)
}

impl Slice {
    pub(crate) fn at(self, x: f32, y: f32) -> Self {
        Self { x, y, ..self }
    }

    /// The same, larger by a factor across.
    pub(crate) fn wider(self, by: f32) -> Self {
        Self { front: by * self.front, back: by * self.back, half: by * self.half, ..self }
    }

    /// How far it is off the straight way between two others, metres.
    fn off(&self, low: &Self, high: &Self) -> f32 {
        let w = if high.z == low.z { 0.0 } else { (self.z - low.z) / (high.z - low.z) };
        let [mine, a, b] = [self, low, high].map(|s| [s.x + s.front, s.x - s.back, s.half, s.y]);
        let off = |k: usize| (mine[k] - (a[k] + w * (b[k] - a[k]))).abs();
        [0, 1, 2, 3].map(off).into_iter().fold(0.0, f32::max)
    }

    /// Its outline, counter-clockwise from above; the middle of the last side looks ahead. `square`: 1 an
    /// ellipse, less a rounder box.
    fn outline(&self, sides: usize, square: f32) -> Vec<Vec3> {
        let bent = |v: f32| v.signum() * if square < 1.0 { pow(v.abs(), square) } else { v.abs() };
        (0..sides)
            .map(|j| {
                let (s, c) = sin_cos((j as f32 + 0.5) * std::f32::consts::TAU / sides as f32);
                let (c, s) = (bent(c), bent(s));
                let reach = if c > 0.0 { self.front } else { self.back };
                Vec3::new(self.x + c * reach, self.y + s * self.half, self.z)
            })
            .collect()
    }
}

/// A solid through slices, from the lowest up; `part(k, j)` is that of side j above slice k. Of less detail,
/// it has fewer slices and sides, and those are so much farther out that it is as thick.
pub(crate) fn lofted(
    b: &mut MeshBuilder,
    slices: &[Slice],
    sides: usize,
    square: f32,
    part: impl Fn(usize, usize) -> MeshPart,
) {
    let fewer = b.detail().sides(sides);
    let area = |n: usize| n as f32 * sin_cos(std::f32::consts::TAU / n as f32).0;
    let by = if fewer < sides { (area(sides) / area(fewer)).sqrt() } else { 1.0 };
    let kept = worth(slices, b.detail().tolerance_m());
    let rings: Vec<Vec<Vec3>> = kept.iter().map(|k| slices[*k].wider(by).outline(fewer, square)).collect();
    let side = |j: usize| ((j + 1) * sides + fewer / 2) / fewer % sides;
    let caps = [part(0, 0), part(slices.len().saturating_sub(2), 0)];
    b.loft(&rings, |k, j| part(kept[k], (side(j) + sides - 1) % sides), caps);
}

/// The slices without which a solid would be farther off than a tolerance: first and last, and between two
/// the one that is farthest off (Douglas and Peucker 1973).
fn worth(slices: &[Slice], tolerance_m: f32) -> Vec<usize> {
    let mut kept = vec![0];
    let mut ends = vec![slices.len().saturating_sub(1)];
    while let Some(last) = ends.last().copied() {
        let first = kept[kept.len() - 1];
        let off = |k: usize| slices[k].off(&slices[first], &slices[last]);
        let farthest = (first + 1..last).max_by(|a, b| off(*a).total_cmp(&off(*b)));
        match farthest.filter(|k| off(*k) >= tolerance_m) {
            Some(k) => ends.push(k),
            None => {
                kept.push(last);
                ends.pop();
            }
        }
    }
    kept.dedup();
    kept
}

/// The same of one part.
pub(crate) fn solid(b: &mut MeshBuilder, part: MeshPart, slices: &[Slice], sides: usize) {
    lofted(b, slices, sides, 1.0, |_, _| part);
}
