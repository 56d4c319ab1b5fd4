//! Where walkers walk: sidewalks, road edges where there are none, how they are joined, and ways over roads.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use opendrive::{CrosswalkAxis, LaneInfo, Map};
use random::Stream;

use crate::road::centreline::Centreline;
use crate::road::net::Net;
use crate::walking::edges::edges;

/// Narrower sidewalks are none, metres.
const LEAST_WIDTH_M: f64 = 1.0;
/// Ends of sidewalks nearer than this are joined, metres.
const JOIN_M: f64 = 2.5;
/// A crosswalk's end leads to a sidewalk within this distance, metres.
const DOOR_M: f64 = 6.0;
/// Walkers keep this far from a sidewalk's edge, metres.
const EDGE_M: f64 = 0.35;
/// Walkers this near to a lane are kept clear of: long vehicles swing out of theirs, metres.
const BESIDE_M: f64 = 2.0;
/// Longest way over a road, metres.
const MAX_CROSSING_M: f64 = 60.0;
/// How far from the straight line walkers are when they cross anywhere, and at most on crosswalks, metres.
const BESIDE_LINE_M: [f64; 2] = [0.8, 2.0];

/// A way over a road: from kerb to kerb.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    pub(crate) ends: [Point3<f64>; 2],
    /// Sidewalk and way along it at each end.
    pub(crate) doors: [(usize, f64); 2],
    /// How far walkers may be from the line between the ends, metres.
    pub(crate) half_width_m: f64,
    /// Driving lanes on the way: lane, metres along it, metres from the first end.
    pub(crate) lanes: Vec<(usize, f64, f64)>,
    /// Signals that hold the traffic which comes over a crosswalk (indices of the map).
    pub(crate) signals: Vec<usize>,
}

/// Where walkers walk.
#[derive(Debug)]
pub(crate) struct Paths {
    pub(crate) ways: Vec<Centreline>,
    raised_m: Vec<f64>,
    /// The way on the other side of the road, if there is one.
    opposite: Vec<Option<usize>>,
    /// Ends of ways (way, whether its last end) at each end.
    pub(crate) joined: BTreeMap<(usize, bool), Vec<(usize, bool)>>,
    pub(crate) crossings: Vec<Crossing>,
}

impl Paths {
    /// Sidewalks, and the edges of roads where there are none.
    pub(crate) fn new(map: &Map, net: &Net) -> Self {
        let sidewalks =
            map.lanes().iter().filter(|l| l.lane_type.is_walkable() && l.width_range_m[1] >= LEAST_WIDTH_M);
        let raised = |l: &LaneInfo| {
            map.lane_height(l.id, 0.5 * (l.s_start + l.s_end)).map_or(0.0, |[a, b]| 0.5 * (a + b))
        };
        let sidewalks = sidewalks.filter_map(|l| Some((Centreline::new(map, l)?, raised(l))));
        let beside = edges(map, net).into_iter().map(|way| (way, 0.0));
        let (ways, raised_m): (Vec<Centreline>, Vec<f64>) = sidewalks.chain(beside).unzip();
        let opposite = opposites(&ways);
        let mut paths = Self { ways, raised_m, opposite, joined: BTreeMap::new(), crossings: Vec::new() };
        paths.join();
        paths.add_crosswalks(map, net);
        paths
    }

    fn end(&self, way: usize, last: bool) -> Point3<f64> {
        let samples = &self.ways[way].samples;
        samples[if last { samples.len() - 1 } else { 0 }].point
    }

