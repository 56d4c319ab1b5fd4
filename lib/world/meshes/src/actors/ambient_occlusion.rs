//! How much light of sky and ground reaches the pieces of an actor past the others: arches, undersides,
//! armpits lie in shade.

use std::collections::BTreeMap;
use std::f32::consts::TAU;
use std::sync::Arc;

use crate::people::about_y;
use crate::solids::{OcclusionEstimate, OrientedPoint, ambient_visibility};
use glam::{Affine3A, Mat3A, Vec3};
use schema::Tag;
use schema::geometry::TriMesh;

use crate::actors::pieces::{ActorMesh, Joint, Piece};
use crate::actors::posture::Posture;

/// How closely an actor close by is looked at, and one that moves its limbs or is farther away.
const FINE: OcclusionEstimate = OcclusionEstimate { texels: 160, axes: 24 };
const COARSE: OcclusionEstimate = OcclusionEstimate { texels: 96, axes: 12 };
/// Of less than this a place of a limb is taken for hidden in the next one.
const HIDDEN: f32 = 0.22;
/// The light on limbs is softened so often.
const SOFTENED: usize = 2;
/// What turns is looked at in so many positions, and has their mean.
const TURNS: usize = 8;
/// Of less than this a corner is within something else, and its triangle's other corners say what is seen of
/// it.
const BURIED: f32 = 0.015;

impl ActorMesh {
    /// The same with the light that reaches the corners of its triangles ([`TriMesh::corner_visibility`]): of
    /// its pieces at rest, doors closed, level by level. Houses and plants have none: the first are large,
    /// the second let light through.
    #[must_use]
    pub fn with_ambient_occlusion(mut self) -> Self {
        let posture = self.posed(Posture::default());
        let estimate = if self.rig.is_some() { COARSE } else { FINE };
        shelter(&mut self.pieces, &posture, estimate);
        for level in &mut self.coarser {
            shelter(&mut level.pieces, &posture, COARSE);
        }
        self
    }
}

/// Whether a mesh is of something that is sheltered.
fn is_apt(mesh: &TriMesh) -> bool {
    !mesh.parts.iter().any(|part| matches!(part.tag, Tag::Building | Tag::Vegetation | Tag::Wall))
}

fn shelter(pieces: &mut [Piece], posture: &Posture, estimate: OcclusionEstimate) {
    if !pieces.iter().all(|piece| is_apt(&piece.mesh)) {
        return;
    }
    // Doors that are not there when closed shade nothing.
    let at_rest = |piece: &Piece| piece.joint.object_from_piece(posture);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for piece in pieces.iter() {
        let Some(pose) = at_rest(piece) else { continue };
        let first = positions.len() as u32;
        positions.extend(piece.mesh.positions.iter().map(|p| pose.transform_point3(*p)));
        triangles.extend(piece.mesh.triangles.iter().map(|t| t.map(|v| first + v)));
    }
    // Wheels share a mesh: it is looked at where the first of them is.
    let mut firsts: Vec<(usize, Affine3A)> = Vec::new();
    for (number, piece) in pieces.iter().enumerate() {
        let is_known = |(other, _): &(usize, Affine3A)| Arc::ptr_eq(&pieces[*other].mesh, &piece.mesh);
        if let (Some(pose), false) = (at_rest(piece), firsts.iter().any(is_known)) {
            firsts.push((number, pose));
        }
    }
    let corners: Vec<Vec<[u32; 3]>> = firsts.iter().map(|_| Vec::new()).collect();
    let (mut places, mut corners) = (Vec::new(), corners);
    for ((number, pose), corners) in firsts.iter().zip(&mut corners) {
        let piece = &pieces[*number];
        let turns = if matches!(piece.joint, Joint::Wheel { .. }) { TURNS } else { 1 };
        let poses: Vec<Affine3A> = (0..turns)
            .map(|turn| {
                let by = if turn == 0 { Mat3A::IDENTITY } else { about_y(TAU * turn as f32 / turns as f32) };
                *pose * Affine3A::from_mat3(by.into())
            })
            .collect();
        *corners = gather(&piece.mesh, &poses, &mut places);
    }
    let mut open = ambient_visibility(&positions, &triangles, &places, estimate);
    // On bones that move, what happens to be near at rest shades no more than softly.
    for ((number, _), corners) in firsts.iter().zip(&corners) {
        if matches!(pieces[*number].joint, Joint::Bone(_)) {
            (0..SOFTENED).for_each(|_| soften(&mut open, corners));
        }
    }
    let mut done: Vec<(Arc<TriMesh>, Arc<TriMesh>)> = Vec::new();
    for ((number, _), corners) in firsts.iter().zip(corners) {
        let piece = &pieces[*number];
        let turns = if matches!(piece.joint, Joint::Wheel { .. }) { TURNS } else { 1 };
        let of = |first: u32| open[first as usize..first as usize + turns].iter().sum::<f32>() / turns as f32;
        let mut mesh = TriMesh::clone(&piece.mesh);
        mesh.corner_visibility = corners.iter().map(|first| shares(first.map(of))).collect();
        done.push((Arc::clone(&piece.mesh), Arc::new(mesh)));
    }
    for piece in pieces {
        if let Some((_, new)) = done.iter().find(|(old, _)| Arc::ptr_eq(old, &piece.mesh)) {
            piece.mesh = Arc::clone(new);
        }
    }
}

