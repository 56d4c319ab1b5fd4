//! Reference lines of edges, between the places where they meet their nodes.

use frames::math::{atan2, tan};
use frames::wrap_pi;
use std::f64::consts::PI;

use crate::TownError;
use crate::layout::{Edge, Line};
use crate::path::{Bend, Path, Pose2, STRAIGHT_M, Via};

/// Least length of a street between two junctions, metres.
const SHORTEST_M: f64 = 8.0;
/// A street that leaves its node askew of its next corner bends at this share of the way to it, but at most
/// so far from the node, metres.
const LEAD: (f64, f64) = (0.4, 60.0);
/// Directions nearer than this are the same, radians.
const SAME_RAD: f64 = 1e-9;

/// The reference line of an edge. `ends`: where it starts and ends, both facing away from their nodes.
pub(crate) fn route(edge: &Edge, ends: [Pose2; 2]) -> Result<Path, TownError> {
    let path = match &edge.line {
        Line::Chain(start, pieces) => Path::chain(*start, pieces),
        Line::Via(vias) => through(edge, vias, ends)?,
    };
    let tight = |left_m, needed_m| Err(TownError::TooTight { street: edge.name.clone(), left_m, needed_m });
    let least = if matches!(edge.line, Line::Chain(..)) { 1.0 } else { SHORTEST_M };
    if path.length_m < least {
        return tight(path.length_m, least);
    }
    if path.tightest_m() < edge.min_radius_m {
        return Err(TownError::Bend {
            street: edge.name.clone(),
            radius_m: path.tightest_m(),
            needed_m: edge.min_radius_m,
        });
    }
    Ok(path)
}

fn through(edge: &Edge, vias: &[Via], [start, end]: [Pose2; 2]) -> Result<Path, TownError> {
    let finish = end.turned(PI);
    // Straight at its ends, so that objects beside them face along the lanes.
    let plain = Bend { radius_m: f64::INFINITY, ease_m: 0.0, lead_in_m: STRAIGHT_M, lead_out_m: STRAIGHT_M };
    let (Some(first), Some(last)) = (vias.first(), vias.last()) else {
        let (ahead, _) = start.locate(end);
        let (behind, _) = end.locate(start);
        if ahead < SHORTEST_M && behind < SHORTEST_M {
            return Err(TownError::TooTight {
                street: edge.name.clone(),
                left_m: ahead,
                needed_m: SHORTEST_M,
            });
        }
        return Ok(Path::between(start, finish, &plain));
    };
    let mut corners = Vec::with_capacity(vias.len() + 2);
    corners.extend(lead(edge, start, first.at_m)?);
    corners.extend_from_slice(vias);
    corners.extend(lead(edge, end, last.at_m)?);
    Ok(Path::through(start, &corners, finish))
}

/// The corner that turns an end of a street towards its next corner, where it does not look there anyhow.
fn lead(edge: &Edge, pose: Pose2, next: [f64; 2]) -> Result<Option<Via>, TownError> {
    let (ahead, left) = pose.locate(Pose2 { x_m: next[0], y_m: next[1], heading_rad: 0.0 });
    let turn = atan2(left, ahead);
    if ahead <= 0.5 {
        return Err(TownError::TooTight { street: edge.name.clone(), left_m: ahead, needed_m: 0.5 });
    }
    if turn.abs() < SAME_RAD {
        return Ok(None);
    }
    let distance = (LEAD.0 * ahead).min(LEAD.1);
    let corner = pose.moved(distance, 0.0);
    let on = atan2(next[1] - corner.y_m, next[0] - corner.x_m);
    let turn = wrap_pi(on - pose.heading_rad).abs();
    // The rounding takes up most of the way to the corner.
    let radius_m = 0.9 * distance / tan(0.5 * turn);
    Ok(Some(Via { at_m: [corner.x_m, corner.y_m], radius_m, ease_m: 0.0 }))
}
