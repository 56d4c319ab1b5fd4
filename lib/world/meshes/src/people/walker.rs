//! Walkers: a figure whose box about it, standing, is known, and whose box follows its pose.

use std::f32::consts::TAU;
use std::sync::Arc;

use crate::solids::Detail;
use catalogue::Model;
use frames::Aabb;
use glam::{Vec3, Vec3A};
use schema::Tag;
use schema::geometry::TriMesh;

use crate::people::appearance::{Appearance, Carried};
use crate::people::figure::{Bone, Bones, Figure};
use crate::people::gait::USUAL_MPS;

/// Height of a bench's seat, metres: how far ahead somebody sits on it is the same on others.
const USUAL_SEAT_M: f32 = 0.425;

/// A pedestrian with meshes and a box.
#[derive(Clone, Debug)]
pub struct Walker {
    figure: Figure,
    meshes: Arc<[(Bone, Arc<TriMesh>)]>,
    /// Outermost vertices of each mesh: whatever way a bone is turned, one of them is outermost, or all but.
    outer: Arc<[(Bone, Vec<Vec3A>)]>,
    size_m: Vec3,
}

impl Walker {
    /// A walker of the catalogue in one of its looks, as tall as such people are.
    #[must_use]
    pub fn new(model: &Model, variant: u32) -> Self {
        let look = Appearance::new(model, variant);
        let tall = model.size_m[2] as f32 * look.height * if look.woman { 0.96 } else { 1.0 };
        Self::of_height(model, variant, tall * (1.0 + Figure::hat_share(&look)))
    }

    /// The same, so high with hat.
    #[must_use]
    pub fn of_height(model: &Model, variant: u32, height_m: f32) -> Self {
        let look = Appearance::new(model, variant);
        let figure = Figure::new(look, height_m / (1.0 + Figure::hat_share(&look)));
        let meshes = figure.meshes(Tag::Pedestrian, Detail::Full).into_iter();
        Self::of_meshes(figure, meshes.map(|(bone, mesh)| (bone, Arc::new(mesh))).collect())
    }

    /// Somebody with meshes of their own, each in the frame of its bone.
    #[must_use]
    pub fn of_meshes(mut figure: Figure, meshes: Arc<[(Bone, Arc<TriMesh>)]>) -> Self {
        let outer: Arc<[(Bone, Vec<Vec3A>)]> =
            meshes.iter().map(|(bone, mesh)| (*bone, outermost(*bone, mesh))).collect();
        // The box stands about the origin: what reaches farther back than ahead moves the body ahead.
        let standing = bounds(&figure.walking(0.0, 0.0), &outer);
        let middle = 0.5 * (standing.min + standing.max);
        (figure.hips_ahead, figure.hips_left) = (-middle.x, -middle.y);
        if matches!(figure.look.carried, Carried::Pram | Carried::Dog) {
            figure.strides_ahead = striding_ahead(&figure, &outer);
        }
        let sitting = bounds(&figure.sitting(0.0, USUAL_SEAT_M), &outer);
        let middle = 0.5 * (sitting.min + sitting.max);
        (figure.sits_ahead, figure.sits_left) = (-middle.x, -middle.y);
        let mut walker = Self { figure, meshes, outer, size_m: Vec3::ZERO };
        walker.size_m = walker.box_m(0.0, 0.0);
        walker
    }

    /// Its measures.
    #[must_use]
    pub fn figure(&self) -> &Figure {
        &self.figure
    }

    /// Its meshes, in the frames of their bones.
    #[must_use]
    pub fn meshes(&self) -> &[(Bone, Arc<TriMesh>)] {
        &self.meshes
    }

    /// Whether it moves a little while it stands, as the phase goes on. The wheels of a pram, which turn with
    /// the phase, stand still then.
    #[must_use]
    pub fn idles(&self) -> bool {
        self.figure.look.carried != Carried::Pram
    }

    /// Length, width and height of the box about it while it stands at phase 0, metres.
    #[must_use]
    pub fn size_m(&self) -> Vec3 {
        self.size_m
    }

    /// Where its bones are: on a seat of a height, or, where that is 0, walking or standing.
    #[must_use]
    pub fn bones(&self, phase_rad: f32, speed_mps: f32, seat_m: f32) -> Bones {
        if seat_m > 0.0 {
            self.figure.sitting(phase_rad, seat_m)
        } else {
            self.figure.walking(phase_rad, speed_mps)
        }
    }

    /// Length, width and height of the upright box about it while it walks or stands, metres: the origin is
    /// the middle of its lower face.
    #[must_use]
    pub fn box_m(&self, phase_rad: f32, speed_mps: f32) -> Vec3 {
        self.posed_box_m(&self.figure.walking(phase_rad, speed_mps))
    }

    /// The same in a pose ([`Walker::bones`]).
    #[must_use]
    pub fn posed_box_m(&self, bones: &Bones) -> Vec3 {
        let found = bounds(bones, &self.outer);
        let reach = found.max.max(-found.min);
        Vec3::new(2.0 * reach.x, 2.0 * reach.y, found.max.z)
    }
}

/// How far somebody must be moved ahead at full stride so that what the pose takes up in the mean is centred
/// on the origin, too.
fn striding_ahead(figure: &Figure, outer: &[(Bone, Vec<Vec3A>)]) -> f32 {
    const PHASES: usize = 12;
    let middle = |k: usize| {
        let found = bounds(&figure.walking(TAU * k as f32 / PHASES as f32, USUAL_MPS), outer);
        0.5 * (found.min.x + found.max.x)
    };
    let mean = (0..PHASES).map(middle).sum::<f32>() / PHASES as f32;
    -mean / figure.vigour(USUAL_MPS)
}

fn bounds(bones: &Bones, outer: &[(Bone, Vec<Vec3A>)]) -> Aabb {
    let mut found = Aabb::EMPTY;
    for (bone, points) in outer {
        let pose = bones.object_from_bone(*bone);
        found = points.iter().fold(found, |b, p| b.with(pose.transform_point3a(*p).into()));
    }
    found
}

/// Of a head all vertices are kept that are so near to its highest: whichever way it nods, one of them is
/// the highest of somebody.
const CROWN_M: f32 = 0.012;

/// For each of 218 directions spread over the sphere the vertex that is farthest out.
fn outermost(bone: Bone, mesh: &TriMesh) -> Vec<Vec3A> {
    // Of long things, directions are spread over their breadth as over their length.
    let bounds = mesh.aabb();
    let per_size = (bounds.max - bounds.min).max(Vec3::splat(1e-3)).recip();
    let is_crown = |p: &Vec3| bone == Bone::Head && p.z > bounds.max.z - CROWN_M;
    let mut chosen: Vec<usize> =
        mesh.positions.iter().enumerate().filter(|(_, p)| is_crown(p)).map(|(k, _)| k).collect();
    let steps = [-3, -2, -1, 0, 1, 2, 3];
    for x in steps {
        for y in steps {
            for z in steps {
                if [x, y, z].iter().all(|v: &i32| v.abs() < 3) {
                    continue;
                }
                let way = Vec3::new(x as f32, y as f32, z as f32) * per_size;
                let out = |p: &Vec3| p.dot(way);
                let best = mesh
                    .positions
                    .iter()
                    .enumerate()
                    .fold(0, |best, (k, p)| if out(p) > out(&mesh.positions[best]) { k } else { best });
                if !chosen.contains(&best) {
                    chosen.push(best);
                }
            }
        }
    }
    chosen.into_iter().map(|k| mesh.positions[k].into()).collect()
}
