//! A route that the user gave: lanes to pass, and the shortest way to each of them.

use std::collections::{BTreeSet, VecDeque};

use opendrive::Map;
use schema::AgentId;
use schema::tables::PlanRouteRow;

use crate::road::net::Net;

/// A change of lanes counts as so much way, metres.
const CHANGE_M: f64 = 60.0;

/// A lane to pass.
#[derive(Debug)]
struct Target {
    lane: usize,
    /// Way from the beginning of each lane to that of this one, metres; infinite where none leads to it.
    ways_m: Vec<f64>,
}

/// The lanes that are still to be passed, in order.
#[derive(Debug)]
pub(crate) struct GivenRoute {
    targets: VecDeque<Target>,
    /// It has left where it started, and may come to that lane again.
    is_under_way: bool,
}

impl GivenRoute {
    /// The route of an agent, if it has one; the first place is where it starts.
    pub(crate) fn of(net: &Net, map: &Map, rows: &[PlanRouteRow], agent: AgentId) -> Option<Self> {
        let own = rows.iter().filter(|row| row.agent == agent);
        let mut places: Vec<(usize, f64)> = own.filter_map(|row| place_of(net, map, row)).collect();
        // Further on along the same lane: it comes there anyway. Farther back: on another round.
        places.dedup_by(|next, before| {
            let is_ahead = next.0 == before.0 && next.1 >= before.1;
            if is_ahead {
                before.1 = next.1;
            }
            is_ahead
        });
        let targets = places.iter().skip(1).map(|&(lane, _)| Target { lane, ways_m: ways_m(net, lane) });
        (!places.is_empty()).then(|| Self { targets: targets.collect(), is_under_way: false })
    }

    /// It has come to a lane.
    pub(super) fn pass(&mut self, lane: usize) {
        let starts = !std::mem::replace(&mut self.is_under_way, true);
        if !starts && self.targets.front().is_some_and(|target| target.lane == lane) {
            self.targets.pop_front();
        }
    }

    /// Whether a lane is still to be passed.
    pub(super) fn goes_on(&self) -> bool {
        !self.targets.is_empty()
    }

    /// Whether a way leads on from a lane, or none does from that which it is on either.
    pub(super) fn may_use(&self, lane: usize, own: usize) -> bool {
        let leads_on =
            |lane: usize| self.targets.front().is_none_or(|target| target.ways_m[lane].is_finite());
        leads_on(lane) || !leads_on(own)
    }

    /// The way to the next lane that is to be passed after some lanes, from the beginning of each lane.
    fn ways_after<'a>(&self, lanes: impl Iterator<Item = &'a usize>) -> Option<&[f64]> {
        let mut targets = self.targets.iter().peekable();
        for lane in lanes {
            let _ = targets.next_if(|target| target.lane == *lane);
        }
        targets.next().map(|target| target.ways_m.as_slice())
    }

    /// Where to go on after some lanes ahead, the last of which leads to some others: none where it does not
    /// matter any more, or no way leads on.
    pub(super) fn next<'a>(&self, lanes: impl Iterator<Item = &'a usize>, onward: &[usize]) -> Option<usize> {
        let ways_m = self.ways_after(lanes)?;
        let best = onward.iter().copied().min_by(|a, b| ways_m[*a].total_cmp(&ways_m[*b]))?;
        ways_m[best].is_finite().then_some(best)
    }

    /// The lane beside that it should change to from the lane that it is on: the way is shorter from there.
    pub(super) fn beside(&self, net: &Net, lane: usize) -> Option<usize> {
        let ways_m = self.ways_after(std::iter::empty())?;
        let own = &net.lanes[lane];
        let onward_m = own.next.iter().map(|next| ways_m[*next]).fold(f64::INFINITY, f64::min);
        let stays_m = own.centre.length_m + onward_m;
        let beside = own.beside.iter().flatten().map(|beside| beside.lane);
        let best = beside.min_by(|a, b| ways_m[*a].total_cmp(&ways_m[*b]))?;
        (ways_m[best] + CHANGE_M < stays_m).then_some(best)
    }
}

/// The lane of a row, and metres along it.
fn place_of(net: &Net, map: &Map, row: &PlanRouteRow) -> Option<(usize, f64)> {
    let roads = &map.network().roads;
    let is_meant = |info: &&opendrive::LaneInfo| {
        i32::from(info.id.lane) == row.lane
            && (info.s_start..=info.s_end).contains(&row.s_m)
            && roads.get(info.id.road as usize).is_some_and(|road| road.id == row.road)
    };
    let lane = net.find(map.lanes().iter().find(is_meant)?.id)?;
    Some((lane, net.lanes[lane].centre.project(row.xyz_m.into()).0))
}

/// The shortest way from the beginning of each lane to that of one, metres (Dijkstra, backwards).
fn ways_m(net: &Net, target: usize) -> Vec<f64> {
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); net.lanes.len()];
    for (lane, facts) in net.lanes.iter().enumerate() {
        facts.beside.iter().flatten().for_each(|other| beside[other.lane].push(lane));
    }
    let mut ways = vec![f64::INFINITY; net.lanes.len()];
    // Ways are not negative: their bits sort as they do.
    let mut open = BTreeSet::from([(0_u64, target)]);
    while let Some((bits, lane)) = open.pop_first() {
        let way_m = f64::from_bits(bits);
        if way_m >= ways[lane] {
            continue;
        }
        ways[lane] = way_m;
        let before = net.lanes[lane].previous.iter().map(|&p| (p, way_m + net.lanes[p].centre.length_m));
        let changed = beside[lane].iter().map(|&b| (b, way_m + CHANGE_M));
        open.extend(before.chain(changed).map(|(lane, way_m)| (way_m.to_bits(), lane)));
    }
    ways
}
