//! What must hold of any road network, found out from the network alone: nothing here knows how towns are
//! built.
//!
//! Every function returns what is wrong, one line a fault, so that a whole town can be judged at once.
#![allow(dead_code, reason = "each test program uses its part")]

mod arrows;
mod curves;
mod paving;
mod signals;
mod surfaces;
mod words;

use opendrive::{LaneId, LaneInfo, LaneType, Map, Network, write};
use std::collections::BTreeSet;

/// Everything that is wrong with a network.
pub(crate) fn faults(network: &Network) -> Vec<String> {
    let mut faults = round_trip(network);
    faults.extend(curves::faults(network));
    let map = Map::new(network.clone());
    faults.extend(links(&map));
    faults.extend(graph(&map));
    faults.extend(surfaces::faults(&map));
    faults.extend(paving::faults(&map));
    faults.extend(signals::faults(&map));
    faults.extend(arrows::faults(&map));
    faults.extend(words::faults(&map));
    faults
}

/// Stops with the first faults of a network, if it has any.
pub(crate) fn check(name: &str, network: &Network) {
    let faults = faults(network);
    let shown: Vec<&String> = faults.iter().take(25).collect();
    assert!(faults.is_empty(), "{name}: {} faults: {shown:#?}", faults.len());
}

fn round_trip(network: &Network) -> Vec<String> {
    let text = write(network);
    let back = match Network::parse(&text) {
        Ok(back) => back,
        Err(error) => return vec![format!("cannot be read back: {error}")],
    };
    let mut faults: Vec<String> = back.warnings.iter().map(|w| format!("reader warns: {w:?}")).collect();
    if back.roads != network.roads || back.junctions != network.junctions {
        faults.push("changed by writing and reading".into());
    }
    if write(&back) != text {
        faults.push("written differently the second time".into());
    }
    faults
}

/// End of a lane in its direction of travel.
fn end_of(lane: &LaneInfo, leaving: bool) -> f64 {
    if (lane.direction > 0.0) == leaving { lane.s_end } else { lane.s_start }
}

/// Name of a lane for messages.
fn label(map: &Map, id: LaneId) -> String {
    let road = &map.network().roads[id.road as usize];
    format!("lane {} of section {} of road {} `{}`", id.lane, id.section, road.id, road.name)
}

/// Lanes that follow one another meet: both borders within a centimetre, directions and slopes alike.
fn links(map: &Map) -> Vec<String> {
    let mut faults = Vec::new();
    let mut count = 0;
    for lane in map.lanes() {
        for next in map.successors(lane.id) {
            let Some(to) = map.lane(*next) else { continue };
            let (sa, sb) = (end_of(lane, true), end_of(to, false));
            let (Some(a), Some(b)) = (map.lane_bounds(lane.id, sa), map.lane_bounds(to.id, sb)) else {
                faults.push(format!("{} has no borders", label(map, lane.id)));
                continue;
            };
            let gap = (a.left - b.left).norm().max((a.right - b.right).norm());
            let place = || format!("from {} to {}", label(map, lane.id), label(map, *next));
            if gap > 0.01 {
                faults.push(format!("borders are {gap:.3} m apart {}", place()));
            }
            let (Some(p), Some(q)) = (map.lane_point(lane.id, sa, 0.0), map.lane_point(to.id, sb, 0.0))
            else {
                continue;
            };
            let turn = frames::wrap_pi(p.heading_rad - q.heading_rad).abs();
            if turn > 1e-3 {
                faults.push(format!("kink of {turn:.4} rad {}", place()));
            }
            if (p.pitch_rad - q.pitch_rad).abs() > 2e-3 {
                faults.push(format!("crease of {:.4} rad {}", p.pitch_rad - q.pitch_rad, place()));
            }
            if lane.lane_type.is_drivable() != to.lane_type.is_drivable() {
                faults.push(format!("{:?} goes on as {:?} {}", lane.lane_type, to.lane_type, place()));
            }
            count += 1;
        }
    }
    if count < map.network().roads.len() {
        faults.push(format!("only {count} links"));
    }
    faults
}

/// Every driving lane leads on, and every one is reached from every other one, with changes of lane.
fn graph(map: &Map) -> Vec<String> {
    let driving: Vec<LaneId> =
        map.lanes().iter().filter(|l| l.lane_type == LaneType::Driving).map(|l| l.id).collect();
    let mut faults: Vec<String> = driving
        .iter()
        .filter(|lane| map.successors(**lane).is_empty())
        .map(|lane| format!("{} leads nowhere", label(map, *lane)))
        .collect();
    let beside = |lane: LaneId| {
        let own = map.lane(lane).map(|l| l.direction);
        [map.left_of(lane), map.right_of(lane)]
            .into_iter()
            .flatten()
            .filter(move |other| {
                let other = map.lane(*other);
                other.map(|l| l.direction) == own && other.is_some_and(|l| l.lane_type == LaneType::Driving)
            })
            .collect::<Vec<LaneId>>()
    };
    let Some(start) = driving.first() else { return vec!["no driving lanes".into()] };
    for (name, forward) in [("is reached from nowhere", true), ("reaches nothing", false)] {
        let mut seen = BTreeSet::from([*start]);
        let mut stack = vec![*start];
        while let Some(lane) = stack.pop() {
            let next = if forward { map.successors(lane) } else { map.predecessors(lane) };
            for lane in next.iter().copied().chain(beside(lane)) {
                if seen.insert(lane) {
                    stack.push(lane);
                }
            }
        }
        let lost = driving.iter().filter(|lane| !seen.contains(*lane));
        faults.extend(lost.map(|lane| format!("{} {name}", label(map, *lane))));
    }
    faults
}
