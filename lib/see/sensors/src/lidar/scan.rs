//! What the rays of beams meet.

use glam::Vec3;
use render::Hits;

use render::panes::TransmittedHit;

/// What the rays of all beams of a lidar met at a frame.
pub struct Scan {
    /// Slice by slice, patch by patch.
    pub(super) slices: Vec<Vec<Followed>>,
}

/// What the rays of some beams of a patch met, in following order.
pub(super) struct Followed {
    /// Unit directions in the snapshot's local frame.
    pub(super) directions: Vec<Vec3>,
    pub(super) hits: Hits,
    /// What those met (by their numbers, ascending) that passed panes.
    pub(super) behind: Vec<(u32, TransmittedHit)>,
}
