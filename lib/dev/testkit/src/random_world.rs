//! Random shapes: loose triangles, grids and lumpy balls at random places.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use random::Stream;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

/// A number between two others.
pub fn uniform(stream: &mut Stream, low: f32, high: f32) -> f32 {
    stream.uniform(low.into(), high.into()) as f32
}

/// A point in a cube of twice `size` around the origin.
pub fn point(stream: &mut Stream, size: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| uniform(stream, -size, size)))
}

/// A pose at such a point, turned anyhow.
pub fn pose(stream: &mut Stream, size: f32) -> Affine3A {
    let q: [f32; 4] = std::array::from_fn(|_| uniform(stream, -1.0, 1.0));
    let rotation = Quat::from_xyzw(q[0], q[1], q[2], q[3] + 2.0).normalize();
    Affine3A::from_rotation_translation(rotation, point(stream, size))
}

/// A mesh of one surface.
#[must_use]
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, surface: Surface) -> Arc<TriMesh> {
    let part = MeshPart { tag: Tag::Building, surface, rgb: [0.5; 3] };
    Arc::new(TriMesh {
        triangle_part: vec![0; triangles.len()],
        positions,
        triangles,
        parts: vec![part],
        ..TriMesh::default()
    })
}

/// Unconnected triangles of about `size` in a cube of twice `spread`.
pub fn soup(stream: &mut Stream, count: usize, spread: f32, size: f32) -> Arc<TriMesh> {
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = point(stream, spread);
        positions.extend((0..3).map(|_| centre + point(stream, size)));
    }
    loose(positions)
}

/// The same, but of every third triangle all corners are nearly on a line.
pub fn soup_with_slivers(stream: &mut Stream, count: usize, spread: f32, size: f32) -> Arc<TriMesh> {
    let mut positions = Vec::new();
    for number in 0..count {
        let centre = point(stream, spread);
        let thin = if number % 3 == 0 { 1e-4 } else { 1.0 };
        let along = point(stream, size);
        positions.extend([centre, centre + along, centre + along * 0.5 + point(stream, size) * thin]);
    }
    loose(positions)
}

fn loose(positions: Vec<Vec3>) -> Arc<TriMesh> {
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh(positions, triangles, Surface::Plain)
}

/// A closed, lumpy ball of `2 * rings * sectors` triangles.
pub fn ball(stream: &mut Stream, rings: u32, sectors: u32, radius: f32) -> Arc<TriMesh> {
    let mut positions = vec![Vec3::Z * radius, -Vec3::Z * radius];
    for ring in 1..=rings {
        for sector in 0..sectors {
            let (s, c) = frames::math::f32::sin_cos(std::f32::consts::PI * ring as f32 / (rings + 1) as f32);
            let (y, x) = frames::math::f32::sin_cos(std::f32::consts::TAU * sector as f32 / sectors as f32);
            positions.push(Vec3::new(s * x, s * y, c) * (radius * uniform(stream, 0.9, 1.1)));
        }
    }
    let at = |ring: u32, sector: u32| 2 + ring * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(0, s), at(0, s + 1)]);
        triangles.push([1, at(rings - 1, s + 1), at(rings - 1, s)]);
        for r in 1..rings {
            triangles.push([at(r - 1, s), at(r, s), at(r, s + 1)]);
            triangles.push([at(r - 1, s), at(r, s + 1), at(r - 1, s + 1)]);
        }
    }
    mesh(positions, triangles, Surface::Plain)
}

/// A flat grid of `2 * n * n` triangles in z = 0, from `-half` to `half`, whose neighbours share edges.
#[must_use]
pub fn grid(n: u32, half: f32, surface: Surface) -> Arc<TriMesh> {
    let step = 2.0 * half / n as f32;
    let positions = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| Vec3::new(i as f32 * step - half, j as f32 * step - half, 0.0)))
        .collect();
    let triangles = (0..n)
        .flat_map(|i| (0..n).map(move |j| i * (n + 1) + j))
        .flat_map(|k| [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]])
        .collect();
    mesh(positions, triangles, surface)
}
