//! A bent skin in rigid pieces: one for each bone, closed where it was cut.

use std::collections::BTreeMap;

use glam::{DVec3, Vec2};
use meshes::people::{Bone, Side};

use crate::body::Body;
use crate::triangle_soup::Triangle;

/// How far a cut bulges, as a share of its radius: joints that bend do not open. Feet would stick into the
/// ground.
const BULGE: f64 = 0.4;

/// The triangles of each bone in its frame.
///
/// A triangle belongs to each bone that holds a corner of it, so that pieces overlap at joints; below the
/// knees to the lowest alone, so that nothing of a shin that leans, or of a foot whose heel is up, is below
/// the ground. What hangs on a foot is its toes' where it is ahead of their hinge.
pub(crate) fn pieces(body: &Body, triangles: &[Triangle]) -> Vec<(Bone, Vec<Triangle>)> {
    let mut ids: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut edges: BTreeMap<[u32; 2], u16> = BTreeMap::new();
    let mut whole: Vec<([u32; 3], u16)> = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let corners = triangle.corners_m.map(|corner| {
            // Adding 0 makes one zero of two.
            let key = (corner + DVec3::ZERO).to_array().map(f64::to_bits);
            let next = ids.len() as u32;
            *ids.entry(key).or_insert(next)
        });
        let owners = owners(body, triangle);
        for k in 0..3 {
            *edges.entry([corners[k], corners[(k + 1) % 3]]).or_default() |= owners;
        }
        whole.push((corners, owners));
    }
    let mut made = Vec::new();
    for bone in Bone::BODY {
        let own = 1_u16 << bone as u32;
        let mut piece: Vec<Triangle> = Vec::new();
        // Cuts by the bone on their other side: the edge, and the triangle that it is of.
        let mut cuts: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
        for (number, (corners, owners)) in whole.iter().enumerate() {
            if owners & own == 0 {
                continue;
            }
            piece.push(triangles[number]);
            for k in 0..3 {
                let beyond = edges.get(&[corners[(k + 1) % 3], corners[k]]).copied().unwrap_or(own);
                if beyond & own == 0 {
                    cuts.entry(beyond.trailing_zeros()).or_default().push((number, k));
                }
            }
        }
        let is_foot = Side::BOTH.iter().any(|side| side.leg()[2..].contains(&bone));
        let middle = piece.iter().flat_map(|t| t.corners_m).sum::<DVec3>() / (3 * piece.len().max(1)) as f64;
        for cut in cuts.values() {
            piece.extend(cap(triangles, cut, middle, if is_foot { 0.0 } else { BULGE }));
        }
        if !piece.is_empty() {
            let bone_from_object = &body.bone_from_object[bone as usize];
            piece.iter_mut().for_each(|triangle| *triangle = triangle.moved(bone_from_object));
            made.push((bone, piece));
        }
    }
    made
}

/// Bits of the bones that a triangle belongs to.
fn owners(body: &Body, triangle: &Triangle) -> u16 {
    let mut owners = 0_u16;
    for (corner, bone) in triangle.corners_m.iter().zip(triangle.bones) {
        let mut holds = bone;
        for side in Side::BOTH {
            let [.., foot, toes] = side.leg();
            if bone == foot || bone == toes {
                let ahead = body.bone_from_object[foot as usize].transform_point3(*corner).x;
                holds = if ahead > f64::from(body.figure.ball) { toes } else { foot };
            }
        }
        owners |= 1 << holds as u32;
    }
    for side in Side::BOTH {
        let [.., foot, toes] = side.leg();
        if let Some(lowest) = [toes, foot].into_iter().find(|bone| owners & (1 << *bone as u32) != 0) {
            return 1 << lowest as u32;
        }
    }
    owners
}

/// A fan over a cut: from each of its edges to one place beyond its middle.
fn cap(triangles: &[Triangle], cut: &[(usize, usize)], inside: DVec3, bulge: f64) -> Vec<Triangle> {
    let ends = |(number, k): (usize, usize)| {
        let triangle = &triangles[number];
        [(triangle.corners_m[k], triangle.uv[k]), (triangle.corners_m[(k + 1) % 3], triangle.uv[(k + 1) % 3])]
    };
    let middle = |edge| ends(edge).map(|(at, _)| at).into_iter().sum::<DVec3>() * 0.5;
    let count = cut.len().max(1) as f64;
    let centre = cut.iter().map(|edge| middle(*edge)).sum::<DVec3>() / count;
    let radius = cut.iter().map(|edge| (middle(*edge) - centre).length()).sum::<f64>() / count;
    let apex = centre + (centre - inside).normalize_or_zero() * bulge * radius;
    let close = |&(number, k): &(usize, usize)| {
        let [(a, uv_a), (b, uv_b)] = ends((number, k));
        let uv: [Vec2; 3] = [uv_b, uv_a, 0.5 * (uv_a + uv_b)];
        Triangle { corners_m: [b, a, apex], normals: None, uv, ..triangles[number] }
    };
    cut.iter().map(close).filter(Triangle::has_area).collect()
}

// Bones are told apart by the bits of a word.
const _: () = assert!(Bone::BODY.len() <= 16);
