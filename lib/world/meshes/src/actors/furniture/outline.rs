//! Prisms over outlines.

use glam::Vec3;
use schema::geometry::MeshPart;

use crate::solids::MeshBuilder;

/// An outline with its corners counter-clockwise, whichever way they were given.
fn counter_clockwise(outline: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let next = outline.iter().cycle().skip(1);
    let twice: f32 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    let mut outline = outline.to_vec();
    if twice < 0.0 {
        outline.reverse();
    }
    outline
}

/// A prism along y over an outline of `(x, z)`. Its ends are cut into a fan about the first corner, which
/// must see all others.
pub(super) fn along_y(b: &mut MeshBuilder, part: MeshPart, outline: &[[f32; 2]], [from, to]: [f32; 2]) {
    // Seen against +y, x runs to the left.
    let mut outline = counter_clockwise(outline);
    outline.reverse();
    let ring = |y: f32| -> Vec<Vec3> { outline.iter().map(|[x, z]| Vec3::new(*x, y, *z)).collect() };
    b.loft(&[ring(from), ring(to)], |_, _| part, [part; 2]);
}

/// A prism along x over an outline of `(y, z)`.
pub(super) fn along_x(b: &mut MeshBuilder, part: MeshPart, outline: &[[f32; 2]], [from, to]: [f32; 2]) {
    let outline = counter_clockwise(outline);
    let ring = |x: f32| -> Vec<Vec3> { outline.iter().map(|[y, z]| Vec3::new(x, *y, *z)).collect() };
    b.loft(&[ring(from), ring(to)], |_, _| part, [part; 2]);
}
