//! Where the warning sign of a hazard stands: beside the road, some way before it.

use catalogue::works::Item;
use nalgebra::Point3;
use opendrive::{LaneId, LanePos, LaneType, Map};
use random::Stream;
use schema::footprint::footprint;
use schema::tables::ActorRow;

use super::obstacle::{Obstacle, Spot};
use crate::scene::free_space::{Footprint, Taken, apart};

/// Centreline from the sign to the hazard, metres.
const BEFORE_M: [f64; 2] = [40.0, 160.0];
/// The face is turned by up to so much, degrees.
const TURN_DEG: f64 = 10.0;
/// Strips beside the road on which signs stand are at least so wide, metres.
const LEAST_WIDTH_M: f64 = 1.0;
/// Lanes to the right that are looked at.
const LANES: usize = 11;
/// Places that are tried where something else stands.
const TRIES: usize = 4;
/// Free space between a sign and the objects there, metres.
const CLEAR_M: f64 = 0.2;
/// From the kerb to the middle of a sign on a sidewalk, metres: walkers get by.
const KERB_M: f64 = 0.55;

/// A sign before a hazard that begins at `at`; none where no strip beside the road is wide enough, or all is
/// taken.
pub(super) fn before(
    map: &Map,
    at: LanePos,
    sign: Item,
    draw: &mut Stream,
    taken: &Taken,
    fixed: &[ActorRow],
) -> Option<Obstacle> {
    (0..TRIES).find_map(|_| {
        let way_m = draw.uniform(BEFORE_M[0], BEFORE_M[1]);
        let turn_rad = draw.uniform(-TURN_DEG, TURN_DEG).to_radians();
        let from = map.behind(at, way_m).first().copied().unwrap_or(at);
        let (foot, heading_rad) = strip(map, from)?;
        // The face looks at those who come.
        let spot = Spot::upright(foot, heading_rad + std::f64::consts::PI + turn_rad);
        let thing = Obstacle::sign(sign, &spot);
        let (point, yaw_rad, size_m) = thing.footprint();
        let free = taken.is_free(&point, yaw_rad, size_m)
            && fixed.iter().all(|other| is_clear(&(point, yaw_rad, size_m), other));
        free.then_some(thing)
    })
}

/// A place on the first sidewalk, shoulder or parking lane that is wide enough, to the right of a place on a
/// lane; and the heading of traffic there.
///
/// Kerbs, verges and cycle lanes are passed over, which the published rule does not have: ours are lanes of
/// their own. On a sidewalk the sign stands at its edge and not in the middle.
fn strip(map: &Map, from: LanePos) -> Option<(Point3<f64>, f64)> {
    let s = map.s_of(from)?;
    let road = map.lane_point(from.lane, s, 0.0)?;
    let mut lane: LaneId = from.lane;
    for _ in 0..LANES {
        lane = map.right_of(lane)?;
        let info = map.lane(lane)?;
        let stands = matches!(info.lane_type, LaneType::Sidewalk | LaneType::Shoulder | LaneType::Parking);
        let width_m = map.lane_width(lane, s)?;
        if stands && info.junction.is_none() && width_m >= LEAST_WIDTH_M {
            let walked = info.lane_type == LaneType::Sidewalk;
            let aside_m = if walked { (0.5 * width_m - KERB_M).max(0.0) } else { 0.0 };
            let places = [aside_m, -aside_m].map(|left_m| map.lane_point(lane, s, left_m));
            let near = |p: &opendrive::LanePoint| (p.position - road.position).norm();
            let foot = places.into_iter().flatten().min_by(|a, b| near(a).total_cmp(&near(b)))?;
            return Some((foot.position, road.heading_rad));
        }
        // Beyond the lanes of oncoming traffic nobody looks.
        if info.lane_type.is_drivable() && !map.same_direction(from.lane, lane) {
            return None;
        }
    }
    None
}

/// Whether a footprint is clear of something that stands in the scenery.
fn is_clear(own: &Footprint, other: &ActorRow) -> bool {
    footprint(other).is_none_or(|place| {
        let size_m = [2.0 * place.half_m[0], 2.0 * place.half_m[1], place.height_m];
        apart(own, &(place.xyz_m.into(), place.yaw_rad, size_m), CLEAR_M)
    })
}
