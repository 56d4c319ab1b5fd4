//! Walkers on sidewalks, crosswalks and, some of them, anywhere.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use opendrive::{LaneType, Map};
use random::Stream;
use schema::FRAME_PERIOD_S;
use schema::models::Model;

use crate::bodies::Body;
use crate::net::Net;
use crate::vehicles::{Occupancy, Vehicle};
use crate::ways::{Way, heading};

/// Ends of sidewalks nearer than this are joined, metres.
const JOIN_M: f64 = 2.5;
/// A crosswalk's end leads to a sidewalk within this distance, metres.
const DOOR_M: f64 = 6.0;
/// Walkers keep this far from a sidewalk's edge, metres.
const EDGE_M: f64 = 0.35;
/// Chance to take a crosswalk that one comes by.
const TAKE_CROSSWALK: f64 = 0.4;
/// Chance per step that one who may cross anywhere does so (once in about 10 s).
const CROSS_ANYWHERE: f64 = 0.005;
/// A stride's length, metres.
const STRIDE_M: f64 = 1.4;
/// Fastest turn, radians per second.
const TURN_RADPS: f64 = 5.0;
/// After waiting this long, a walker goes as soon as everyone can stop, seconds.
const PATIENCE_S: f64 = 5.0;
/// Vehicles are looked for this far upstream, metres.
const LOOK_M: f64 = 60.0;
/// Walkers this near to a lane are kept clear of: long vehicles swing out of theirs, metres.
const BESIDE_M: f64 = 2.0;
/// Longest way over a road, metres.
const MAX_CROSSING_M: f64 = 60.0;

/// A way over a road: from kerb to kerb.
#[derive(Clone, Debug)]
struct Crossing {
    ends: [Point3<f64>; 2],
    /// Sidewalk and way along it at each end.
    doors: [(usize, f64); 2],
    /// Driving lanes on the way: lane, metres along it, metres from the first end.
    lanes: Vec<(usize, f64, f64)>,
}

/// Where walkers walk.
#[derive(Debug)]
pub(crate) struct Paths {
    ways: Vec<Way>,
    raised_m: Vec<f64>,
    joined: BTreeMap<(usize, bool), Vec<(usize, bool)>>,
    crossings: Vec<Crossing>,
    /// Crosswalks along each way: metres, crossing, which end.
    doors: Vec<Vec<(f64, usize, usize)>>,
}

impl Paths {
    /// Sidewalks; on maps without, shoulders.
    pub(crate) fn new(map: &Map, net: &Net) -> Self {
        let lanes_of = |shoulders: bool| {
            let fits = move |l: &&opendrive::LaneInfo| {
                let wanted =
                    if shoulders { l.lane_type == LaneType::Shoulder } else { l.lane_type.is_walkable() };
                wanted && l.width_range_m[1] >= 1.0
            };
            map.lanes().iter().filter(fits).filter_map(|l| Some((Way::new(map, l)?, l))).collect::<Vec<_>>()
        };
        let mut found = lanes_of(false);
        if found.is_empty() {
            found = lanes_of(true);
        }
        let raised_m = found
            .iter()
            .map(|(_, l)| {
                map.lane_height(l.id, 0.5 * (l.s_start + l.s_end)).map_or(0.0, |[a, b]| 0.5 * (a + b))
            })
            .collect();
        let ways: Vec<Way> = found.into_iter().map(|(way, _)| way).collect();
        let mut paths = Self {
            doors: vec![Vec::new(); ways.len()],
            ways,
            raised_m,
            joined: BTreeMap::new(),
            crossings: Vec::new(),
        };
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
        for crosswalk in map.crosswalks() {
            let Some(ends) = long_axis(&crosswalk.polygon) else { continue };
            let doors = ends.map(|end| self.nearest(&end, DOOR_M));
            let [Some(a), Some(b)] = doors else { continue };
            if a.0 == b.0 || (ends[1] - ends[0]).norm() > MAX_CROSSING_M {
                continue;
            }
            let crossing = Crossing { ends, doors: [a, b], lanes: lanes_on(net, &ends) };
            for (side, (way, along)) in [a, b].into_iter().enumerate() {
                self.doors[way].push((along, self.crossings.len(), side));
            }
            self.crossings.push(crossing);
        }
    }

