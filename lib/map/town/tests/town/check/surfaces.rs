//! Lanes do not lie over one another where they must not.

use opendrive::{LaneId, LaneInfo, LaneType, Map};

use super::label;

/// Roads this far above each other do not meet, metres.
const LEVELS_M: f64 = 4.5;
/// Lanes are looked at this often along their length, metres.
const STEP_M: f64 = 3.0;
/// Within this distance of a lane's end its neighbours may touch it, metres.
const END_M: f64 = 0.6;

pub(super) fn faults(map: &Map) -> Vec<String> {
    let mut faults = Vec::new();
    let driving = |l: &LaneInfo| l.lane_type == LaneType::Driving;
    for lane in map.lanes() {
        if driving(lane) && lane.junction.is_none() {
            // No other road's driving lane on the same level, junctions left out.
            let other = |l: &LaneInfo| driving(l) && l.junction.is_none() && l.id.road != lane.id.road;
            if let Some(hit) = overlap(map, lane, other) {
                faults.push(format!("{} lies over {}", label(map, lane.id), label(map, hit)));
            }
        } else if lane.lane_type.is_walkable() {
            let other = |l: &LaneInfo| driving(l) && l.id.road != lane.id.road;
            if let Some(hit) = overlap(map, lane, other) {
                faults.push(format!("sidewalk {} lies over {}", label(map, lane.id), label(map, hit)));
            }
        }
    }
    faults
}

/// A lane over which another lane's middle or inner part lies on the same level.
fn overlap(map: &Map, lane: &LaneInfo, other: impl Fn(&LaneInfo) -> bool) -> Option<LaneId> {
    let length = lane.s_end - lane.s_start;
    let count = (length / STEP_M).ceil().max(1.0) as u32;
    for i in 0..=count {
        let s = lane.s_start + length * f64::from(i) / f64::from(count);
        let middle = map.lane_point(lane.id, s, 0.0)?;
        for part in [-0.35, 0.0, 0.35] {
            let point = map.lane_point(lane.id, s, part * middle.width_m)?.position;
            for hit in map.lanes_within(point, 8.0, &other) {
                let Some(under) = map.lane(hit.lane) else { continue };
                let Some(on) = map.lane_point(hit.lane, hit.s, hit.t_m) else { continue };
                let d = on.position - point;
                let here = (d.x * d.x + d.y * d.y).sqrt() < 0.05 && hit.t_m.abs() < 0.5 * hit.width_m - 0.05;
                let inner = hit.s > under.s_start + END_M && hit.s < under.s_end - END_M;
                if here && inner && d.z.abs() < LEVELS_M {
                    return Some(hit.lane);
                }
            }
        }
    }
    None
}
