//! An instance where it is.

use glam::{Affine3A, Mat3, Vec3};

use crate::cpu::meshes::MeshData;

/// One instance that can be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) mesh: &'a MeshData,
    /// Whether something stands behind its panes.
    pub(crate) has_cabin: bool,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
}

impl<'a> Placed<'a> {
    /// At a pose.
    pub(crate) fn new(mesh: &'a MeshData, pose: &Affine3A) -> Self {
        Self { mesh, has_cabin: false, rotation: pose.matrix3.into(), translation: pose.translation.into() }
    }
}
