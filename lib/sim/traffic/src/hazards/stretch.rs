//! The length of lane that a hazard takes up.

use opendrive::{LaneId, LanePoint, LanePos, Map};
use schema::tables::PlanHazardRow;

/// A hazard's front is looked for this far ahead of its back, metres of way.
const LONGEST_M: f64 = 400.0;
/// Corners of a hazard's area follow the lane at this distance, metres.
const AREA_STEP_M: f64 = 0.4;

/// A length of lane from a hazard's back to its front.
pub(super) struct Stretch<'a> {
    pub(super) map: &'a Map,
    /// Lanes with the metres of s from the back to their beginning (the first one's is negative).
    pub(super) lanes: Vec<(LaneId, f64)>,
    /// Metres of s.
    pub(super) length_m: f64,
}

impl<'a> Stretch<'a> {
    /// None where the map has no such lanes, or no way leads from the back to the front.
    pub(super) fn of(map: &'a Map, row: &PlanHazardRow) -> Option<Self> {
        let from = lane_pos(map, &row.back_road, row.back_lane, row.back_s_m)?;
        let to = lane_pos(map, &row.front_road, row.front_lane, row.front_s_m)?;
        let way = map.route(from, to, LONGEST_M)?;
        let mut start_m = -from.along_m;
        let mut lanes = Vec::with_capacity(way.lanes.len());
        for id in way.lanes {
            lanes.push((id, start_m));
            start_m += map.lane(id)?.s_length();
        }
        let length_m = lanes.last()?.1 + to.along_m;
        Some(Self { map, lanes, length_m })
    }

    /// The place so many metres of s from the back, on the stretch, to the left of the lane's middle by a
    /// share of its width.
    pub(super) fn at(&self, way_m: f64, left: f64) -> Option<LanePoint> {
        let pos = self.pos(way_m)?;
        let s = self.map.s_of(pos)?;
        self.map.lane_point(pos.lane, s, left * self.map.lane_width(pos.lane, s)?)
    }

    /// The place of the lane graph so many metres of s from the back, on the stretch.
    pub(super) fn pos(&self, way_m: f64) -> Option<LanePos> {
        let way_m = way_m.clamp(0.0, self.length_m);
        let (lane, start_m) = *self.lanes.iter().rev().find(|(_, start_m)| *start_m <= way_m)?;
        Some(LanePos { lane, along_m: way_m - start_m })
    }

    /// The lane's surface from back to front: the left border onward, the right one back.
    pub(super) fn area(&self) -> Vec<[f64; 3]> {
        let steps = (self.length_m / AREA_STEP_M).ceil().max(1.0) as usize;
        let side = |left: f64| {
            let points = (0..=steps).map(move |k| self.at(self.length_m * k as f64 / steps as f64, left));
            points.flatten().map(|place| place.position.into()).collect::<Vec<[f64; 3]>>()
        };
        let mut area = side(0.5);
        area.extend(side(-0.5).into_iter().rev());
        area
    }
}

/// A place of the map by the names of a plan.
fn lane_pos(map: &Map, road: &str, lane: i32, s_m: f64) -> Option<LanePos> {
    let road = map.network().roads.iter().position(|r| r.id == road)? as u32;
    let lanes = map.lanes().iter().filter(|l| l.id.road == road && i32::from(l.id.lane) == lane);
    let info = lanes.min_by(|a, b| {
        let off = |l: &opendrive::LaneInfo| (l.s_start - s_m).max(s_m - l.s_end).max(0.0);
        off(a).total_cmp(&off(b))
    })?;
    Some(LanePos { lane: info.id, along_m: info.along_of_s(s_m.clamp(info.s_start, info.s_end)) })
}
