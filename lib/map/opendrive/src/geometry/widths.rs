//! Widths of lanes.

use super::value_and_slope;
use crate::model::Lane;

/// Width of a lane and its slope, `ds` metres after the section's start; `inside` is the distance and slope
/// of its inner border from the centre lane. Never negative.
pub(crate) fn lane_width(lane: &Lane, ds: f64, inside: (f64, f64)) -> (f64, f64) {
    let (width, slope) = if let Some(first) = lane.widths.first() {
        if ds < first.s { (first.a, 0.0) } else { value_and_slope(&lane.widths, ds) }
    } else if let Some(first) = lane.borders.first() {
        let (border, slope) = if ds < first.s { (first.a, 0.0) } else { value_and_slope(&lane.borders, ds) };
        // Some writers give the border's t, some its distance.
        let sign = if border < 0.0 { -1.0 } else { 1.0 };
        (sign * border - inside.0, sign * slope - inside.1)
    } else {
        (0.0, 0.0)
    };
    // A negative width would turn the lane inside out.
    if width > 0.0 { (width, slope) } else { (0.0, 0.0) }
}

/// Distance of the outer border of the last of some lanes from the centre lane, and its slope, `ds` metres
/// after the section's start. `lanes` run from the inside out.
pub(crate) fn outer_border<'a>(lanes: impl IntoIterator<Item = &'a Lane>, ds: f64) -> (f64, f64) {
    lanes.into_iter().fold((0.0, 0.0), |inside, lane| {
        let width = lane_width(lane, ds, inside);
        (inside.0 + width.0, inside.1 + width.1)
    })
}
