//! Where the warning sign of a hazard stands: beside the road, some way before it.

use nalgebra::Point3;
use opendrive::{LaneId, LanePoint, LanePos, LaneType, Map};
use random::Stream;
use schema::tables::ActorRow;
use schema::works::Item;

use super::thing::{Spot, Thing};
use crate::spawn::{Footprint, Taken, apart};

/// Way from the sign to the hazard, metres.
const BEFORE_M: [f64; 2] = [40.0, 160.0];
/// The face is turned by up to so much, degrees.
const TURN_DEG: f64 = 10.0;
/// Strips beside the road on which signs stand are at least so wide, metres.
const LEAST_WIDTH_M: f64 = 1.0;
/// Lanes to the right that are looked at.
const LANES: usize = 11;
/// Places that are tried where something else stands.
const TRIES: usize = 4;
/// Half a pole or a trunk with some room around it, metres.
const POLE_M: [f64; 3] = [0.5, 0.5, 1.0];

/// A sign before a hazard that begins at `at`; none where no strip beside the road is wide enough, or all is taken.
pub(super) fn before(
    map: &Map,
    at: LanePos,
    (sign, meaning): (Item, &'static str),
    draw: &mut Stream,
    taken: &Taken,
    fixed: &[ActorRow],
) -> Option<Thing> {
    (0..TRIES).find_map(|_| {
        let way_m = draw.uniform(BEFORE_M[0], BEFORE_M[1]);
        let turn_rad = draw.uniform(-TURN_DEG, TURN_DEG).to_radians();
        let from = map.behind(at, way_m).first().copied().unwrap_or(at);
        let (foot, heading_rad) = strip(map, from)?;
        // The face looks at those who come.
        let spot = Spot::upright(foot.position, heading_rad + std::f64::consts::PI + turn_rad);
        let thing = Thing::sign(sign, meaning, &spot);
        let (point, yaw_rad, size_m) = thing.footprint();
        let free = taken.is_free(&point, yaw_rad, size_m)
            && fixed.iter().all(|other| is_clear(&(point, yaw_rad, size_m), other));
        free.then_some(thing)
    })
}

/// The middle of the first sidewalk, shoulder or parking lane that is wide enough, to the right of a place on a lane; and
/// the heading of traffic there.
///
/// Kerbs, verges and cycle lanes are passed over, which the published rule does not have: ours are lanes of their own.
fn strip(map: &Map, from: LanePos) -> Option<(LanePoint, f64)> {
    let s = map.s_of(from)?;
    let heading_rad = map.lane_point(from.lane, s, 0.0)?.heading_rad;
    let mut lane: LaneId = from.lane;
    for _ in 0..LANES {
        lane = map.right_of(lane)?;
        let info = map.lane(lane)?;
        let stands = matches!(info.lane_type, LaneType::Sidewalk | LaneType::Shoulder | LaneType::Parking);
        if stands && info.junction.is_none() && map.lane_width(lane, s)? >= LEAST_WIDTH_M {
            return Some((map.lane_point(lane, s, 0.0)?, heading_rad));
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
    let at = Point3::from(other.xyz_m);
    let reach = 0.5 * (other.length_m * other.length_m + other.width_m * other.width_m).sqrt() + 2.0;
    if other.kind == "surface" || (at - own.0).xy().norm() > reach {
        return true;
    }
    let whole = matches!(other.kind.as_str(), "parked" | "building" | "prop");
    let size_m = if whole { [other.length_m, other.width_m, other.height_m] } else { POLE_M };
    let [w, x, y, z] = other.quaternion;
    let yaw_rad = frames::math::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    apart(own, &(at, yaw_rad, size_m), 0.1)
}
