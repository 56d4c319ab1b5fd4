//! Places on surfaces.

use lanes::{Lanes, Vec3s};

/// Points of a facet.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    /// Object frame, metres.
    pub(crate) object_m: Vec3s,
    /// World, repeating after [`super::Surroundings::WRAP_M`], metres.
    pub(crate) world_m: Vec3s,
    /// Width of a pixel there, metres.
    pub(crate) footprint_m: Lanes,
}
