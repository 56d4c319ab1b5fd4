//! Walkers on sidewalks, crosswalks and, some of them, anywhere.

use nalgebra::{Point3, Vector2};
use random::Stream;
use schema::FRAME_PERIOD_S;
use schema::models::Model;

use crate::bodies::Body;
use crate::crowd::{Crowd, Wish, radius_m};
use crate::fixtures::Fixtures;
use crate::net::Net;
use crate::occupancy::Occupancy;
use crate::paths::{Crossing, Paths};
use crate::vehicles::Vehicle;

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
/// After waiting this long, a walker stays on its side, seconds.
const GIVE_UP_S: f64 = 25.0;
/// Vehicles are looked for this far upstream, metres.
const LOOK_M: f64 = 60.0;
/// A place is reached within this distance, metres.
const REACH_M: f64 = 0.3;
/// Who cannot get on waits behind those who stand at the kerb, within this distance of it, metres.
const QUEUE_M: f64 = 3.0;
/// Who gets on less than a fifth as fast as wished for this long tries something else, seconds.
const STUCK_S: f64 = 6.0;
/// Braking to a halt at the end of a sidewalk, m/s2.
const HALT_MPS2: f64 = 2.5;

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

/// Where walkers walk, and what stands there.
pub(crate) struct Place<'a> {
    pub(crate) paths: &'a Paths,
    pub(crate) fixtures: &'a Fixtures,
    pub(crate) net: &'a Net,
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
    pub(crate) velocity_mps: Vector2<f64>,
    stream: Stream,
    speed_mps: f64,
    anywhere: bool,
    /// Where across the way it likes to walk, in its own direction: -1 (right) to 1.
    offset: f64,
    /// How long it has hardly got on, seconds.
    stuck_s: f64,
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
        // To the right, where nobody comes the other way.
        let (forward, offset) = (stream.chance(0.5), stream.uniform(-1.0, 0.1));
        let (point, way_heading) = paths.point(place.0, place.1, if forward { offset } else { -offset });
        let yaw_rad = if forward { way_heading } else { frames::wrap_pi(way_heading + std::f64::consts::PI) };
        Self {
            model,
            color,
            body: make_body(&point),
            point,
            yaw_rad,
            walked_m: 0.0,
            velocity_mps: Vector2::zeros(),
            stream,
            speed_mps,
            anywhere,
            offset,
            stuck_s: 0.0,
            way: place.0,
            along_m: place.1,
            mode: Mode::Along { forward },
            last_door: None,
        }
    }

    /// Moves a walker who would start in another one along its sidewalk to the nearest place where it does not.
    pub(crate) fn find_room(&mut self, paths: &Paths, fixtures: &Fixtures, crowd: &Crowd) {
        let length = paths.ways[self.way].length_m;
        let Mode::Along { forward } = self.mode else { return };
        let share = if forward { self.offset } else { -self.offset };
        let shifts = (0..100).map(|i| 0.5 * f64::from((i + 1) / 2) * if i % 2 == 0 { 1.0 } else { -1.0 });
        let free = shifts
            .map(|shift| self.along_m + shift)
            .filter(|along| (0.0..=length).contains(along))
            .find_map(|along| {
                let point = paths.point(self.way, along, share).0;
                crowd.is_free(point, self.radius_m(), fixtures).then_some((along, point))
            });
        if let Some((along, point)) = free {
            (self.along_m, self.point) = (along, point);
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

    pub(crate) fn radius_m(&self) -> f64 {
        radius_m(self.model.size_m)
    }

    /// One step of walker `me` of the crowd.
    pub(crate) fn step(
        &mut self,
        place: &Place<'_>,
        occupancy: &Occupancy,
        vehicles: &[Vehicle],
        time_s: f64,
        crowd: &mut Crowd,
        me: usize,
    ) {
        let &Place { paths, fixtures, net } = place;
        let wish = match self.mode.clone() {
            Mode::Struck => None,
            Mode::Along { forward } => {
                self.turn_off(place, forward);
                // Who turned off thinks anew in the next step.
                matches!(self.mode, Mode::Along { .. }).then(|| self.along_wish(paths, forward))
            }
            Mode::ToKerb { crossing, side } => {
                let to = self.kerb(&crossing, side, side);
                let gap = flat(&self.point, &to).norm();
                if gap < REACH_M || (gap < QUEUE_M && self.stuck_s > 0.5) || self.stuck_s > STUCK_S {
                    self.mode = Mode::Waiting { crossing, side, since_s: time_s };
                }
                Some(self.straight_wish(&to, [-0.6, 0.6]))
            }
            Mode::Waiting { crossing, side, since_s } => {
                if self.may_go(net, occupancy, vehicles, &crossing, time_s - since_s > PATIENCE_S) {
                    self.stuck_s = 0.0;
                    self.mode = Mode::Over { crossing: crossing.clone(), side, done_m: 0.0 };
                } else if time_s - since_s > GIVE_UP_S {
                    // Back to where it left the sidewalk.
                    self.stuck_s = 0.0;
                    self.mode = Mode::ToWalk;
                }
                let to = crossing.ends[1 - side];
                Some((Wish { speed_mps: 0.0, ..self.straight_wish(&to, [0.0; 2]).0 }, self.point.z))
            }
            Mode::Over { crossing, side, .. } => Some(self.over_wish(crossing, side)),
            Mode::ToWalk => {
                let to = paths.point(self.way, self.along_m, 0.0).0;
                let (along, left) = paths.ways[self.way].cross(self.point, self.along_m);
                if flat(&self.point, &to).norm() < REACH_M
                    || left.abs() <= paths.room_m(self.way, along)
                    || self.stuck_s > STUCK_S
                {
                    (self.along_m, self.stuck_s) = (along, 0.0);
                    let forward = self.stream.chance(0.5);
                    self.mode = Mode::Along { forward };
                }
                Some(self.straight_wish(&to, [-0.6, 0.6]))
            }
        };
        let before = self.point;
        match wish {
            Some((wish, height_m)) => {
                let velocity = crowd.velocity(me, &wish, fixtures);
                let moved = crowd.step(me, velocity * FRAME_PERIOD_S, fixtures);
                self.velocity_mps = moved / FRAME_PERIOD_S;
                (self.point.x, self.point.y) = (before.x + moved.x, before.y + moved.y);
                let rise = moved.norm();
                self.point.z += (height_m - before.z).clamp(-rise, rise);
                let on = moved.dot(&wish.ahead) / FRAME_PERIOD_S > 0.2 * wish.speed_mps;
                self.stuck_s = if on { 0.0 } else { self.stuck_s + FRAME_PERIOD_S };
                self.walked_m += rise;
                // Who shuffles looks where it wants to go.
                let look = if self.velocity_mps.norm() > 0.3 { self.velocity_mps } else { wish.ahead };
                self.turn_to(frames::math::atan2(look.y, look.x));
            }
            None => self.velocity_mps = Vector2::zeros(),
        }
        crowd.moved(me, self.point, self.velocity_mps);
        if let Mode::Along { forward } = self.mode {
            self.follow(paths, forward);
        }
    }

    fn turn_to(&mut self, yaw_rad: f64) {
        let turn = frames::wrap_pi(yaw_rad - self.yaw_rad);
        let most = TURN_RADPS * FRAME_PERIOD_S;
        self.yaw_rad = frames::wrap_pi(self.yaw_rad + turn.clamp(-most, most));
    }

    /// Leaves the sidewalk for the road now and then, where that is this walker's way, and turns about where it is stuck.
    fn turn_off(&mut self, place: &Place<'_>, forward: bool) {
        if self.anywhere
            && self.stream.chance(CROSS_ANYWHERE)
            && let Some(crossing) = place.paths.straight_over(place.net, self.way, self.point)
            && place.fixtures.is_way_free(crossing.ends[0], crossing.ends[1], self.radius_m())
        {
            self.mode = Mode::ToKerb { crossing, side: 0 };
        } else if self.stuck_s > STUCK_S {
            self.stuck_s = 0.0;
            self.mode = Mode::Along { forward: !forward };
        }
    }

    /// Along the sidewalk, on the liked line. The second value of wishes is the surface's height.
    fn along_wish(&self, paths: &Paths, forward: bool) -> (Wish, f64) {
        let sense = if forward { 1.0 } else { -1.0 };
        let way = &paths.ways[self.way];
        let left = way.cross(self.point, self.along_m).1;
        let room = paths.room_m(self.way, self.along_m);
        let (sin, cos) = frames::math::sin_cos(way.place(self.along_m).heading_rad);
        let aside = sense * left;
        let wish = Wish {
            ahead: Vector2::new(cos, sin) * sense,
            speed_mps: self.speed_mps,
            aside_m: self.offset * room - aside,
            room_m: [-room - aside, room - aside],
        };
        let share = if room > 1e-6 { (left / room).clamp(-1.0, 1.0) } else { 0.0 };
        (wish, paths.point(self.way, self.along_m, share).0.z)
    }

    /// Straight to a place.
    fn straight_wish(&self, to: &Point3<f64>, room_m: [f64; 2]) -> (Wish, f64) {
        let way = flat(&self.point, to);
        let gap = way.norm();
        let ahead = if gap > 1e-6 { way / gap } else { Vector2::x() };
        // Runners brake, so that they do not run past it.
        let speed_mps = self.speed_mps.min(0.5 + gap / 0.5).min(gap / FRAME_PERIOD_S);
        // Heights change evenly on the way.
        let height = self.point.z
            + (to.z - self.point.z) * (self.velocity_mps.norm() * FRAME_PERIOD_S / gap.max(1e-6)).min(1.0);
        (Wish { ahead, speed_mps, aside_m: 0.0, room_m }, height)
    }

    /// Where on a kerb the walker goes who comes from `side`: on its right half of the crossing.
    fn kerb(&self, crossing: &Crossing, side: usize, at: usize) -> Point3<f64> {
        let way = flat(&crossing.ends[side], &crossing.ends[1 - side]);
        let left = Vector2::new(-way.y, way.x) * (self.offset * crossing.half_width_m / way.norm().max(1e-6));
        let end = crossing.ends[at];
        Point3::new(end.x + left.x, end.y + left.y, end.z)
    }

    fn over_wish(&mut self, crossing: Crossing, side: usize) -> (Wish, f64) {
        let to = self.kerb(&crossing, side, 1 - side);
        let way = flat(&crossing.ends[side], &crossing.ends[1 - side]);
        let length = way.norm().max(1e-6);
        let ahead = way / length;
        let left = Vector2::new(-ahead.y, ahead.x);
        let from = flat(&crossing.ends[side], &self.point);
        let (done, aside) = (from.dot(&ahead), from.dot(&left));
        let rest = length - done;
        let height = self.straight_wish(&to, [0.0; 2]).1;
        if rest < REACH_M || (rest < 1.5 && self.stuck_s > 1.0) {
            self.stuck_s = 0.0;
            (self.way, self.along_m) = crossing.doors[1 - side];
            self.mode = Mode::ToWalk;
        } else {
            self.mode = Mode::Over { crossing: crossing.clone(), side, done_m: done };
        }
        let half = crossing.half_width_m;
        let wish = Wish {
            ahead,
            speed_mps: self.speed_mps,
            aside_m: self.offset * half - aside,
            room_m: [-half - aside, half - aside],
        };
        (wish, height)
    }

    /// Finds the place on the sidewalk after a step; takes a crosswalk that it came by, goes on along the next sidewalk, or
    /// turns where there is none.
    fn follow(&mut self, paths: &Paths, forward: bool) {
        let way = &paths.ways[self.way];
        let from = self.along_m;
        self.along_m = way.cross(self.point, from).0;
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
        let rest = if forward { way.length_m - self.along_m } else { self.along_m };
        let onward = paths.joined.get(&(self.way, forward)).map_or(&[][..], Vec::as_slice);
        if onward.is_empty() {
            let sense = if forward { 1.0 } else { -1.0 };
            let (sin, cos) = frames::math::sin_cos(way.place(self.along_m).heading_rad);
            let speed = (sense * self.velocity_mps.dot(&Vector2::new(cos, sin))).max(0.0);
            let halt = REACH_M + 0.5 * speed * speed / HALT_MPS2;
            if rest < halt.min(0.25 * way.length_m) {
                self.mode = Mode::Along { forward: !forward };
            }
        } else if rest <= 1e-6
            && let Some(&(way, last)) = self.stream.choose(onward)
        {
            self.way = way;
            self.along_m = if last { paths.ways[way].length_m } else { 0.0 };
            self.mode = Mode::Along { forward: !last };
        }
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
                        && vehicles.get(spot.vehicle).is_none_or(|v| !v.driver.reckless);
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

fn flat(from: &Point3<f64>, to: &Point3<f64>) -> Vector2<f64> {
    (to - from).xy()
}
