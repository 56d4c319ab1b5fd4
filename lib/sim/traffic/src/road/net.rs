//! The driving lanes as a graph with everything drivers ask about, computed once per scene.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, Map, VEHICLE_LANE_WIDTH_M};

use crate::car_following::envelope;
use crate::road::centreline::{Centreline, Sample, heading};
use crate::road::links::{join_ends, links};
use crate::road::sides::{Beside, Side, beside};

/// Speed limit where the map states none, m/s.
const DEFAULT_LIMIT_MPS: f64 = 50.0 / 3.6;
/// Sideways acceleration that drivers accept in curves, m/s2.
const CURVE_ACCELERATION: f64 = 3.0;
/// Ways that turn by less are straight, radians per metre.
const STRAIGHT: f64 = 1e-4;
/// Nobody goes slower for a bend, m/s.
const SLOWEST_MPS: f64 = 1.5;
/// Braking before curves and lower limits, m/s2.
pub(crate) const PLANNED_BRAKING: f64 = 2.0;
/// Centre lines nearer than this cannot be driven at the same time by any two vehicles, metres.
pub(crate) const CONFLICT_M: f64 = 3.0;
/// Centre lines nearer than these are too near for pairs of narrower and of wider vehicles, metres; the last
/// holds for the longest ones.
const NEAR_M: [f64; 3] = [CONFLICT_M, 4.7, 6.5];
/// Pieces between two lanes of a junction that are shorter than this in all do not part them, metres.
const SHORT_M: f64 = 5.0;
/// Ways that end nearer to each other than this lead into the same lane, metres.
const MERGE_M: f64 = 0.5;
/// Lanes farther above each other than this do not meet, metres.
const DECK_M: f64 = 3.0;
/// Drivers stop this far before a line, metres.
const LINE_GAP_M: f64 = 2.5;
/// They stop this far before it where a tight turn ends beside it: long vehicles swing out there, metres.
const SWING_GAP_M: f64 = 8.5;
/// A turn ends beside a line within this distance, metres.
const BESIDE_LINE_M: f64 = 6.5;
/// Bends tighter than this, outside junctions, are shared like junctions: long vehicles there need their
/// neighbours' lanes, too. Metres.
const TIGHT_BEND_M: f64 = 22.0;
/// Longest inner lane of a bend that is shared like a junction, metres.
const LONGEST_BEND_M: f64 = 60.0;
/// A long vehicle's rear has come round after this way in a bend: two half wheelbases, metres.
const SWING_M: f64 = 6.0;
/// Cell of the grid of lane samples, metres.
const CELL_M: f64 = 4.0;
/// A way through a junction that turns by more than this is a turn, radians.
const TURN_RAD: f64 = 0.6;

/// Where two lanes are too near each other: from and to, metres along each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zone {
    pub(crate) own_m: [f64; 2],
    pub(crate) other_m: [f64; 2],
}

/// A lane of the same junction that must not be driven at the same time, at least not by long vehicles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConflictArea {
    pub(crate) other: usize,
    /// Smallest distance between the two centre lines, metres.
    apart_m: f64,
    /// For each of the distances of [`NEAR_M`].
    zones: [Zone; 3],
    /// Both lead into the same lane.
    pub(crate) merges: bool,
}

impl ConflictArea {
    /// Where two vehicles that need so much room together, in half widths, cannot be at the same time.
    pub(crate) fn zone(&self, together_m: f64) -> Option<Zone> {
        let wide = NEAR_M.iter().position(|near| together_m <= *near).unwrap_or(NEAR_M.len() - 1);
        (self.apart_m < together_m.max(CONFLICT_M)).then(|| self.zones[wide])
    }
}