    /// The nearest place of any sidewalk.
    fn nearest(&self, point: &Point3<f64>, within_m: f64) -> Option<(usize, f64)> {
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

    /// Places for walkers, each near an agent: the first of up to 20 tries; without one the walker is left out.
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

    fn point(&self, way: usize, along_m: f64, offset_m: f64) -> (Point3<f64>, f64) {
        let place = self.ways[way].place(along_m);
        let room = (0.5 * place.width_m - EDGE_M).max(0.0);
        let offset = offset_m * room;
        let (sin, cos) = frames::math::sin_cos(place.heading_rad);
        let z = self.raised_m[way] + offset * frames::math::tan(place.roll_rad);
        (place.point + Vector3::new(-sin * offset, cos * offset, z), place.heading_rad)
    }

    /// Straight over the road to the sidewalk on its other side.
    fn straight_over(&self, net: &Net, way: usize, from: Point3<f64>) -> Option<Crossing> {
        let lane = self.ways[way].lane;
        let over = |w: &Way| {
            w.lane.road == lane.road && w.lane.section == lane.section && (w.lane.lane > 0) != (lane.lane > 0)
        };
        let other = self.ways.iter().position(over)?;
        let along = self.ways[other].project(from).0;
        let to = self.point(other, along, 0.0).0;
        let ends = [from, to];
        let length = (to - from).norm();
        (length > 2.0 && length < MAX_CROSSING_M).then(|| Crossing {
            ends,
            doors: [(way, 0.0), (other, along)],
            lanes: lanes_on(net, &ends),
        })
    }
}

/// The middles of the two short sides of a polygon's main direction.
fn long_axis(polygon: &[Point3<f64>]) -> Option<[Point3<f64>; 2]> {
    let count = polygon.len();
    if count < 3 {
        return None;
    }
    let centre = polygon.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / count as f64;
    // Second moments of the corners; the main axis has the larger one.
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in polygon {
        let d = p.coords - centre;
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let (sin, cos) = frames::math::sin_cos(0.5 * frames::math::atan2(2.0 * xy, xx - yy));
    let reach = |p: &Point3<f64>| (p.x - centre.x) * cos + (p.y - centre.y) * sin;
    let (low, high) = polygon.iter().map(reach).fold((f64::MAX, f64::MIN), |(l, h), r| (l.min(r), h.max(r)));
    let z = |wanted: f64| {
        let nearest =
            polygon.iter().min_by(|a, b| (reach(a) - wanted).abs().total_cmp(&(reach(b) - wanted).abs()));
        nearest.map_or(centre.z, |p| p.z)
    };
    let at = |r: f64| Point3::new(centre.x + cos * r, centre.y + sin * r, z(r));
    (high - low > 1.0).then(|| [at(low), at(high)])
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

#[derive(Clone, Debug)]
enum Mode {
    /// Along a sidewalk, in its direction or against it.
    Along {
        forward: bool,
    },
    /// To the kerb.
    ToKerb {
        crossing: Crossing,
        side: usize,
    },
    Waiting {
        crossing: Crossing,
        side: usize,
        since_s: f64,
    },
    /// On the road, so far from the first end walked.
    Over {
        crossing: Crossing,
        side: usize,
        done_m: f64,
    },
    /// From the kerb back onto the sidewalk.
    ToWalk,
    /// Hit by a vehicle.
    Struck,
}

/// A walker.
#[derive(Debug)]
pub(crate) struct Walker {
    pub(crate) model: &'static Model,
    pub(crate) color: [u8; 3],
    pub(crate) body: Body,
    pub(crate) point: Point3<f64>,
    pub(crate) yaw_rad: f64,
    pub(crate) walked_m: f64,
    stream: Stream,
    speed_mps: f64,
    anywhere: bool,
    /// Where across the sidewalk: -1 to 1.
    offset: f64,
    way: usize,
    along_m: f64,
    mode: Mode,
    last_door: Option<usize>,
}

impl Walker {
    #[allow(clippy::too_many_arguments)] // All of it is drawn by the caller, from one stream.
    pub(crate) fn new(
        model: &'static Model,
        color: [u8; 3],
        mut stream: Stream,
        paths: &Paths,
        place: (usize, f64),
        speed_mps: f64,
        anywhere: bool,
        make_body: impl FnOnce(&Point3<f64>) -> Body,
    ) -> Self {
        let (forward, offset) = (stream.chance(0.5), stream.uniform(-1.0, 1.0));
        let (point, way_heading) = paths.point(place.0, place.1, offset);
        let yaw_rad = if forward { way_heading } else { frames::wrap_pi(way_heading + std::f64::consts::PI) };
        Self {
            model,
            color,
            body: make_body(&point),
            point,
            yaw_rad,
            walked_m: 0.0,
            stream,
            speed_mps,
            anywhere,
            offset,
            way: place.0,
            along_m: place.1,
            mode: Mode::Along { forward },
            last_door: None,
        }
    }

    pub(crate) fn gait_phase_rad(&self) -> f64 {
        std::f64::consts::TAU * self.walked_m / STRIDE_M
    }

    pub(crate) fn is_on_road(&self) -> bool {
        matches!(self.mode, Mode::Over { .. })
    }

    pub(crate) fn is_struck(&self) -> bool {
        matches!(self.mode, Mode::Struck)
    }

    pub(crate) fn strike(&mut self) {
        self.mode = Mode::Struck;
    }

    /// Marks the lanes that the walker is still going to cross.
    pub(crate) fn mark(&self, net: &Net, occupancy: &mut Occupancy) {
        if let Mode::Over { crossing, side, done_m } = &self.mode {
            let length = (crossing.ends[1] - crossing.ends[0]).norm();
            for &(lane, along, from_first) in &crossing.lanes {
                let at = if *side == 0 { from_first } else { length - from_first };
                if at > done_m - 1.0 {
                    occupancy.add_walker(lane, along);
                }
            }
        } else if self.is_struck() {
            for (lane, along) in net.lanes_at(&self.point, 0.3) {
                occupancy.add_walker(lane, along);
            }
        }
    }

    /// One step. `blocked`: somebody stands close ahead.
    pub(crate) fn step(
        &mut self,
        paths: &Paths,
        net: &Net,
        occupancy: &Occupancy,
        vehicles: &[Vehicle],
        time_s: f64,
        slowed: f64,
    ) {
        let reach = self.speed_mps * FRAME_PERIOD_S * slowed;
        let before = self.point;
        let mut target_yaw = None;
        match self.mode.clone() {
            Mode::Struck => return,
            Mode::Along { forward } => self.stroll(paths, net, forward, reach),
            Mode::ToKerb { crossing, side } => {
                if self.walk_to(crossing.ends[side], reach) {
                    self.mode = Mode::Waiting { crossing, side, since_s: time_s };
                }
            }
            Mode::Waiting { crossing, side, since_s } => {
                target_yaw = Some(heading(&(crossing.ends[1 - side] - crossing.ends[side])));
                if self.may_go(net, occupancy, vehicles, &crossing, time_s - since_s > PATIENCE_S) {
                    self.mode = Mode::Over { crossing, side, done_m: 0.0 };
                }
            }
            Mode::Over { crossing, side, done_m } => {
                let reach = self.speed_mps * FRAME_PERIOD_S;
                if self.walk_to(crossing.ends[1 - side], reach) {
                    (self.way, self.along_m) = crossing.doors[1 - side];
                    self.mode = Mode::ToWalk;
                } else {
                    self.mode = Mode::Over { crossing, side, done_m: done_m + reach };
                }
            }
            Mode::ToWalk => {
                let to = paths.point(self.way, self.along_m, self.offset).0;
                if self.walk_to(to, reach) {
                    let forward = self.stream.chance(0.5);
                    self.mode = Mode::Along { forward };
                }
            }
        }
        let moved = self.point - before;
        let way = (moved.x * moved.x + moved.y * moved.y).sqrt();
        self.walked_m += way;
        if way > 1e-6 {
            target_yaw = Some(heading(&moved));
        }
        if let Some(target) = target_yaw {
            let turn = frames::wrap_pi(target - self.yaw_rad);
            let most = TURN_RADPS * FRAME_PERIOD_S;
            self.yaw_rad = frames::wrap_pi(self.yaw_rad + turn.clamp(-most, most));
        }
    }

    fn stroll(&mut self, paths: &Paths, net: &Net, forward: bool, reach: f64) {
        if self.anywhere
            && self.stream.chance(CROSS_ANYWHERE)
            && let Some(crossing) = paths.straight_over(net, self.way, self.point)
        {
            self.mode = Mode::ToKerb { crossing, side: 0 };
            return;
        }
        let length = paths.ways[self.way].length_m;
        let from = self.along_m;
        self.along_m += if forward { reach } else { -reach };
        let (low, high) = (from.min(self.along_m), from.max(self.along_m));
        let passed = paths.doors[self.way]
            .iter()
            .find(|(at, c, _)| (low..high).contains(at) && self.last_door != Some(*c));
        if let Some(&(_, crossing, side)) = passed {
            self.last_door = Some(crossing);
            if self.stream.chance(TAKE_CROSSWALK) {
                self.mode = Mode::ToKerb { crossing: paths.crossings[crossing].clone(), side };
                return;
            }
        }
        if (0.0..=length).contains(&self.along_m) {
            let to = paths.point(self.way, self.along_m, self.offset).0;
            // Sideways drift after a turn-off is walked, not jumped.
            self.walk_to(to, 1.5 * reach + 1e-4);
            return;
        }
        self.along_m = self.along_m.clamp(0.0, length);
        let onward = paths.joined.get(&(self.way, forward)).map_or(&[][..], Vec::as_slice);
        match self.stream.choose(onward) {
            Some(&(way, last)) => {
                let same_sense = forward != last;
                self.way = way;
                self.along_m = if last { paths.ways[way].length_m } else { 0.0 };
                self.offset = if same_sense { self.offset } else { -self.offset };
                self.mode = Mode::Along { forward: !last };
            }
            None => self.mode = Mode::Along { forward: !forward },
        }
    }

    /// Straight towards a point; whether it is reached.
    fn walk_to(&mut self, to: Point3<f64>, reach: f64) -> bool {
        let way = to - self.point;
        let distance = way.norm();
        if distance <= reach {
            self.point = to;
            return true;
        }
        self.point += way * (reach / distance);
        false
    }

    /// Whether the road is clear long enough; an impatient walker only asks that everyone can stop.
    fn may_go(
        &self,
        net: &Net,
        occupancy: &Occupancy,
        vehicles: &[Vehicle],
        crossing: &Crossing,
        impatient: bool,
    ) -> bool {
        let length = (crossing.ends[1] - crossing.ends[0]).norm();
        let needed_s = length / self.speed_mps + 1.0;
        crossing.lanes.iter().all(|&(lane, along, _)| {
            // Upstream, depth first: lane and the metres from its beginning to the crossing point.
            let mut open = vec![(lane, along)];
            while let Some((at, to)) = open.pop() {
                for spot in &occupancy.vehicles[at] {
                    let gap = to - spot.along_m - spot.half_length_m;
                    let speed = spot.speed_mps;
                    let gone = gap < -2.0 * spot.half_length_m - 0.8;
                    let standing = speed < 0.3;
                    let stops = gap > 4.0 + 0.7 * speed + speed * speed / 4.0
                        && !vehicles[spot.vehicle].driver.reckless;
                    let far = gap > speed * needed_s + 3.0;
                    let clear = gone || far || (standing && gap > 1.5) || (impatient && stops);
                    if !clear {
                        return false;
                    }
                }
                if to < LOOK_M && open.len() < 64 {
                    open.extend(net.lanes[at].previous.iter().map(|&p| (p, to + net.lanes[p].way.length_m)));
                }
            }
            true
        })
    }
}

/// How much each walker is slowed by one close ahead of it: 1 not at all, 0 standing.
pub(crate) fn crowding(walkers: &[Walker]) -> Vec<f64> {
    const CELL_M: f64 = 1.5;
    let cell = |p: &Point3<f64>| ((p.x / CELL_M).floor() as i32, (p.y / CELL_M).floor() as i32);
    let mut cells: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
    for (i, walker) in walkers.iter().enumerate() {
        cells.entry(cell(&walker.point)).or_default().push(i);
    }
    let slowed = |(i, walker): (usize, &Walker)| {
        let (x, y) = cell(&walker.point);
        let (sin, cos) = frames::math::sin_cos(walker.yaw_rad);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
        let mut share: f64 = 1.0;
        for &j in around.filter_map(|c| cells.get(&c)).flatten().filter(|&&j| j != i) {
            let away = walkers[j].point - walker.point;
            let (ahead, aside) = (away.x * cos + away.y * sin, (away.y * cos - away.x * sin).abs());
            let opposed = frames::wrap_pi(walkers[j].yaw_rad - walker.yaw_rad).abs() > 1.6;
            // Those who come the other way are passed; of two side by side the lower number goes first.
            if !opposed && ahead > 0.05 && ahead < 1.2 && aside < 0.45 && (ahead > 0.3 || j < i) {
                share = share.min(((ahead - 0.5) / 0.7).clamp(0.0, 1.0));
            }
        }
        share
    };
    walkers.iter().enumerate().map(slowed).collect()
}
