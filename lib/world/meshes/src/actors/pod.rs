//! Round shapes along a line: tubes, pods, mudguards.

use std::f32::consts::TAU;

use crate::solids::{MeshBuilder, circle};
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::MeshPart;

/// A tube through points, with the radius at each.
pub(crate) fn tube(b: &mut MeshBuilder, part: MeshPart, line: &[(Vec3, f32)], sides: usize) {
    let last = line.len().saturating_sub(1);
    let along = |i: usize| (line[(i + 1).min(last)].0 - line[i.saturating_sub(1)].0).normalize_or(Vec3::X);
    let rings: Vec<Vec<Vec3>> = (0..line.len())
        .map(|i| {
            let axis = along(i);
            let helper = if along(0).y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
            let u = axis.cross(helper).normalize_or(Vec3::Z);
            let v = axis.cross(u);
            circle(sides).map(|(c, s)| line[i].0 + line[i].1 * (c * u + s * v)).collect()
        })
        .collect();
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// A body of upright ellipses from behind to the front: place, half width, half height.
pub(crate) fn pod(b: &mut MeshBuilder, part: MeshPart, line: &[(Vec3, f32, f32)], sides: usize) {
    let rings: Vec<Vec<Vec3>> = line
        .iter()
        .map(|(at, y, z)| circle(sides).map(|(c, s)| *at + Vec3::new(0.0, y * c, z * s)).collect())
        .collect();
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// A strip around a wheel, between angles in turns: 0 ahead, a quarter above.
pub(crate) fn mudguard(
    b: &mut MeshBuilder,
    part: MeshPart,
    axle: Vec3,
    radius: f32,
    half_width: f32,
    turns: [f32; 2],
    steps: usize,
) {
    let rings: Vec<Vec<Vec3>> = (0..=steps)
        .map(|i| {
            let (s, c) = sin_cos(TAU * (turns[0] + (turns[1] - turns[0]) * i as f32 / steps as f32));
            let out = Vec3::new(c, 0.0, s);
            [
                (radius - 0.006, 0.0),
                (radius, -1.0),
                (radius + 0.022, -0.6),
                (radius + 0.022, 0.6),
                (radius, 1.0),
            ]
            .map(|(r, y)| axle + out * r + Vec3::Y * y * half_width)
            .to_vec()
        })
        .collect();
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// A box whose edges are bevelled.
pub(crate) fn rounded(b: &mut MeshBuilder, part: MeshPart, min: Vec3, max: Vec3, bevel: f32) {
    let ring = |x: f32, inset: f32| -> Vec<Vec3> {
        let (y0, y1) = (min.y + inset, max.y - inset);
        let (z0, z1) = (min.z + inset, max.z - inset);
        [
            (y0 + bevel, z0),
            (y1 - bevel, z0),
            (y1, z0 + bevel),
            (y1, z1 - bevel),
            (y1 - bevel, z1),
            (y0 + bevel, z1),
            (y0, z1 - bevel),
            (y0, z0 + bevel),
        ]
        .map(|(y, z)| Vec3::new(x, y, z))
        .to_vec()
    };
    let rings = [ring(min.x, bevel), ring(min.x + bevel, 0.0), ring(max.x - bevel, 0.0), ring(max.x, bevel)];
    b.loft(&rings, |_, _| part, [part; 2]);
}