/// A driving lane.
#[derive(Clone, Debug)]
pub(crate) struct Lane {
    /// Its middle.
    pub(crate) centre: Centreline,
    /// Metres of it that are wide enough for a vehicle: less than its length where it tapers off into
    /// nothing.
    pub(crate) usable_m: f64,
    pub(crate) limit_mps: f64,
    /// The junction it is part of; tight bends count as junctions, numbered after those of the map.
    pub(crate) junction: Option<usize>,
    pub(crate) next: Vec<usize>,
    pub(crate) previous: Vec<usize>,
    /// The lanes beside it that run its way, left and right.
    pub(crate) beside: [Option<Beside>; 2],
    /// Per sample: highest speed from which all curves ahead on this lane are taken comfortably, m/s.
    pub(crate) curve_mps: Vec<f64>,
    /// From each sample to the next one: sharpest turn per metre to the left, radians.
    curvature: Vec<f64>,
    /// Lanes that begin where this one does, with how far the two overlap, metres.
    pub(crate) diverging: Vec<(usize, f64)>,
    /// Lanes outside junctions that end where this one does, with how far before the end the two overlap,
    /// metres.
    pub(crate) merging: Vec<(usize, f64)>,
    pub(crate) conflicts: Vec<ConflictArea>,
    /// Smallest radius, metres.
    pub(crate) radius_m: f64,
    /// Smallest radius over so much way that long vehicles swing out fully, metres.
    pub(crate) swing_radius_m: f64,
    /// How far before it drivers stop when they must not enter it, metres: farther where others turn out
    /// beside the line.
    pub(crate) line_gap_m: f64,
    /// Dynamic signals that control it (indices of the map).
    pub(crate) signals: Vec<usize>,
    pub(crate) stop_sign: bool,
    pub(crate) yield_sign: bool,
    /// +1 a left turn, -1 a right turn, 0 neither.
    pub(crate) turn: i8,
    /// No way crosses it, and vehicles that merge into it have a sign to give way: a part of a ring, or of a
    /// main road beside a ramp.
    pub(crate) right_of_way: bool,
}

/// All driving lanes of a map.
#[derive(Debug)]
pub(crate) struct Net {
    pub(crate) lanes: Vec<Lane>,
    index: BTreeMap<LaneId, usize>,
    grid: BTreeMap<(i32, i32), Vec<(u32, u32)>>,
}

impl Net {
    pub(crate) fn new(map: &Map) -> Self {
        let drivable = map.lanes().iter().filter(|l| l.lane_type.is_drivable());
        let (mut ways, facts): (Vec<Centreline>, Vec<&LaneInfo>) =
            drivable.filter_map(|l| Some((Centreline::new(map, l)?, l))).unzip();
        let index: BTreeMap<LaneId, usize> = ways.iter().enumerate().map(|(i, w)| (w.lane, i)).collect();
        let mut next = links(map, &ways, &index);
        join_ends(&mut ways, &mut next);
        let mut previous = vec![Vec::new(); ways.len()];
        for (i, onward) in next.iter().enumerate() {
            onward.iter().for_each(|&j| previous[j].push(i));
        }
        let mut tightest: BTreeMap<(u32, u16), f64> = BTreeMap::new();
        for way in ways.iter().filter(|w| w.length_m < LONGEST_BEND_M) {
            let radius_m = tightest.entry((way.lane.road, way.lane.section)).or_insert(f64::INFINITY);
            *radius_m = radius_m.min(tightest_radius(way));
        }
        let mut lanes = Vec::with_capacity(ways.len());
        for (((way, info), next), previous) in ways.into_iter().zip(facts).zip(next).zip(previous) {
            let limit_mps = info.speed_limit_mps.unwrap_or(DEFAULT_LIMIT_MPS);
            let signs = map.signals_of_lane(info.id).iter().filter_map(|&i| Some((i, map.signals().get(i)?)));
            let (mut signals, mut stop_sign, mut yield_sign) = (Vec::new(), false, false);
            for (i, signal) in signs {
                if signal.dynamic {
                    signals.push(i);
                }
                // The German catalogue, which OpenDRIVE files use by custom: 205 yield, 206 stop.
                stop_sign |= signal.kind == "206";
                yield_sign |= signal.kind == "205";
            }
            let curvature: Vec<f64> = (0..way.samples.len() - 1).map(|i| way.sharpest(i)).collect();
            let curve_mps = curve_speeds(&way, &curvature);
            let turn = way_turn(&way);
            let (radius_m, swing_radius_m) = (tightest_radius(&way), swing_radius(&way));
            // All lanes of a bend, however wide and long the outer one's.
            let inner = tightest.get(&(way.lane.road, way.lane.section));
            let bend = inner.is_some_and(|r| *r < TIGHT_BEND_M);
            let usable = way.samples.iter().take_while(|s| s.width_m >= VEHICLE_LANE_WIDTH_M).last();
            let usable_m = usable.map_or(0.0, |s| s.along_m);
            let beside = [Side::Left, Side::Right].map(|side| beside(map, &way, &index, side));
            lanes.push(Lane {
                centre: way,
                usable_m,
                limit_mps,
                junction: info
                    .junction
                    .or_else(|| bend.then_some(map.junctions().len() + info.id.road as usize)),
                next,
                previous,
                beside,
                curve_mps,
                curvature,
                diverging: Vec::new(),
                merging: Vec::new(),
                conflicts: Vec::new(),
                radius_m,
                swing_radius_m,
                line_gap_m: LINE_GAP_M,
                signals,
                stop_sign,
                yield_sign,
                turn: if info.junction.is_some() { turn } else { 0 },
                right_of_way: false,
            });
        }
        let mut net = Self { lanes, index, grid: BTreeMap::new() };
        net.find_overlaps();
        net.find_rights_of_way();
        net.fill_grid();
        net
    }