    fn join(&mut self) {
        let cell = |p: &Point3<f64>| ((p.x / JOIN_M).floor() as i32, (p.y / JOIN_M).floor() as i32);
        let mut cells: BTreeMap<(i32, i32), Vec<(usize, bool)>> = BTreeMap::new();
        let ends: Vec<(usize, bool)> = (0..self.ways.len()).flat_map(|w| [(w, false), (w, true)]).collect();
        for &(way, last) in &ends {
            cells.entry(cell(&self.end(way, last))).or_default().push((way, last));
        }
        for &(way, last) in &ends {
            let at = self.end(way, last);
            let (x, y) = cell(&at);
            let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
            let near: Vec<(usize, bool)> = around
                .filter_map(|c| cells.get(&c))
                .flatten()
                .copied()
                .filter(|&(w, l)| w != way && (self.end(w, l) - at).norm() < JOIN_M)
                .collect();
            self.joined.insert((way, last), near);
        }
    }

    fn add_crosswalks(&mut self, map: &Map, net: &Net) {
        for (number, crosswalk) in map.crosswalks().iter().enumerate() {
            let Some(CrosswalkAxis { ends, half_width_m }) = crosswalk.axis() else { continue };
            let doors = ends.map(|end| self.nearest(&end, DOOR_M));
            let [Some(a), Some(b)] = doors else { continue };
            if a.0 == b.0 || (ends[1] - ends[0]).norm() > MAX_CROSSING_M {
                continue;
            }
            let half_width_m = (half_width_m - EDGE_M).clamp(0.0, BESIDE_LINE_M[1]);
            let lanes = lanes_on(net, &ends);
            let signals = map.crosswalk_signals(number);
            self.crossings.push(Crossing { ends, doors: [a, b], half_width_m, lanes, signals });
        }
    }

    /// The nearest place of any way.
    pub(crate) fn nearest(&self, point: &Point3<f64>, within_m: f64) -> Option<(usize, f64)> {
        let mut best: Option<(f64, usize, f64)> = None;
        for (i, way) in self.ways.iter().enumerate() {
            let rough = way.samples.iter().map(|s| (s.point - point).norm()).fold(f64::INFINITY, f64::min);
            if rough > within_m + 2.5 {
                continue;
            }
            let along = way.project(*point).0;
            let distance = (way.place(along).point - point).norm();
            if distance < within_m && best.is_none_or(|b| distance < b.0) {
                best = Some((distance, i, along));
            }
        }
        best.map(|(_, way, along)| (way, along))
    }

    /// A random place: sidewalk by area, then evenly along it.
    fn draw_place(&self, areas: &[f64], stream: &mut Stream) -> Option<(usize, f64)> {
        let total = *areas.last()?;
        let pick = stream.uniform(0.0, total);
        let way = areas.partition_point(|a| *a <= pick).min(areas.len() - 1);
        Some((way, stream.uniform(0.0, self.ways[way].length_m)))
    }

    /// Places for walkers, each near an agent: the first of up to 20 tries; without one the walker is left
    /// out.
    pub(crate) fn draw_starts(
        &self,
        count: u32,
        agents: &[Point3<f64>],
        radius_m: f64,
        stream: &dyn Fn(u64) -> Stream,
    ) -> Vec<(usize, usize, f64)> {
        let mut total = 0.0;
        let areas: Vec<f64> = self
            .ways
            .iter()
            .map(|way| {
                total += way.length_m * way.samples[way.samples.len() / 2].width_m.max(0.1);
                total
            })
            .collect();
        let near = |&(way, along): &(usize, f64)| {
            let at = self.ways[way].place(along).point;
            agents.iter().any(|a| (a - at).norm() < radius_m)
        };
        (0..count)
            .filter_map(|i| {
                let mut draw = stream(u64::from(i));
                let place = (0..20).filter_map(|_| self.draw_place(&areas, &mut draw)).find(near)?;
                Some((i as usize, place.0, place.1))
            })
            .collect()
    }

    /// A place on the surface of a way and the way's heading, `share` (-1 to 1) of the free width left of its
    /// middle.
    pub(crate) fn point(&self, way: usize, along_m: f64, share: f64) -> (Point3<f64>, f64) {
        let place = self.ways[way].place(along_m);
        let room = free_m(place.width_m);
        let offset = share * room;
        let (sin, cos) = frames::math::sin_cos(place.heading_rad);
        let z = self.raised_m[way] + offset * frames::math::tan(place.roll_rad);
        (place.point + Vector3::new(-sin * offset, cos * offset, z), place.heading_rad)
    }

