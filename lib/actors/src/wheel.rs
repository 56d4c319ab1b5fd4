//! Wheels: tyre, rim with spokes, turning about y; the outer face looks to +y.

use std::sync::Arc;

use glam::Vec3;
use schema::Tag;
use schema::geometry::{Part, Surface, TriMesh};

use crate::pieces::{Joint, Piece};
use solids::{MeshBuilder, circle};

/// A car's wheel: closed, `width` wide about y = 0. 12 sides and a spoke pattern, so that its turning shows.
pub(crate) fn disc(tag: Tag, radius: f32, width: f32) -> TriMesh {
    const SIDES: usize = 12;
    let tyre = Part::new(tag, Surface::Rubber, [0.03, 0.03, 0.03]);
    let spoke = Part::new(tag, Surface::Metal, [0.62, 0.63, 0.65]);
    let gap = Part::new(tag, Surface::Metal, [0.08, 0.08, 0.09]);
    let mut b = MeshBuilder::new();
    let ring = |b: &mut MeshBuilder, r: f32, y: f32| -> Vec<u32> {
        circle(SIDES).map(|(c, s)| b.vertex(Vec3::new(r * c, y, r * s))).collect()
    };
    let half = 0.5 * width;
    let rings = [ring(&mut b, radius, -half), ring(&mut b, radius, half), ring(&mut b, 0.66 * radius, half)];
    let (tyre, spoke, gap) = (b.part_index(tyre), b.part_index(spoke), b.part_index(gap));
    let hub = b.vertex(Vec3::new(0.0, 0.8 * half, 0.0));
    let back = b.vertex(Vec3::new(0.0, -half, 0.0));
    for j in 0..SIDES {
        let n = (j + 1) % SIDES;
        b.quad(tyre, [rings[0][j], rings[1][j], rings[1][n], rings[0][n]]);
        b.quad(tyre, [rings[1][j], rings[2][j], rings[2][n], rings[1][n]]);
        b.triangle(if j % 2 == 0 { spoke } else { gap }, [rings[2][j], hub, rings[2][n]]);
        b.triangle(tyre, [rings[0][n], back, rings[0][j]]);
    }
    b.finish()
}

/// A bicycle's or motorcycle's wheel: a tyre ring with spokes one can see through.
pub(crate) fn spoked(tag: Tag, radius: f32, width: f32, spokes: usize) -> TriMesh {
    const SIDES: usize = 16;
    let tyre = Part::new(tag, Surface::Rubber, [0.03, 0.03, 0.03]);
    let metal = Part::new(tag, Surface::Metal, [0.5, 0.5, 0.52]);
    let mut b = MeshBuilder::new();
    let (half, inner) = (0.5 * width, radius - 1.4 * width.min(0.3 * radius));
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for (r, y) in [(radius, -half), (radius, half), (inner, half), (inner, -half)] {
        rings.push(circle(SIDES).map(|(c, s)| b.vertex(Vec3::new(r * c, y, r * s))).collect());
    }
    let index = b.part_index(tyre);
    for k in 0..4 {
        let (from, to) = (&rings[k], &rings[(k + 1) % 4]);
        for j in 0..SIDES {
            let n = (j + 1) % SIDES;
            b.quad(index, [from[j], to[j], to[n], from[n]]);
        }
    }
    for (c, s) in circle(spokes) {
        b.bar(metal, Vec3::ZERO, Vec3::new(c, 0.0, s) * (inner + 0.005), [0.012, 0.008], 3);
    }
    b.bar(metal, Vec3::Y * -half, Vec3::Y * half, [0.035; 2], 6);
    b.finish()
}

/// The four (or more) wheels of a vehicle: `axles` are x positions, the first one is steered.
pub(crate) fn wheels(tag: Tag, axles: &[f32], radius: f32, width: f32, outer_y: f32) -> Vec<Piece> {
    let mesh = Arc::new(disc(tag, radius, width));
    let y = outer_y - 0.5 * width;
    axles
        .iter()
        .enumerate()
        .flat_map(|(i, x)| {
            [(y, false), (-y, true)].map(|(y, right)| Piece {
                mesh: Arc::clone(&mesh),
                joint: Joint::Wheel { at: Vec3::new(*x, y, radius), steered: i == 0, right },
            })
        })
        .collect()
}
