//! Normals for light where a file gives none: bent over edges that are less sharp than a crease.

use frames::math;
use glam::Vec3;
use schema::Normal;
use schema::geometry::TriMesh;

/// Around a vertex with more triangles than this everything is flat: such fans are no surface, and would take
/// long.
const MOST_AROUND: usize = 64;

/// Sets the normals of a mesh: those `given`, and for triangles without any the mean of the triangles around
/// each corner that turn by less than `crease_rad`, by area and by the angle at the corner, so that it does
/// not matter how quads are cut. Vertices are told apart by their place alone.
pub(crate) fn set(mesh: &mut TriMesh, given: &[Option<[Vec3; 3]>], crease_rad: f64) {
    let faces: Vec<Vec3> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            (b - a).cross(c - a)
        })
        .collect();
    let units: Vec<Vec3> = faces.iter().map(|face| face.normalize_or_zero()).collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        corners.iter().for_each(|&vertex| around[vertex as usize].push(t as u32));
    }
    let least = math::cos(crease_rad) as f32;
    let bent = |t: usize, vertex: u32| {
        let near = &around[vertex as usize];
        if near.len() > MOST_AROUND {
            return units[t];
        }
        let alike =
            near.iter().map(|&other| other as usize).filter(|&other| units[other].dot(units[t]) >= least);
        alike.map(|other| faces[other] * angle_rad(mesh, other, vertex)).sum::<Vec3>().normalize_or(units[t])
    };
    let normals: Vec<[Normal; 3]> = (0..mesh.triangles.len())
        .map(|t| {
            let normals = given[t].unwrap_or_else(|| mesh.triangles[t].map(|vertex| bent(t, vertex)));
            // What hardly bends is flat, which is cheaper to light.
            let is_flat = normals.iter().all(|n| n.dot(units[t]) > 0.9998);
            if is_flat { [Normal::new(units[t]); 3] } else { normals.map(Normal::new) }
        })
        .collect();
    let is_bent = normals.iter().any(|[a, b, c]| a != b || b != c);
    mesh.corner_normals = if is_bent { normals } else { Vec::new() };
}

/// The angle of a triangle at one of its vertices.
fn angle_rad(mesh: &TriMesh, triangle: usize, vertex: u32) -> f32 {
    let places = mesh.corners(triangle);
    let at = mesh.triangles[triangle].iter().position(|v| *v == vertex).unwrap_or(0);
    let side = |k: usize| (places[(at + k) % 3] - places[at]).normalize_or_zero();
    math::f32::acos(side(1).dot(side(2)).clamp(-1.0, 1.0))
}
