//! Routes that a user gave, as places on lanes that lead on from one to the next.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, LanePos, Map};
use schema::AgentId;
use schema::tables::PlanRouteRow;
use settings::GivenRoute;

use crate::PlanError;
use crate::pool::SpawnPoint;

/// A point of a route lies this near to the centre line of its lane, metres.
const REACH_M: f64 = 5.0;
/// A change of lanes counts as so much way, metres.
const CHANGE_M: f64 = 60.0;

/// A place that a vehicle passes.
#[derive(Clone, Copy, Debug)]
struct RoutePlace {
    pos: LanePos,
    s: f64,
    at: Point3<f64>,
}

/// A route with its places resolved.
#[derive(Clone, Debug)]
pub(crate) struct PlannedRoute {
    pub(crate) agent: AgentId,
    pub(crate) start: SpawnPoint,
    places: Vec<RoutePlace>,
}

impl PlannedRoute {
    /// Its rows for a scene.
    pub(crate) fn rows(&self, map: &Map, scene: u32) -> Vec<PlanRouteRow> {
        let roads = &map.network().roads;
        let row = |(number, place): (usize, &RoutePlace)| PlanRouteRow {
            scene,
            agent: self.agent,
            number: number as u32,
            road: roads.get(place.pos.lane.road as usize).map_or(String::new(), |road| road.id.clone()),
            lane: i32::from(place.pos.lane.lane),
            s_m: place.s,
            xyz_m: place.at.coords.into(),
        };
        self.places.iter().enumerate().map(row).collect()
    }
}

/// Finds the lanes of a route: of all that its places may mean, those with the shortest way over them.
///
/// # Errors
/// There is no lane at a place, no way to it from the one before, or no room to start.
pub(crate) fn resolve(map: &Map, route: &GivenRoute) -> Result<PlannedRoute, PlanError> {
    let fault =
        |problem: String| PlanError::Route { map: route.map.clone(), agent: route.agent.clone(), problem };
    let agent = route.vehicle().ok_or_else(|| fault("is no vehicle".into()))?;
    let mut candidates: Vec<Vec<RoutePlace>> = Vec::new();
    for (number, point) in route.points_m.iter().enumerate() {
        let hits = map.lanes_within((*point).into(), REACH_M, |lane| lane.lane_type.is_drivable());
        let place = |hit: &opendrive::LaneHit| place_at(map, hit.lane, map.lane(hit.lane)?.along_of_s(hit.s));
        let places: Vec<RoutePlace> = hits.iter().filter_map(place).collect();
        if places.is_empty() {
            return Err(fault(format!(
                "no driving lane lies within {REACH_M} m of point {number}, {point:?}"
            )));
        }
        candidates.push(places);
    }
    for written in &route.lanes {
        let (road, lane) =
            GivenRoute::lane(written).ok_or_else(|| fault(format!("`{written}` is no lane")))?;
        let is_meant = |info: &&LaneInfo| {
            let id = map.network().roads.get(info.id.road as usize).map(|road| road.id.as_str());
            id == Some(road) && info.id.lane == lane && info.lane_type.is_drivable()
        };
        let meant = map.lanes().iter().filter(is_meant);
        let places: Vec<RoutePlace> =
            meant.filter_map(|info| place_at(map, info.id, 0.5 * info.s_length())).collect();
        if places.is_empty() {
            return Err(fault(format!("there is no driving lane `{written}`")));
        }
        candidates.push(places);
    }
    if candidates.len() < 2 {
        return Err(fault("has fewer than two places".into()));
    }
    // Vehicles start where they can stand.
    candidates[0].retain(|place| {
        map.junction_of(place.pos.lane).is_none() && SpawnPoint::at(map, place.pos).is_some()
    });
    if candidates[0].is_empty() {
        return Err(fault("begins in a junction, or on a lane that is too narrow to start on".into()));
    }
    let places = shortest(map, &candidates).map_err(|number| {
        let (from, to) = (number - 1, number);
        fault(format!("no way leads from place {from} to place {to} along the lanes, lane changes included"))
    })?;
    let start = SpawnPoint::at(map, places[0].pos).ok_or_else(|| fault("has no room to start".into()))?;
    Ok(PlannedRoute { agent, start, places })
}

