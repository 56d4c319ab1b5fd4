//! Ways along the lane graph: how far, and what comes first.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::{LaneId, LaneInfo, LanePos, Map};
use crate::model::RoadLink;

/// Nodes and weights of the 4-point Gauss-Legendre rule on [-1, 1] (positive half).
const GAUSS: [(f64, f64); 2] =
    [(0.339_981_043_584_856_3, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_8)];
/// Longest panel of the rule, metres of s.
const PANEL_M: f64 = 8.0;
/// Most panels between two records; absurd lengths only lose accuracy.
const MAX_PANELS: f64 = 4096.0;

/// What a search ahead has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead<T> {
    /// What it is.
    pub what: T,
    /// The way there along the lanes' centre lines, metres.
    pub way_m: f64,
    /// Where it is.
    pub pos: LanePos,
    /// The lanes on the way, the first and the last included.
    pub lanes: Vec<LaneId>,
}

/// A lane that a search has entered, and its entry in the list of such lanes that it was entered from.
type Step = (usize, Option<usize>);

impl Map {
    /// The way along a lane's centre line between two values of s (either order), metres: the integral of
    /// [`LanePoint::metres_per_s`](super::LanePoint::metres_per_s), to a micrometre on roads as they are
    /// built.
    #[must_use]
    pub fn lane_way_m(&self, id: LaneId, s_from: f64, s_to: f64) -> Option<f64> {
        let info = self.lane(id)?;
        let (from, to) = (s_from.min(s_to).max(info.s_start), s_from.max(s_to).min(info.s_end));
        let (mut sum, mut low) = (0.0, from);
        for high in self.breaks(id.road, id.section) {
            let high = high.min(to);
            if high <= low {
                continue;
            }
            let panels = ((high - low) / PANEL_M).ceil().clamp(1.0, MAX_PANELS);
            let half = 0.5 * (high - low) / panels;
            for i in 0..panels as usize {
                let middle = low + (2 * i + 1) as f64 * half;
                for (node, weight) in GAUSS {
                    for s in [middle - half * node, middle + half * node] {
                        sum += weight * half * self.centre_at(id, s)?.1.norm();
                    }
                }
            }
            low = high;
        }
        Some(sum)
    }

    /// The first thing ahead on the lane graph, at most `limit_m` metres of way from a place.
    ///
    /// `find` is asked lane by lane, with the place from which on it should look (metres of s from the lane's
    /// beginning), and answers with the first thing it finds there and its place. Of all branches the
    /// shortest way wins; equal ways are told apart by the order of lanes. Lane changes are no part of a way.
    pub fn first_ahead<T>(
        &self,
        from: LanePos,
        limit_m: f64,
        mut find: impl FnMut(LaneId, f64) -> Option<(f64, T)>,
    ) -> Option<Ahead<T>> {
        let start = self.lane_index(from.lane)?;
        let first_along = from.along_m.clamp(0.0, self.lanes[start].s_length());
        if first_along.is_nan() || limit_m.is_nan() {
            return None;
        }
        let mut steps: Vec<Step> = Vec::new();
        let mut best: Option<(Ahead<T>, usize)> = None;
        // The way to a lane's beginning (as the bits of a number that is not negative, which sort like it),
        // the lane, and the step it is entered from.
        let mut open = BinaryHeap::from([Reverse((0_u64, start, None))]);
        let mut entered = BTreeSet::new();
        while let Some(Reverse((entry_bits, lane, parent))) = open.pop() {
            let entry_m = f64::from_bits(entry_bits);
            if entry_m > best.as_ref().map_or(limit_m, |(b, _)| b.way_m) {
                break;
            }
            // A loop may lead back to the start lane, and then to the part of it that lies behind.
            let along = if parent.is_none() { first_along } else { 0.0 };
            if parent.is_some() && !entered.insert(lane) {
                continue;
            }
            let step = steps.len();
            steps.push((lane, parent));
            let info = &self.lanes[lane];
            let way = |to: f64| self.lane_way_m(info.id, info.s_of_along(along), info.s_of_along(to));
            if let Some((place, what)) = find(info.id, along) {
                let pos = LanePos { lane: info.id, along_m: place.clamp(along, info.s_length()) };
                let way_m = entry_m + way(pos.along_m)?;
                if way_m <= limit_m && best.as_ref().is_none_or(|(b, _)| way_m < b.way_m) {
                    best = Some((Ahead { what, way_m, pos, lanes: Vec::new() }, step));
                }
                continue;
            }
            let exit_m = entry_m + way(info.s_length())?;
            for after in self.graph.successors(lane).iter().filter_map(|id| self.lane_index(*id)) {
                if exit_m <= limit_m && !entered.contains(&after) {
                    open.push(Reverse((exit_m.to_bits(), after, Some(step))));
                }
            }
        }
        let (mut ahead, step) = best?;
        let mut at = Some(step);
        while let Some((lane, parent)) = at.map(|i| steps[i]) {
            ahead.lanes.push(self.lanes[lane].id);
            at = parent;
        }
        ahead.lanes.reverse();
        Some(ahead)
    }

    /// The shortest way from one place to another along the lane graph, without lane changes; none where no
    /// way of at most `limit_m` metres leads there.
    #[must_use]
    pub fn route(&self, from: LanePos, to: LanePos, limit_m: f64) -> Option<Ahead<()>> {
        let here = |lane, along| (lane == to.lane && to.along_m >= along).then_some((to.along_m, ()));
        self.first_ahead(from, limit_m, here)
    }

    /// How far ahead of a place another one lies along the lane graph, metres of way, up to `limit_m`. How
    /// far it lies behind: the same with the two exchanged.
    #[must_use]
    pub fn distance_ahead(&self, from: LanePos, to: LanePos, limit_m: f64) -> Option<f64> {
        Some(self.route(from, to, limit_m)?.way_m)
    }

    /// The next junction ahead, with its index: where travel enters its first lane, or, for a junction
    /// without connecting roads, the end of the lane before it. From inside a junction the one after it.
    #[must_use]
    pub fn junction_ahead(&self, from: LanePos, limit_m: f64) -> Option<Ahead<usize>> {
        let own = self.lane(from.lane)?.junction;
        self.first_ahead(from, limit_m, |id, along| {
            let lane = self.lane(id)?;
            match lane.junction {
                Some(junction) if Some(junction) != own => Some((along, junction)),
                _ => self.junction_at_end(lane).map(|junction| (lane.s_length(), junction)),
            }
        })
    }

    /// The junction that a lane's road is linked to where travel leaves the lane.
    fn junction_at_end(&self, lane: &LaneInfo) -> Option<usize> {
        let road = self.road(lane.id.road);
        let along = lane.direction > 0.0;
        let last = if along { self.section_count(lane.id.road).checked_sub(1)? } else { 0 };
        let link = if along { &road.successor } else { &road.predecessor };
        match link {
            Some(RoadLink::Junction { id }) if usize::from(lane.id.section) == last => {
                self.network.junctions.iter().position(|j| j.id == *id)
            }
            _ => None,
        }
    }
}
