//! Rays and what they hit.

use glam::Vec3;

use crate::buffer::SKY;

/// Rays from one point (a lidar's, a radar's) in the snapshot's local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayBatch<'a> {
    /// Where they start, metres.
    pub origin: Vec3,
    /// Where they go; unit length, so that distances are metres. The closer together neighbours of this list
    /// are, the faster they are followed.
    pub directions: &'a [Vec3],
    /// Nearest (not negative) and farthest distance seen, metres; the second may be infinite.
    pub range_m: [f32; 2],
    /// Nearest distance of each ray instead of the first of `range_m`; empty where that is meant for all.
    pub nearest_m: &'a [f32],
}

impl RayBatch<'_> {
    /// Nearest distance seen along a ray, metres.
    #[must_use]
    #[inline]
    pub fn nearest_m(&self, ray: usize) -> f32 {
        self.nearest_m.get(ray).copied().unwrap_or(self.range_m[0])
    }
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

/// What the rays of one batch hit, in the order of the rays. All lists are equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// Distance along the ray, metres; infinite where nothing was hit.
    pub t: Vec<f32>,
    /// Index into the snapshot's instances, or [`SKY`].
    pub instance: Vec<u32>,
    /// Index into the triangles of that instance's mesh, or [`SKY`].
    pub triangle: Vec<u32>,
    /// Barycentric weight of the triangle's second corner.
    pub u: Vec<f32>,
    /// Barycentric weight of the triangle's third corner.
    pub v: Vec<f32>,
}

impl Hits {
    /// Rays that hit nothing.
    #[must_use]
    pub fn none(rays: usize) -> Self {
        Self {
            t: vec![f32::INFINITY; rays],
            instance: vec![SKY; rays],
            triangle: vec![SKY; rays],
            u: vec![0.0; rays],
            v: vec![0.0; rays],
        }
    }

    /// How many rays there were.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there were no rays.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// What a ray hit, if anything; nothing for rays that there were not.
    #[must_use]
    pub fn get(&self, ray: usize) -> Option<Hit> {
        let instance = *self.instance.get(ray)?;
        (instance != SKY).then(|| Hit {
            t: self.t[ray],
            instance,
            triangle: self.triangle[ray],
            u: self.u[ray],
            v: self.v[ray],
        })
    }

    /// What each ray hit.
    pub fn iter(&self) -> impl Iterator<Item = Option<Hit>> + '_ {
        (0..self.len()).map(|ray| self.get(ray))
    }
}