    /// How far from the middle of a way walkers go, metres: not beyond the centre of a tight bend.
    pub(crate) fn room_m(&self, way: usize, along_m: f64) -> f64 {
        let way = &self.ways[way];
        free_m(way.place(along_m).width_m).min(0.6 / way.curvature(along_m).abs().max(1e-6))
    }

    /// The sidewalk on the other side of the road.
    pub(crate) fn opposite(&self, way: usize) -> Option<usize> {
        self.opposite[way]
    }

    /// The way straight over the road from a sidewalk to the one on the other side: where it starts, and how
    /// far along the other one it ends; none where it is too long.
    pub(crate) fn across(&self, way: usize, other: usize, along_m: f64) -> Option<(Point3<f64>, f64)> {
        let from = self.point(way, along_m, 0.0).0;
        let to_m = self.ways[other].project(from).0;
        let over = self.point(other, to_m, 0.0).0 - from;
        let (length, tangent) = (over.norm(), self.ways[way].samples[self.ways[way].index(along_m)].tangent);
        // The other one may begin farther on.
        let is_straight = over.dot(&tangent).abs() < 0.5 * length;
        (is_straight && length > 2.0 && length < MAX_CROSSING_M).then_some((from, to_m))
    }

    /// Straight over the road to the sidewalk on its other side.
    pub(crate) fn straight_over(&self, net: &Net, way: usize, from: Point3<f64>) -> Option<Crossing> {
        let other = self.opposite(way)?;
        let along = self.ways[other].project(from).0;
        let to = self.point(other, along, 0.0).0;
        let ends = [from, to];
        let length = (to - from).norm();
        (length > 2.0 && length < MAX_CROSSING_M).then(|| {
            let lanes = lanes_on(net, &ends);
            let doors = [(way, 0.0), (other, along)];
            Crossing { ends, doors, half_width_m: BESIDE_LINE_M[0], lanes, signals: Vec::new() }
        })
    }
}

/// The way on the other side of the road of each: of several the one whose middle is nearest.
fn opposites(ways: &[Centreline]) -> Vec<Option<usize>> {
    let side = |w: &Centreline, other: bool| (w.lane.road, w.lane.section, (w.lane.lane > 0) != other);
    let mut sides: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (i, way) in ways.iter().enumerate() {
        sides.entry(side(way, false)).or_default().push(i);
    }
    let middle = |w: &Centreline| w.samples[w.samples.len() / 2].point;
    let nearest = |way: &Centreline| {
        let away = |i: &usize| (middle(&ways[*i]) - middle(way)).norm_squared();
        let others = sides.get(&side(way, true))?;
        others.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    ways.iter().map(nearest).collect()
}

/// Half of a width without its edges, metres.
fn free_m(width_m: f64) -> f64 {
    (0.5 * width_m - EDGE_M).max(0.0)
}

/// Driving lanes under a straight line.
fn lanes_on(net: &Net, ends: &[Point3<f64>; 2]) -> Vec<(usize, f64, f64)> {
    let way = ends[1] - ends[0];
    let length = way.norm();
    let steps = (length / 0.5).ceil().clamp(1.0, 1000.0);
    let mut last: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    let mut found = Vec::new();
    for i in 0..=steps as usize {
        let part = i as f64 / steps;
        for (lane, along) in net.lanes_at(&(ends[0] + way * part), BESIDE_M) {
            // One entry per metre is enough to stop before.
            if last.get(&lane).is_none_or(|(l, d)| (l - along).abs() > 1.0 || part * length - d > 1.0) {
                last.insert(lane, (along, part * length));
                found.push((lane, along, part * length));
            }
        }
    }
    found
}
