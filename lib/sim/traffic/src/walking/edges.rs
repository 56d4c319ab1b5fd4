//! Road edges: where people walk beside roads that have no sidewalk.

use nalgebra::Point3;
use opendrive::{LaneInfo, LaneType, Map};

use crate::grid::Grid;
use crate::road::centreline::{Centreline, Sample};
use crate::road::net::Net;

/// Width of the strip that is walked on, and from the edge of the road's lanes to its middle, metres.
const WIDTH_M: f64 = 1.6;
const ASIDE_M: f64 = 1.1;
/// Nobody walks beside roads with a higher limit, m/s (90 km/h).
const FASTEST_MPS: f64 = 25.0;
/// Clear of lanes by this, metres.
const CLEAR_M: f64 = 0.2;
/// Ends nearer than this meet, metres.
const MET_M: f64 = 2.5;
/// Pieces shorter than this are left out, metres: of roads, and in junctions, where they join such of roads.
const LEAST_M: f64 = 10.0;
const LEAST_IN_JUNCTION_M: f64 = 2.0;

/// The lane that traffic has at the edge of a side of a section without sidewalk.
fn outermost(lanes: &[LaneInfo], left: bool) -> Option<&LaneInfo> {
    let side = || lanes.iter().filter(move |l| (l.id.lane > 0) == left && l.id.lane != 0);
    let has_sidewalk = side().any(|l| l.lane_type.is_walkable() && l.width_range_m[1] >= 1.0);
    let driven = side().filter(|l| l.lane_type.is_drivable()).max_by_key(|l| l.id.lane.unsigned_abs());
    let slow = driven?.speed_limit_mps.is_none_or(|limit| limit <= FASTEST_MPS);
    (!has_sidewalk && slow).then_some(driven?)
}

/// Width of what lies between a lane and where people can walk beside it, metres: they walk on shoulders.
fn beyond_m(lanes: &[LaneInfo], outermost: &LaneInfo) -> f64 {
    let farther = lanes.iter().filter(|l| {
        let (own, other) = (outermost.id.lane, l.id.lane);
        (own > 0) == (other > 0) && other.unsigned_abs() > own.unsigned_abs()
    });
    let used =
        farther.filter(|l| matches!(l.lane_type, LaneType::Parking | LaneType::Biking | LaneType::Stop));
    used.map(|l| l.width_range_m[1]).sum()
}

/// The edges of all roads that people walk along: outside the outermost lane, where no other lane lies and no
/// bridge or tunnel leaves the ground; in junctions those that lead from one such edge to another.
pub(crate) fn edges(map: &Map, net: &Net) -> Vec<Centreline> {
    let (mut of_roads, mut of_junctions) = (Vec::new(), Vec::new());
    for (road, facts) in map.network().roads.iter().enumerate() {
        if !facts.bridges.is_empty() || !facts.tunnels.is_empty() {
            continue;
        }
        let road = road as u32;
        for section in 0..map.section_count(road) as u16 {
            let lanes = map.lanes_of(road, section);
            for lane in [true, false].into_iter().filter_map(|left| outermost(lanes, left)) {
                let outwards = f64::from(lane.id.lane.signum()) * lane.direction;
                let aside_m = ASIDE_M + beyond_m(lanes, lane);
                let line = Centreline::beside(map, lane, &|width_m| outwards * (0.5 * width_m + aside_m));
                let clear = |s: &Sample| net.lanes_at(&s.point, CLEAR_M).is_empty();
                let (found, least_m) = match lane.junction {
                    None => (&mut of_roads, LEAST_M),
                    Some(_) => (&mut of_junctions, LEAST_IN_JUNCTION_M),
                };
                found.extend(line.iter().flat_map(|line| line.parts(&clear, least_m, WIDTH_M)));
            }
        }
    }
    let ends: Vec<Point3<f64>> = of_roads.iter().flat_map(|way| [way.start(), way.end()]).collect();
    let mut grid = Grid::new(MET_M);
    grid.fill(ends.iter().enumerate().map(|(i, end)| ([end.x, end.y], i)));
    let is_met = |at: Point3<f64>| grid.around(at.x, at.y).any(|i| (ends[i] - at).norm() < MET_M);
    of_junctions.retain(|way| is_met(way.start()) && is_met(way.end()));
    of_roads.append(&mut of_junctions);
    of_roads
}
