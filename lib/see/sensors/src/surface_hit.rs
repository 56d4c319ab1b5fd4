//! What a ray struck.

use glam::Vec3;
use render::{Hit, pose_before};
use schema::ObjectId;
use schema::geometry::{MeshPart, Snapshot};

/// The triangle that a ray struck.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceHit<'a> {
    pub(crate) part: &'a MeshPart,
    pub(crate) object: ObjectId,
    /// Colour of what is painted, linear RGB.
    pub(crate) paint: [f32; 3],
    /// Unit normal, either side, local frame.
    pub(crate) normal_local: Vec3,
    /// First corner and the edges from there, object's frame, metres.
    corner: Vec3,
    edges: [Vec3; 2],
}

impl<'a> SurfaceHit<'a> {
    pub(crate) fn new(snapshot: &'a Snapshot, hit: &Hit) -> Option<Self> {
        Self::before(snapshot, hit, 0.0)
    }

    /// At a moment between the previous frame (1) and this one (0).
    pub(crate) fn before(snapshot: &'a Snapshot, hit: &Hit, before: f32) -> Option<Self> {
        let instance = snapshot.behind(hit.instance)?;
        let pose = pose_before(&instance.previous_local_from_object, &instance.local_from_object, before);
        let mesh = snapshot.mesh(instance);
        let [a, b, c] = mesh.corners(hit.triangle as usize);
        let edges = [b - a, c - a];
        let normal = pose.transform_vector3(edges[0].cross(edges[1]));
        Some(Self {
            part: mesh.part(hit.triangle as usize),
            object: instance.object,
            paint: instance.paint,
            normal_local: normal.normalize_or_zero(),
            corner: a,
            edges,
        })
    }

    /// Where a ray met it, in the object's frame.
    pub(crate) fn position_object(&self, hit: &Hit) -> Vec3 {
        self.corner + self.edges[0] * hit.u + self.edges[1] * hit.v
    }
}
