//! An instance where it is.

use glam::{Mat3, Vec3};

use crate::meshes::MeshData;

/// One instance that can be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) mesh: &'a MeshData,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
}
