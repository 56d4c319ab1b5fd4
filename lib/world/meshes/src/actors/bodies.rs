//! People as pieces on the bones of a rig.

use std::sync::Arc;

use crate::people::{Bone, Figure, Seat, Walker};
use crate::solids::Detail;
use schema::Tag;

use crate::actors::pieces::{ActorMesh, Coarser, Joint, Piece};
use crate::actors::rig::Rig;

/// Distances from which people are made of fewer triangles, metres: what is left out then is less than a
/// pixel of a picture of a thousand pixels a radian.
pub(crate) const LEVELS: [(f64, Detail); 2] = [(12.0, Detail::Half), (32.0, Detail::Coarse)];

/// A walker with a rig.
pub(crate) fn walker(walker: Walker) -> ActorMesh {
    let pieces = walker.meshes().iter();
    let pieces = pieces.map(|(bone, mesh)| Piece { mesh: Arc::clone(mesh), joint: Joint::Bone(*bone) });
    let coarser = coarser(walker.figure(), Tag::Pedestrian, &[]);
    ActorMesh { pieces: pieces.collect(), coarser, rig: Some(Arc::new(Rig::Walks(walker))), cabin: None }
}

/// The pieces of somebody's body.
pub(crate) fn body(figure: &Figure, tag: Tag, detail: Detail) -> impl Iterator<Item = Piece> {
    let meshes = figure.meshes(tag, detail).into_iter();
    meshes.map(|(bone, mesh)| Piece { mesh: Arc::new(mesh), joint: Joint::Bone(bone) })
}

/// The coarse figure of a person far away; the machine they sit on is drawn at every distance.
pub(crate) fn coarser(figure: &Figure, tag: Tag, seat: &[Piece]) -> Vec<Coarser> {
    let level = |(from_m, detail)| {
        let pieces = seat.iter().cloned().chain(body(figure, tag, detail)).collect();
        Coarser { from_m, pieces }
    };
    LEVELS.map(level).into()
}

/// Somebody so tall that the head's highest point is at a height, counted from what they sit or stand on.
pub(crate) fn fitted(mut figure: Figure, seat: impl Fn(&Figure) -> Seat, on_z: f32, top_m: f32) -> Figure {
    for _ in 0..8 {
        let sits = seat(&figure);
        let bones = figure.seated(&sits);
        let head = bones.object_from_bone(Bone::Head);
        let meshes = figure.meshes(Tag::Rider, Detail::Full);
        let points = meshes.iter().filter(|(bone, _)| *bone == Bone::Head).flat_map(|(_, m)| &m.positions);
        let high = points.map(|p| head.transform_point3(*p).z).fold(f32::NEG_INFINITY, f32::max);
        let by = (top_m - on_z) / (high - on_z).max(0.1);
        figure = Figure::new(figure.look, figure.stature * by);
    }
    figure
}
