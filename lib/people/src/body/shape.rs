//! Lofts of rounded slices, the stuff that bodies are made of.

use frames::math::f32::{pow, sin_cos};
use glam::Vec3;
use schema::geometry::Part;
use solids::MeshBuilder;

/// A horizontal slice: its height, the place it is about, and how far it reaches ahead, back and to either side.
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

    /// Its outline, counter-clockwise from above; the middle of the last side looks ahead. `square`: 1 an ellipse, less a
    /// rounder box.
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

/// A solid through slices, from the lowest up; `part(k, j)` is that of side j above slice k.
pub(crate) fn lofted(
    b: &mut MeshBuilder,
    slices: &[Slice],
    sides: usize,
    square: f32,
    part: impl Fn(usize, usize) -> Part,
) {
    let rings: Vec<Vec<Vec3>> = slices.iter().map(|s| s.outline(sides, square)).collect();
    let caps = [part(0, 0), part(slices.len().saturating_sub(2), 0)];
    b.loft(&rings, &part, caps);
}

/// The same of one part.
pub(crate) fn solid(b: &mut MeshBuilder, part: Part, slices: &[Slice], sides: usize) {
    lofted(b, slices, sides, 1.0, |_, _| part);
}
