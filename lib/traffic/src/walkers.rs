//! Walkers on sidewalks, crosswalks and, some of them, anywhere.

use std::collections::BTreeMap;

use nalgebra::Point3;
use random::Stream;
use schema::FRAME_PERIOD_S;
use schema::models::Model;

use crate::bodies::Body;
use crate::net::Net;
use crate::occupancy::Occupancy;
use crate::paths::{Crossing, Paths};
use crate::vehicles::Vehicle;
use crate::ways::heading;

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