    /// The longer side of the box around all lanes, metres.
    pub(crate) fn extent_m(&self) -> f64 {
        let points = || self.lanes.iter().flat_map(|l| &l.centre.samples).map(|sample| sample.point);
        let side = |of: fn(Point3<f64>) -> f64| {
            let (low, high) = points()
                .map(of)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            high - low
        };
        side(|p| p.x).max(side(|p| p.y))
    }

    /// The index of a lane.
    pub(crate) fn find(&self, id: LaneId) -> Option<usize> {
        self.index.get(&id).copied()
    }

    fn find_overlaps(&mut self) {
        let mut by_junction: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, lane) in self.lanes.iter().enumerate() {
            if let Some(junction) = lane.junction {
                by_junction.entry(junction).or_default().push(i);
            }
        }
        let mut diverging: BTreeSet<(usize, usize)> = BTreeSet::new();
        let mut merging: BTreeSet<(usize, usize)> = BTreeSet::new();
        for lane in &self.lanes {
            pairs(&lane.next, &mut diverging);
            pairs(&lane.previous, &mut merging);
        }
        for &(a, b) in &diverging {
            let zone = overlap(&self.lanes[a].centre, &self.lanes[b].centre).ranges[0].map_or(0.0, |z| z[1]);
            self.lanes[a].diverging.push((b, zone));
        }
        for &(a, b) in &merging {
            let (la, lb) = (&self.lanes[a], &self.lanes[b]);
            if la.junction.is_some() && la.junction == lb.junction {
                continue;
            }
            let start = overlap(&la.centre, &lb.centre).ranges[0].map_or(lb.centre.length_m, |z| z[0]);
            let zone = lb.centre.length_m - start;
            self.lanes[a].merging.push((b, zone));
        }
        for members in by_junction.values() {
            let turns: Vec<usize> =
                members.iter().copied().filter(|&m| self.lanes[m].radius_m < TIGHT_BEND_M).collect();
            for &a in members {
                let line = self.lanes[a].centre.samples[0].point;
                let beside = |&t: &usize| {
                    t != a
                        && self.lanes[t]
                            .centre
                            .samples
                            .last()
                            .is_some_and(|s| (s.point - line).norm() < BESIDE_LINE_M)
                };
                if turns.iter().any(beside) {
                    self.lanes[a].line_gap_m = SWING_GAP_M;
                }
                for &b in members.iter().filter(|&&b| a < b && !diverging.contains(&(a, b))) {
                    // A vehicle that follows on the next lane has the one on this lane ahead.
                    if !self.follows(a, b) && !self.follows(b, a) {
                        self.add_conflict(a, b);
                    }
                }
            }
        }
    }

    fn find_rights_of_way(&mut self) {
        let signed = |lane: &Lane| lane.yield_sign || lane.stop_sign;
        let rights: Vec<bool> = self
            .lanes
            .iter()
            .map(|lane| {
                let aside = |c: &ConflictArea| c.merges || c.apart_m >= CONFLICT_M;
                let gives_way = |c: &ConflictArea| aside(c) && signed(&self.lanes[c.other]);
                let bare = lane.signals.is_empty() && !signed(lane);
                lane.junction.is_some() && bare && lane.conflicts.iter().all(gives_way)
            })
            .collect();
        for (lane, right) in self.lanes.iter_mut().zip(rights) {
            lane.right_of_way = right;
        }
    }

    /// Whether a lane leads to another one, if need be over pieces too short to part them.
    fn follows(&self, lane: usize, next: usize) -> bool {
        let mut open = vec![(lane, SHORT_M)];
        while let Some((at, rest_m)) = open.pop() {
            for &on in &self.lanes[at].next {
                if on == next {
                    return true;
                }
                let rest_m = rest_m - self.lanes[on].centre.length_m;
                if rest_m > 0.0 {
                    open.push((on, rest_m));
                }
            }
        }
        false
    }

    /// Enters that two lanes of a junction meet, if they do, for both.
    fn add_conflict(&mut self, a: usize, b: usize) {
        let (way_a, way_b) = (&self.lanes[a].centre, &self.lanes[b].centre);
        let (on_a, on_b) = (overlap(way_b, way_a), overlap(way_a, way_b));
        let apart_m = on_a.apart_m.min(on_b.apart_m);
        if apart_m >= NEAR_M[NEAR_M.len() - 1] {
            return;
        }
        let merges = (way_a.end() - way_b.end()).norm() < MERGE_M;
        // Samples of one may miss what those of the other see: then all of it counts.
        let all = |way: &Centreline, range: Option<[f64; 2]>| range.unwrap_or([0.0, way.length_m]);
        let zones = [0, 1, 2].map(|k| [all(way_a, on_a.ranges[k]), all(way_b, on_b.ranges[k])]);
        for (own, other, from) in [(a, b, 0), (b, a, 1)] {
            let zones = zones.map(|z| Zone { own_m: z[from], other_m: z[1 - from] });
            self.lanes[own].conflicts.push(ConflictArea { other, apart_m, zones, merges });
        }
    }

    fn fill_grid(&mut self) {
        for (i, lane) in self.lanes.iter().enumerate() {
            for (k, sample) in lane.centre.samples.iter().enumerate() {
                self.grid.entry(cell(&sample.point)).or_default().push((i as u32, k as u32));
            }
        }
    }

    /// Lanes whose surface, widened by `margin_m` on both sides, is under a point: lane and metres along it.
    pub(crate) fn lanes_at(&self, point: &Point3<f64>, margin_m: f64) -> Vec<(usize, f64)> {
        let mut nearest: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        let (x, y) = cell(point);
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            for &(lane, k) in self.grid.get(&(x + dx, y + dy)).into_iter().flatten() {
                let sample = &self.lanes[lane as usize].centre.samples[k as usize];
                let away = point - sample.point;
                let ahead = away.dot(&sample.tangent);
                let left = sample.tangent.x * away.y - sample.tangent.y * away.x;
                if away.z.abs() > DECK_M || left.abs() > 0.5 * sample.width_m + margin_m || ahead.abs() > 2.5
                {
                    continue;
                }
                let entry = nearest.entry(lane).or_insert((f64::INFINITY, 0.0));
                if ahead.abs() < entry.0 {
                    *entry = (ahead.abs(), sample.along_m + ahead);
                }
            }
        }
        nearest.into_iter().map(|(lane, (_, along))| (lane as usize, along)).collect()
    }

    /// Highest speed at a place from which the curves of its lane are taken comfortably, m/s.
    pub(crate) fn curve_speed(&self, lane: usize, along_m: f64) -> f64 {
        let lane = &self.lanes[lane];
        let i = lane.centre.index(along_m.clamp(0.0, lane.centre.length_m));
        let after_m = lane.centre.samples[i + 1].along_m - along_m;
        bend_speed(lane.curvature[i], CURVE_ACCELERATION).min(envelope(
            lane.curve_mps[i + 1],
            after_m,
            PLANNED_BRAKING,
        ))
    }

    /// Sharpest turn per metre to the left around a place of a lane, radians.
    pub(crate) fn curvature(&self, lane: usize, along_m: f64) -> f64 {
        let lane = &self.lanes[lane];
        lane.curvature[lane.centre.index(along_m.clamp(0.0, lane.centre.length_m))]
    }
}

