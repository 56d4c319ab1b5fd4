//! What all things are made of.

use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::solids::{Detail, MeshBuilder};

/// A part of what stands still.
pub(super) const fn still(surface: Surface, rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::Static, surface, rgb)
}

/// A part of what somebody moves now and then.
pub(super) const fn loose(surface: Surface, rgb: [f32; 3]) -> MeshPart {
    MeshPart::new(Tag::Dynamic, surface, rgb)
}

pub(super) const STEEL: MeshPart = still(Surface::Metal, [0.34, 0.35, 0.36]);
pub(super) const DARK_STEEL: MeshPart = still(Surface::Metal, [0.09, 0.095, 0.10]);
pub(super) const BLACK: MeshPart = still(Surface::Plain, [0.025; 3]);
pub(super) const CONCRETE: MeshPart = still(Surface::Concrete, [0.40, 0.39, 0.37]);

/// One of some by number.
pub(super) fn pick<T: Copy>(all: &[T], variant: u32) -> T {
    all[variant as usize % all.len()]
}

/// A box by its middle in plan, its half sides and its heights.
pub(super) fn block(
    b: &mut MeshBuilder,
    part: MeshPart,
    [x, y]: [f32; 2],
    half: [f32; 2],
    [low, high]: [f32; 2],
) {
    let (a, c) = (Vec3::new(x - half[0], y - half[1], low), Vec3::new(x + half[0], y + half[1], high));
    b.cuboid(part, a, c);
}

/// A round upright body about an axis: `(height, radius)` from the ground up.
pub(super) fn turned(
    b: &mut MeshBuilder,
    part: MeshPart,
    [x, y]: [f32; 2],
    profile: &[(f32, f32)],
    sides: usize,
) {
    let sides = if b.detail() == Detail::Full { sides } else { sides.div_ceil(2).max(5) };
    let layers: Vec<(Vec3, f32, f32)> = profile.iter().map(|(z, r)| (Vec3::new(x, y, *z), *r, *r)).collect();
    b.stack(part, &layers, sides);
}
