//! Which sort of street a place belongs to.

use crate::scenery::frontage::Spot;

/// Sidewalks of this width are wide enough for things at the kerb, metres.
pub(super) const WIDE_WALK_M: f64 = 2.5;

/// Which of the three sorts of street a place belongs to: with a narrow sidewalk, with a wide one, without.
pub(super) fn street(spot: &Spot) -> usize {
    if spot.walk_m <= 0.0 {
        2
    } else if spot.walk_m < WIDE_WALK_M {
        0
    } else {
        1
    }
}