/// Speed at which a bend asks for a sideways acceleration, m/s.
pub(crate) fn bend_speed(curvature: f64, acceleration_mps2: f64) -> f64 {
    (acceleration_mps2 / curvature.abs().max(STRAIGHT)).sqrt().max(SLOWEST_MPS)
}

/// Adds all ordered pairs of different members.
fn pairs(members: &[usize], found: &mut BTreeSet<(usize, usize)>) {
    for &a in members {
        found.extend(members.iter().filter(|&&b| b != a).map(|&b| (a, b)));
    }
}

fn cell(point: &Point3<f64>) -> (i32, i32) {
    ((point.x / CELL_M).floor() as i32, (point.y / CELL_M).floor() as i32)
}

/// Where a way is near another one.
struct Overlap {
    /// Smallest distance, metres.
    apart_m: f64,
    /// First and last place that is nearer than each of [`NEAR_M`].
    ranges: [Option<[f64; 2]>; 3],
}

/// Where `b` is near `a`, metres along `b`.
fn overlap(a: &Centreline, b: &Centreline) -> Overlap {
    let mut found = Overlap { apart_m: f64::INFINITY, ranges: [None; 3] };
    let mut before: Option<(f64, f64)> = None;
    for sample in &b.samples {
        let mut nearest = f64::INFINITY;
        for pair in a.samples.windows(2) {
            let (chord, away) = (pair[1].point - pair[0].point, sample.point - pair[0].point);
            let part = (away.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
            let off = away - chord * part;
            if off.z.abs() < DECK_M {
                nearest = nearest.min((off.x * off.x + off.y * off.y).sqrt());
            }
        }
        found.apart_m = found.apart_m.min(nearest);
        for (range, near) in found.ranges.iter_mut().zip(NEAR_M) {
            // Between a sample that is near and one that is not, the distance changes evenly.
            let crossing = before.filter(|(_, off)| (*off < near) != (nearest < near)).map(|(along, off)| {
                let share = if off.is_finite() && nearest.is_finite() {
                    (near - off) / (nearest - off)
                } else if off < near {
                    1.0
                } else {
                    0.0
                };
                along + share * (sample.along_m - along)
            });
            if nearest < near {
                let start = crossing.unwrap_or(sample.along_m);
                *range = Some([range.map_or(start, |r| r[0]), sample.along_m]);
            } else if let (Some(end), Some(range)) = (crossing, range.as_mut()) {
                range[1] = end;
            }
        }
        before = Some((sample.along_m, nearest));
    }
    found
}

/// Speed envelope of a way's curves, per sample.
fn curve_speeds(way: &Centreline, curvature: &[f64]) -> Vec<f64> {
    let samples = &way.samples;
    let on_m = |i: usize| samples[i + 1].along_m - samples[i].along_m;
    let speed = |i: usize| bend_speed(curvature[i], CURVE_ACCELERATION);
    let last = curvature.len();
    let mut speeds = vec![speed(last - 1); last + 1];
    for i in (0..last).rev() {
        let slowest = speed(i).min(speed(i.saturating_sub(1)));
        speeds[i] = slowest.min(envelope(speeds[i + 1], on_m(i), PLANNED_BRAKING));
    }
    speeds
}

/// The smallest radius over any two steps of a way, metres.
fn tightest_radius(way: &Centreline) -> f64 {
    let radius = |w: &[Sample]| {
        let turn = frames::wrap_pi(heading(&w[2].tangent) - heading(&w[0].tangent)).abs();
        (w[2].along_m - w[0].along_m) / turn.max(1e-9)
    };
    way.samples.windows(3).map(radius).fold(f64::INFINITY, f64::min)
}

/// The smallest radius over [`SWING_M`] of a way, metres.
fn swing_radius(way: &Centreline) -> f64 {
    let turn = |(i, from): (usize, &Sample)| {
        let to = way.samples[i..].iter().find(|s| s.along_m >= from.along_m + SWING_M).or(way.samples.last());
        let turn = to.map_or(0.0, |to| frames::wrap_pi(heading(&to.tangent) - heading(&from.tangent)).abs());
        turn / to.map_or(SWING_M, |to| (to.along_m - from.along_m).max(SWING_M))
    };
    1.0 / way.samples.iter().enumerate().map(turn).fold(1e-9, f64::max)
}

fn way_turn(way: &Centreline) -> i8 {
    let turn: f64 = way
        .samples
        .windows(2)
        .map(|p| frames::wrap_pi(heading(&p[1].tangent) - heading(&p[0].tangent)))
        .sum();
    if turn > TURN_RAD {
        1
    } else if turn < -TURN_RAD {
        -1
    } else {
        0
    }
}
