//! Light on curved surfaces: normals at the corners of triangles. Where a surface is, and where it is seen
//! from, follows its flat triangles.

use frames::math;
use glam::Vec3;
use schema::Normal;
use schema::geometry::TriMesh;

/// Bends the light over edges at which triangles of one part that share two corners turn by less than an
/// angle, given as its cosine: the normal at a corner is the mean of those of the triangles around it, by
/// area and by angle at the corner, so that however a quad is cut and however large its neighbours are, large
/// faces stay flat and the narrow ones between them are round.
pub(crate) fn smooth(mesh: &mut TriMesh, crease_cos: f32) {
    let all = 0..mesh.triangles.len();
    // Twice the area long.
    let faces: Vec<Vec3> = all
        .clone()
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            (b - a).cross(c - a)
        })
        .collect();
    let units: Vec<Vec3> = faces.iter().map(|face| face.normalize_or_zero()).collect();
    let around = Around::new(mesh);
    let normals: Vec<[Normal; 3]> = all
        .map(|t| {
            let own = units[t];
            let bent = mesh.triangles[t].map(|vertex| {
                let mut sum = Vec3::ZERO;
                for &(other, angle_rad) in around.of(vertex) {
                    let other = other as usize;
                    let is_one_part = mesh.triangle_part[other] == mesh.triangle_part[t];
                    if is_one_part && units[other].dot(own) >= crease_cos {
                        sum += faces[other] * angle_rad;
                    }
                }
                sum.normalize_or(own)
            });
            // What does not bend by a degree is flat, which is cheaper to light.
            if bent.iter().all(|n| n.dot(own) > 0.9998) {
                [Normal::new(own); 3]
            } else {
                bent.map(Normal::new)
            }
        })
        .collect();
    let is_bent = normals.iter().any(|[a, b, c]| a != b || b != c);
    mesh.corner_normals = if is_bent { normals } else { Vec::new() };
}

/// The triangles around each vertex, with their angles there in radians.
struct Around {
    /// Where the list of each vertex begins, and the end.
    first: Vec<u32>,
    triangles: Vec<(u32, f32)>,
}

impl Around {
    fn new(mesh: &TriMesh) -> Self {
        let mut first = vec![0u32; mesh.positions.len() + 1];
        for &vertex in mesh.triangles.iter().flatten() {
            first[vertex as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let mut triangles = vec![(0, 0.0); 3 * mesh.triangles.len()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let places = mesh.corners(t);
            for (i, &vertex) in corners.iter().enumerate() {
                let side = |j: usize| (places[(i + j) % 3] - places[i]).normalize_or_zero();
                let cos = side(1).dot(side(2)).clamp(-1.0, 1.0);
                let slot = &mut next[vertex as usize];
                triangles[*slot as usize] = (t as u32, math::f32::acos(cos));
                *slot += 1;
            }
        }
        Self { first, triangles }
    }

    fn of(&self, vertex: u32) -> &[(u32, f32)] {
        let vertex = vertex as usize;
        &self.triangles[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use schema::Tag;
    use schema::geometry::{MeshPart, Surface};

    use super::*;

    /// An open tube of unit radius along z, and where its corners are.
    fn tube(sides: usize) -> TriMesh {
        let mut mesh = TriMesh::default();
        let part = mesh.part_index(MeshPart::new(Tag::Car, Surface::Paint, [0.5; 3]));
        for j in 0..sides {
            let (s, c) = math::f32::sin_cos(std::f32::consts::TAU * j as f32 / sides as f32);
            mesh.add_vertex(Vec3::new(c, s, 0.0));
            mesh.add_vertex(Vec3::new(c, s, 1.0));
        }
        for j in 0..sides {
            let [a, b] = [j, (j + 1) % sides].map(|j| 2 * j as u32);
            mesh.add_triangle(part, [a, b, b + 1]);
            mesh.add_triangle(part, [a, b + 1, a + 1]);
        }
        mesh
    }

    #[test]
    fn a_tube_is_round_and_a_cube_is_not() {
        let mut round = tube(12);
        smooth(&mut round, 0.8);
        for t in 0..round.triangles.len() {
            let normals = round.bent(t).expect("is bent");
            for (corner, normal) in round.corners(t).into_iter().zip(normals) {
                // However the quads are cut, the normal of a tube is its radius.
                assert!(normal.dot(Vec3::new(corner.x, corner.y, 0.0)) > 0.999_99, "{corner} {normal}");
            }
        }
        let mut square = tube(4);
        smooth(&mut square, 0.8);
        assert!(square.corner_normals.is_empty() && square.bent(0).is_none());
        // Of two parts each keeps to itself: half a tube ends as the plane of its last quad does.
        let mut halves = tube(12);
        let other = halves.part_index(MeshPart::new(Tag::Car, Surface::Glass, [0.1; 3]));
        halves.triangle_part[..12].fill(other);
        smooth(&mut halves, 0.8);
        let [first, ..] = halves.bent(0).expect("is bent");
        let flat = {
            let [a, b, c] = halves.corners(0);
            (b - a).cross(c - a).normalize()
        };
        assert!(first.dot(flat) > 0.999, "{first} {flat}");
    }

    #[test]
    fn large_faces_stay_flat_between_narrow_bevels() {
        // A roof 2 m wide, a bevel of 5 cm at 30 degrees beside it.
        let mut mesh = TriMesh::default();
        let part = mesh.part_index(MeshPart::new(Tag::Car, Surface::Paint, [0.5; 3]));
        let drop = 0.05 * 0.577_35;
        for (y, z) in [(-1.0, 0.0), (1.0, 0.0), (1.05, -drop)] {
            mesh.add_vertex(Vec3::new(0.0, y, z));
            mesh.add_vertex(Vec3::new(3.0, y, z));
        }
        for [a, b] in [[0, 2], [2, 4]] {
            mesh.add_triangle(part, [a, a + 1, b + 1]);
            mesh.add_triangle(part, [a, b + 1, b]);
        }
        smooth(&mut mesh, 0.5);
        assert!(mesh.bent(0).is_none_or(|normals| normals.iter().all(|n| n.z > 0.9995)));
        let bevel = mesh.bent(2).expect("is bent");
        assert!(bevel.iter().any(|n| n.z > 0.999) && bevel.iter().any(|n| n.z < 0.88), "{bevel:?}");
    }
}
