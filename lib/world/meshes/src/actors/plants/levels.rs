//! Levels of detail of a plant.

use std::sync::Arc;

use glam::Vec3;
use schema::geometry::TriMesh;

use crate::actors::pieces::{ActorMesh, Coarser, Joint, Piece};

/// Levels of a tree.
pub(super) const LEVELS: usize = 5;
/// From where on the coarser ones of them are there, metres.
pub(super) const FROM_M: [f64; LEVELS - 1] = [20.0, 50.0, 90.0, 150.0];

/// An actor of some levels, the finest first, all of them stretched as that one is, so that it fills its box.
/// The middle stays where it is: there its foot stands.
pub(super) fn into_levels(
    mut meshes: Vec<TriMesh>,
    size: Vec3,
    from_m: impl IntoIterator<Item = f64>,
) -> ActorMesh {
    let half = Vec3::new(0.5 * size.x, 0.5 * size.y, size.z);
    let Some(bounds) = meshes.first().map(TriMesh::aabb) else { return ActorMesh::default() };
    let (min, max) = (-half * Vec3::new(1.0, 1.0, 0.0), half);
    let by = |reach: Vec3| half / reach.abs().max(Vec3::splat(1e-3));
    let (lower, upper) = (by(bounds.min), by(bounds.max));
    for p in meshes.iter_mut().flat_map(|mesh| &mut mesh.positions) {
        let scale = Vec3::select(p.cmplt(Vec3::ZERO), lower, upper);
        *p = (*p * Vec3::new(scale.x, scale.y, upper.z)).clamp(min, max);
    }
    levels_of(meshes, from_m)
}

/// An actor of some levels, the finest first.
pub(super) fn levels_of(meshes: Vec<TriMesh>, from_m: impl IntoIterator<Item = f64>) -> ActorMesh {
    let mut levels = meshes.into_iter().map(|mesh| vec![Piece { mesh: Arc::new(mesh), joint: Joint::Fixed }]);
    let mut actor = ActorMesh::of(levels.next().unwrap_or_default());
    actor.coarser =
        from_m.into_iter().zip(levels).map(|(from_m, pieces)| Coarser { from_m, pieces }).collect();
    actor
}
