//! What a ray struck.

use glam::Vec3;
use renderer::{Hit, pose_before};
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
        Self::before(snapshot, hit, 0.0)
    }

    /// At a moment between the previous frame (1) and this one (0).
    pub(crate) fn before(snapshot: &'a Snapshot, hit: &Hit, before: f32) -> Option<Self> {
        let instance = snapshot.instances.get(hit.instance as usize)?;
        let pose = pose_before(&instance.previous_local_from_object, &instance.local_from_object, before);
        let mesh = snapshot.mesh(instance);
        let [a, b, c] = mesh.corners(hit.triangle as usize);
        let normal = pose.transform_vector3((b - a).cross(c - a));
        Some(Self {
            part: mesh.part(hit.triangle as usize),
            object: instance.object,
            normal_local: normal.normalize_or_zero(),
            position_object: a + (b - a) * hit.u + (c - a) * hit.v,
        })
    }
}
