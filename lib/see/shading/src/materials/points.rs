//! Places on surfaces.

use simd::{F32x8, Vec3x8};

/// Points of a facet.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    /// Object frame, metres.
    pub(crate) object_m: Vec3x8,
    /// World, repeating after [`super::Surroundings::WRAP_M`], metres.
    pub(crate) world_m: Vec3x8,
    /// Width of a pixel there, metres.
    pub(crate) footprint_m: F32x8,
}
