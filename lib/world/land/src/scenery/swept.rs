//! Ground that the longest vehicles need in bends: nothing is put there.
//!
//! A bus whose middle follows its lane has its rear axle on a smaller circle and its outer front corner on a
//! larger one.

use catalogue::swept_m;
use frames::wrap_pi;
use nalgebra::Point3;
use opendrive::{LaneHit, Map};

/// The longest vehicle: length, width and half its wheelbase, metres.
const LENGTH_M: f64 = 12.0;
const WIDTH_M: f64 = 2.5;
const HALF_BASE_M: f64 = 3.0;
/// Room beside it, metres.
const SPARE_M: f64 = 0.3;
/// Lanes with their middles farther from a place than this do not matter there, metres: the tightest bend and
/// a thing.
const REACH_M: f64 = 6.5;
/// A bend's radius is taken over so many metres before and behind a place.
const AROUND_M: f64 = 5.0;
/// Bends are looked for this far back along the way, within so much of its straight line, metres, and where
/// lanes run the same way, radians.
const UPSTREAM_M: [f64; 2] = [4.0, 8.0];
const UPSTREAM_ASIDE_M: f64 = 1.5;
const SAME_WAY_RAD: f64 = 1.0;
/// No bend is taken for tighter than this, metres.
const TIGHTEST_M: f64 = 8.0;

/// How far a long vehicle reaches inwards and outwards from a circle that its middle follows, metres.
fn reaches(radius_m: f64) -> [f64; 2] {
    swept_m([LENGTH_M, WIDTH_M], HALF_BASE_M, radius_m)
}

/// A lane's curvature at a place, positive to the left, 1/m.
fn curvature(map: &Map, hit: &LaneHit) -> Option<f64> {
    let lane = map.lane(hit.lane)?;
    let at = |s: f64| map.lane_point(hit.lane, s.clamp(lane.s_start, lane.s_end), 0.0);
    let [a, b] = [at(hit.s - AROUND_M)?, at(hit.s + AROUND_M)?];
    let way_m = (b.position - a.position).norm();
    // Over the bend's chord; against the direction of travel the turn has the other sign.
    let forward =
        (b.position - a.position).xy().dot(&nalgebra::Vector2::from(direction(a.heading_rad))) >= 0.0;
    let turn = wrap_pi(b.heading_rad - a.heading_rad) * if forward { 1.0 } else { -1.0 };
    (way_m > 1.0).then(|| turn / way_m)
}

fn direction(heading_rad: f64) -> [f64; 2] {
    let (sin, cos) = frames::math::sin_cos(heading_rad);
    [cos, sin]
}

/// Curvatures of the ways to a place on a lane, positive to the left, 1/m: a vehicle's front is beyond a bend
/// while its middle is in it.
fn curvatures(map: &Map, hit: &LaneHit) -> Vec<f64> {
    let own = curvature(map, hit).unwrap_or(0.0);
    let Some(here) = map.lane_point(hit.lane, hit.s, 0.0) else { return vec![own] };
    let back = UPSTREAM_M.map(|back_m| {
        let [x, y] = direction(here.heading_rad);
        here.position - nalgebra::Vector3::new(x, y, 0.0) * back_m
    });
    let before = back.iter().flat_map(|point| {
        let near = map.lanes_within(*point, UPSTREAM_ASIDE_M, |lane| lane.lane_type.is_drivable());
        near.into_iter().filter_map(|hit| {
            let heading_rad = map.lane_point(hit.lane, hit.s, 0.0)?.heading_rad;
            let same_way = wrap_pi(heading_rad - here.heading_rad).abs() < SAME_WAY_RAD;
            curvature(map, &hit).filter(|_| same_way)
        })
    });
    std::iter::once(own).chain(before).collect()
}

/// Whether something that reaches so far around a place would stand in the way of long vehicles that keep to
/// their lanes.
pub(crate) fn is_swept(map: &Map, place: Point3<f64>, half_m: f64) -> bool {
    let near = map.lanes_within(place, REACH_M, |lane| lane.lane_type.is_drivable());
    near.iter().any(|hit| {
        curvatures(map, hit).into_iter().any(|curvature| {
            let [inwards, outwards] = reaches(1.0 / curvature.abs().clamp(1e-4, 1.0 / TIGHTEST_M));
            let inside = (hit.t_m > 0.0) == (curvature > 0.0);
            hit.t_m.abs() - half_m < if inside { inwards } else { outwards } + SPARE_M
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bus_reaches_as_far_as_one_that_is_driven_round_a_circle() {
        for radius_m in [8.0, 12.0, 20.0, 45.0, 1e4] {
            // The middle at (0, R), going clockwise round the origin: the nose points outwards by asin(h /
            // R), as the rear axle, h behind the middle, is perpendicular to the way to the origin.
            let (sin, cos) = frames::math::sin_cos(frames::math::asin(HALF_BASE_M / radius_m));
            let corner = |ahead: f64, left: f64| -> [f64; 2] {
                [ahead * cos - left * sin, radius_m + ahead * sin + left * cos]
            };
            let far = |p: [f64; 2]| (p[0] * p[0] + p[1] * p[1]).sqrt();
            let mut extremes = [f64::INFINITY, f64::NEG_INFINITY];
            for k in 0..=1200 {
                for left in [-0.5 * WIDTH_M, 0.5 * WIDTH_M] {
                    let off = far(corner(0.01 * f64::from(k) - 0.5 * LENGTH_M, left));
                    extremes = [extremes[0].min(off), extremes[1].max(off)];
                }
            }
            let [inwards, outwards] = reaches(radius_m);
            assert!((radius_m - extremes[0] - inwards).abs() < 1e-4, "{radius_m}: {extremes:?} {inwards}");
            assert!((extremes[1] - radius_m - outwards).abs() < 1e-4, "{radius_m}: {extremes:?} {outwards}");
        }
    }
}