fn place_at(map: &Map, lane: LaneId, along_m: f64) -> Option<RoutePlace> {
    let pos = LanePos { lane, along_m };
    Some(RoutePlace { pos, s: map.s_of(pos)?, at: map.point_at(pos)?.position })
}

/// One candidate of each place, so that the way over them is shortest; else the first place that no way leads
/// to.
fn shortest(map: &Map, candidates: &[Vec<RoutePlace>]) -> Result<Vec<RoutePlace>, usize> {
    // Way to each candidate of a place, and the candidate of the place before on it.
    let mut legs: Vec<Vec<Option<(f64, usize)>>> = vec![vec![Some((0.0, 0)); candidates[0].len()]];
    for (number, pair) in candidates.windows(2).enumerate() {
        let mut best: Vec<Option<(f64, usize)>> = vec![None; pair[1].len()];
        for (k, from) in pair[0].iter().enumerate() {
            let Some((before_m, _)) = legs[number][k] else { continue };
            let ways = ways_m(map, from.pos);
            for (j, to) in pair[1].iter().enumerate() {
                let Some(way_m) = way_to(map, &ways, from.pos, to.pos) else { continue };
                let sum_m = before_m + way_m;
                if best[j].is_none_or(|(known_m, _)| sum_m < known_m) {
                    best[j] = Some((sum_m, k));
                }
            }
        }
        if best.iter().all(Option::is_none) {
            return Err(number + 1);
        }
        legs.push(best);
    }
    let way_of = |leg: &Option<(f64, usize)>| leg.map_or(f64::INFINITY, |(way_m, _)| way_m);
    let ends = &legs[legs.len() - 1];
    let mut at = (0..ends.len()).min_by(|a, b| way_of(&ends[*a]).total_cmp(&way_of(&ends[*b]))).unwrap_or(0);
    let mut chosen = Vec::new();
    for (leg, places) in legs.iter().zip(candidates).rev() {
        chosen.push(places[at]);
        at = leg[at].map_or(0, |(_, before)| before);
    }
    chosen.reverse();
    Ok(chosen)
}

/// The way from a place to the beginning of every lane that it leads to, metres.
fn ways_m(map: &Map, from: LanePos) -> BTreeMap<LaneId, f64> {
    let length_m = |lane: LaneId| map.lane(lane).map_or(0.0, |info| info.length_m);
    let mut ways: BTreeMap<LaneId, f64> = BTreeMap::new();
    // Ways are not negative: their bits sort as they do.
    let mut open = BTreeSet::from([(0_u64, from.lane, false)]);
    // Lanes beside the place, by changes alone: what lies before it there is not reached.
    let mut beside_place = BTreeSet::new();
    while let Some((bits, lane, is_entered)) = open.pop_first() {
        let way_m = f64::from_bits(bits);
        let is_known = match is_entered {
            true => ways.get(&lane).is_some_and(|known| *known <= way_m),
            false => !beside_place.insert(lane),
        };
        if is_known {
            continue;
        }
        let rest_m = if is_entered {
            ways.insert(lane, way_m);
            length_m(lane)
        } else {
            (length_m(lane) - from.along_m).max(0.0)
        };
        for next in map.successors(lane) {
            open.insert(((way_m + rest_m).to_bits(), *next, true));
        }
        for beside in [map.left_of(lane), map.right_of(lane)].into_iter().flatten() {
            let drives = map.lane(beside).is_some_and(|info| info.lane_type.is_drivable());
            if drives && map.same_direction(lane, beside) && map.junction_of(lane).is_none() {
                open.insert(((way_m + CHANGE_M).to_bits(), beside, is_entered));
            }
        }
    }
    ways
}

/// The way from one place to another, metres.
fn way_to(map: &Map, ways: &BTreeMap<LaneId, f64>, from: LanePos, to: LanePos) -> Option<f64> {
    let (own, other) = (from.lane, to.lane);
    let is_ahead = own.road == other.road && own.section == other.section && map.same_direction(own, other);
    if is_ahead && to.along_m > from.along_m {
        let changes = f64::from((own.lane - other.lane).abs());
        return Some(to.along_m - from.along_m + CHANGE_M * changes);
    }
    ways.get(&to.lane).map(|way_m| way_m + to.along_m)
}
