//! An instance where it is.

use glam::{Affine3A, Mat3, Vec3};

use crate::prepared::meshes::MeshData;

/// One instance that can be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) mesh: &'a MeshData,
    pub(crate) mesh_number: u32,
    /// Whether something stands behind its panes.
    pub(crate) has_cabin: bool,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
}

impl<'a> Placed<'a> {
    /// At a pose.
    pub(crate) fn new((mesh_number, mesh): (u32, &'a MeshData), pose: &Affine3A) -> Self {
        let (rotation, translation) = (pose.matrix3.into(), pose.translation.into());
        Self { mesh, mesh_number, has_cabin: false, rotation, translation }
    }
}
