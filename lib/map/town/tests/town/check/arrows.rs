//! Arrows on lanes say where the lanes lead.

use std::collections::BTreeSet;

use frames::wrap_pi;
use opendrive::{LaneId, LanePoint, Map};

use super::{end_of, label};

/// Ways that differ from straight on by about this are called either, radians.
const BETWEEN_RAD: [f64; 2] = [0.55, 0.85];

pub(super) fn faults(map: &Map) -> Vec<String> {
    let mut faults = Vec::new();
    for arrow in map.objects().iter().filter(|o| o.is_arrow()) {
        let middle = arrow.pose.isometry().translation.vector.into();
        let Some(hit) = map.nearest_driving_lane(middle) else {
            faults.push(format!("arrow {} lies on no lane", arrow.id));
            continue;
        };
        let here = map.lane_point(hit.lane, hit.s, 0.0);
        let off_rad = here.map_or(9.0, |p| wrap_pi(p.heading_rad - arrow.pose.yaw()).abs());
        if hit.t_m.abs() > 0.05 || off_rad > 0.05 {
            let place = label(map, hit.lane);
            faults.push(format!("arrow {} is {:.2} m and {off_rad:.2} rad off {place}", arrow.id, hit.t_m));
        }
        for (wanted, leads) in ways(map, hit.lane) {
            if leads.is_some_and(|leads| leads != arrow.name.contains(wanted)) {
                faults.push(format!("{} {} on {}", arrow.name, arrow.id, label(map, hit.lane)));
            }
        }
    }
    faults
}

/// Whether a lane leads to the left, straight on, and to the right at the next junction, where that can be
/// told.
fn ways(map: &Map, lane: LaneId) -> [(&'static str, Option<bool>); 3] {
    let ahead = |lane: LaneId| map.successors(lane).iter().copied();
    // Streets are cut into sections before their end.
    let mut before = lane;
    while let Some(next) = ahead(before).next().filter(|next| map.junction_of(*next).is_none()) {
        before = next;
    }
    let end = |id: LaneId, leaving: bool| -> Option<LanePoint> {
        map.lane_point(id, end_of(map.lane(id)?, leaving), 0.0)
    };
    let mut turns = Vec::new();
    for first in ahead(before) {
        let mut last = first;
        while let Some(next) = ahead(last).next().filter(|next| map.junction_of(*next).is_some()) {
            last = next;
        }
        if let (Some(from), Some(to)) = (end(first, false), end(last, true)) {
            turns.push(wrap_pi(to.heading_rad - from.heading_rad));
        }
    }
    let told: BTreeSet<i32> = turns
        .iter()
        .filter(|turn| !(BETWEEN_RAD[0]..BETWEEN_RAD[1]).contains(&turn.abs()))
        .map(|turn| if turn.abs() < BETWEEN_RAD[0] { 0 } else { turn.signum() as i32 })
        .collect();
    let clear = turns.iter().all(|turn| !(BETWEEN_RAD[0]..BETWEEN_RAD[1]).contains(&turn.abs()));
    [("Left", 1), ("Straight", 0), ("Right", -1)]
        .map(|(word, way)| (word, clear.then_some(told.contains(&way))))
}
