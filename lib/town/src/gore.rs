//! Pavement between lanes that turn away from each other.

use frames::math::asin;
use opendrive::{Cubic, Curve, Lane, LaneType};

use crate::marks;
use crate::path::Path;
use crate::profile::ramp;

/// The paved wedge to the left of a turn around a kerb, where the street it comes from (`forks[0]`) or leads to
/// (`forks[1]`) has more lanes, which turn the other way.
pub(crate) fn gore(path: &Path, forks: [bool; 2], width_m: f64) -> Option<Lane> {
    let arc = path.pieces.iter().find(|piece| matches!(piece.curve, Curve::Arc { .. }))?;
    let Curve::Arc { curvature } = arc.curve else { return None };
    let radius = 1.0 / curvature.abs();
    // The wedge ends where the turn's left border meets the lane across: R (1 - sin(angle)) = width. It is widest
    // before that, and runs out under that lane.
    let cross_m = (radius * asin((1.0 - width_m / radius).clamp(0.0, 1.0))).min(0.5 * arc.length_m);
    let (widest_m, end_m) = (0.7 * cross_m, (1.5 * cross_m).min(arc.length_m));
    if !forks.contains(&true) || widest_m < 0.1 {
        return None;
    }
    let (start, end) = (arc.s, arc.s + arc.length_m);
    let mut widths = vec![Cubic::constant(0.0)];
    let mut wedge = |from: f64, widest: f64, to: f64| {
        widths.push(ramp(from, 0.0, widest - from, width_m));
        widths.push(ramp(widest, width_m, to - widest, 0.0));
        widths.push(Cubic { s: to, ..Cubic::default() });
    };
    // Where both ends fork, the first wedge alone is drawn: the arc has no room for two.
    if forks[0] {
        wedge(start, start + widest_m, start + end_m);
    } else {
        wedge(end - end_m, end - widest_m, end);
    }
    Some(Lane { id: 1, lane_type: LaneType::Shoulder, widths, marks: vec![marks::none()], ..Lane::default() })
}

/// Pavement to the left of a turn where the street at either end is wider in its middle than the turn's lanes reach: a
/// wedge from each end. `widths_m`: from the turn's left border to the middle of the street, at both ends.
pub(crate) fn wedges(length_m: f64, widths_m: [f64; 2]) -> Option<Lane> {
    if widths_m.iter().all(|w| *w < 0.1) {
        return None;
    }
    let half = 0.5 * length_m;
    let widths = vec![ramp(0.0, widths_m[0], half, 0.0), ramp(half, 0.0, half, widths_m[1])];
    Some(Lane { id: 1, lane_type: LaneType::Shoulder, widths, marks: vec![marks::none()], ..Lane::default() })
}
