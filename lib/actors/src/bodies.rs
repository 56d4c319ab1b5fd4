//! People as pieces on the bones of a rig.

use std::sync::Arc;

use people::{Bone, Figure, Seat, Walker};
use schema::Tag;

use crate::pieces::{ActorMesh, Joint, Piece};
use crate::rig::Rig;

/// A walker with a rig.
pub(crate) fn walker(walker: Walker) -> ActorMesh {
    let pieces = walker.meshes().iter();
    let pieces = pieces.map(|(bone, mesh)| Piece { mesh: Arc::clone(mesh), joint: Joint::Bone(*bone) });
    ActorMesh { pieces: pieces.collect(), rig: Some(Arc::new(Rig::Walks(walker))), ..ActorMesh::default() }
}

/// The pieces of somebody's body.
pub(crate) fn body(figure: &Figure, tag: Tag) -> impl Iterator<Item = Piece> {
    let meshes = figure.meshes(tag).into_iter();
    meshes.map(|(bone, mesh)| Piece { mesh: Arc::new(mesh), joint: Joint::Bone(bone) })
}

/// Somebody so tall that, sitting, the head's highest point is at a height.
pub(crate) fn fitted(mut figure: Figure, seat: impl Fn(&Figure) -> Seat, top_m: f32) -> Figure {
    for _ in 0..8 {
        let sits = seat(&figure);
        let bones = figure.seated(&sits);
        let head = bones.object_from_bone(Bone::Head);
        let meshes = figure.meshes(Tag::Rider);
        let points = meshes.iter().filter(|(bone, _)| *bone == Bone::Head).flat_map(|(_, m)| &m.positions);
        let high = points.map(|p| head.transform_point3(*p).z).fold(f32::NEG_INFINITY, f32::max);
        let by = (top_m - sits.hips.z) / (high - sits.hips.z).max(0.1);
        figure = Figure::new(figure.look, figure.stature * by);
    }
    figure
}
