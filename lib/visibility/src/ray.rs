//! Rays and what they hit.

use glam::Vec3;

/// A ray in the snapshot's local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: Vec3,
    /// Where it goes; unit length, so that distances are metres.
    pub direction: Vec3,
    /// Nearest distance seen, metres; not negative.
    pub t_min: f32,
    /// Farthest distance seen, metres; may be infinite.
    pub t_max: f32,
}

/// The first surface along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, metres.
    pub t: f32,
    /// Index into the snapshot's instances.
    pub instance: u32,
    /// Index into the triangles of the instance's mesh.
    pub triangle: u32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner.
    pub v: f32,
}