/// Takes each place half the way to the mean of the triangles around it. What is hidden in the next limb
/// counts for nothing, and is as open as what is around it: else joints would be dark.
fn soften(open: &mut [f32], corners: &[[u32; 3]]) {
    let mut sums: BTreeMap<u32, (f32, f32)> = BTreeMap::new();
    for places in corners {
        let seen = places.iter().map(|place| open[*place as usize]).filter(|open| *open > HIDDEN);
        let (sum, count) = seen.fold((0.0, 0.0), |(sum, count), open| (sum + open, count + 1.0));
        for place in places {
            let around = sums.entry(*place).or_default();
            *around = (around.0 + sum, around.1 + count);
        }
    }
    for (place, (sum, count)) in sums {
        let place = &mut open[place as usize];
        if count > 0.0 {
            let around = sum / count;
            *place = if *place > HIDDEN { 0.5 * (*place + around) } else { around };
        }
    }
}

/// The shares of a triangle's corners, as they are kept; what is buried is as open as the rest.
fn shares(open: [f32; 3]) -> [u8; 3] {
    let seen = open.iter().filter(|open| **open > BURIED);
    let mean = seen.clone().sum::<f32>() / seen.count().max(1) as f32;
    open.map(|open| if open > BURIED { open } else { mean }).map(|open| (open * 255.0 + 0.5) as u8)
}

/// Adds the places of a mesh's corners in some poses, one after the other, each once; gives the first of each
/// corner of its triangles.
fn gather(mesh: &TriMesh, poses: &[Affine3A], places: &mut Vec<OrientedPoint>) -> Vec<[u32; 3]> {
    let normals = |triangle: usize| {
        mesh.bent(triangle).unwrap_or_else(|| {
            let [a, b, c] = mesh.corners(triangle);
            [(b - a).cross(c - a).normalize_or(Vec3::Z); 3]
        })
    };
    // By vertex, as few as there are at each: which normals are known there, and their first places.
    let mut known: Vec<Vec<(Vec3, u32)>> = vec![Vec::new(); mesh.positions.len()];
    let mut corners = Vec::with_capacity(mesh.triangles.len());
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        let normals = normals(number);
        let first = [0, 1, 2].map(|k| {
            let known = &mut known[triangle[k] as usize];
            if let Some((_, first)) = known.iter().find(|(normal, _)| *normal == normals[k]) {
                return *first;
            }
            let (first, position) = (places.len() as u32, mesh.positions[triangle[k] as usize]);
            let place =
                |pose: &Affine3A| (pose.transform_point3(position), pose.transform_vector3(normals[k]));
            places.extend(poses.iter().map(place));
            known.push((normals[k], first));
            first
        });
        corners.push(first);
    }
    corners
}

#[cfg(test)]
mod tests {
    use catalogue::models;

    use super::*;
    use crate::actors::actor_mesh;

    /// The mean of what reaches corners in part of a level's first piece, weighed by area.
    fn mean(pieces: &[Piece], wanted: impl Fn(Vec3, Vec3) -> bool) -> f32 {
        let mesh = &pieces[0].mesh;
        let (mut sum, mut area) = (0.0, 0.0);
        for (number, open) in mesh.corner_visibility.iter().enumerate() {
            let [a, b, c] = mesh.corners(number);
            let twice = (b - a).cross(c - a);
            if wanted((a + b + c) / 3.0, twice.normalize_or_zero()) {
                sum += open.iter().map(|v| f32::from(*v) / 255.0).sum::<f32>() / 3.0 * twice.length();
                area += twice.length();
            }
        }
        sum / area
    }

    #[test]
    fn roofs_are_open_and_undersides_are_dark_at_every_level() {
        for name in ["car.sedan", "van.delivery", "truck.box", "bus.city"] {
            let model = models::find(name).expect("is one");
            let made = actor_mesh(name, model.size_m, 0).expect("is one").with_ambient_occlusion();
            let height = model.size_m[2] as f32;
            for pieces in std::iter::once(&made.pieces).chain(made.coarser.iter().map(|level| &level.pieces))
            {
                assert!(
                    pieces.iter().all(|p| matches!(p.joint, Joint::Door { .. } | Joint::Doorway { .. })
                        || p.mesh.corner_visibility.len() == p.mesh.triangles.len()),
                    "{name}"
                );
                let roof = mean(pieces, |at, normal| at.z > 0.9 * height && normal.z > 0.9);
                let under = mean(pieces, |at, normal| at.z < 0.35 * height && normal.z < -0.9);
                // Things on roofs shade a part of them.
                assert!(roof > 0.8, "{name}: {roof}");
                assert!(under < 0.5, "{name}: {under}");
            }
        }
    }
}
