//! An instance where it is.

use glam::{Affine3A, Mat3, Vec3};

use crate::prepared::meshes::MeshData;

/// One instance that can be seen.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// Its mesh.
    pub mesh: &'a MeshData,
    /// The mesh's number.
    pub mesh_number: u32,
    /// Whether something stands behind its panes.
    pub(crate) has_cabin: bool,
    /// How it is turned: from its own frame into the local one.
    pub rotation: Mat3,
    /// Where its origin is in the local frame, metres.
    pub translation: Vec3,
}

impl<'a> Placed<'a> {
    /// At a pose.
    pub(crate) fn new((mesh_number, mesh): (u32, &'a MeshData), pose: &Affine3A) -> Self {
        let (rotation, translation) = (pose.matrix3.into(), pose.translation.into());
        Self { mesh, mesh_number, has_cabin: false, rotation, translation }
    }
}
