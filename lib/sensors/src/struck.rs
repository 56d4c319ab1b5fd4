//! What a ray struck.

use glam::Vec3;
use renderer::Hit;
use schema::ObjectId;
use schema::geometry::{Part, Snapshot};

/// The surface that a ray struck.
pub(crate) struct Struck<'a> {
    pub(crate) part: &'a Part,
    pub(crate) object: ObjectId,
    /// Unit normal, either side, local frame.
    pub(crate) normal_local: Vec3,
    /// Where the ray met it, in the object's frame.
    pub(crate) position_object: Vec3,
}

impl<'a> Struck<'a> {
    pub(crate) fn new(snapshot: &'a Snapshot, hit: &Hit) -> Option<Self> {
        let instance = snapshot.instances.get(hit.instance as usize)?;
        let mesh = snapshot.mesh(instance);
        let [a, b, c] = mesh.corners(hit.triangle as usize);
        let normal = instance.local_from_object.transform_vector3((b - a).cross(c - a));
        Some(Self {
            part: mesh.part(hit.triangle as usize),
            object: instance.object,
            normal_local: normal.normalize_or_zero(),
            position_object: a + (b - a) * hit.u + (c - a) * hit.v,
        })
    }
}
