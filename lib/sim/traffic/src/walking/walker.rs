//! Walkers on their routes: over sidewalks, crosswalks and, some of them, straight over roads.

use catalogue::Model;
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector2};
use random::Stream;
use schema::FRAME_PERIOD_S;

use crate::bodies::{Body, BodyMotion};
use crate::occupancy::{CrossingWalker, Occupancy};
use crate::road::net::Net;
use crate::walking::crowd::{Crowd, DesiredVelocity, radius_m};
use crate::walking::dodging;
use crate::walking::fixtures::Fixtures;
use crate::walking::gait::{
    Gait, RUN_MPS, Rolling, STANDS_MPS, before, climbed, needed_s, pushed, share_of_speed, stopping_way,
};
use crate::walking::paths::{Crossing, Paths};
use crate::walking::routes::{Leg, Route, Routes, Turn};
use crate::walking::seats::Seat;
use crate::walking::surroundings::Surroundings;
use crate::walking::waiting::WaitingPlace;
use crate::walking::walking_group::WalkingGroup;

/// After waiting this long, a walker goes as soon as everyone can stop, seconds.
const PATIENCE_S: f64 = 5.0;
/// After waiting this long, a walker stays on its side, seconds.
const GIVE_UP_S: f64 = 25.0;
/// The same at a light, whose turn comes some time, seconds.
const GIVE_UP_AT_LIGHT_S: f64 = 90.0;
/// A walker who may cross anywhere and finds no way through at the wanted place tries again after this way,
/// metres.
const NEXT_TRY_M: f64 = 2.0;
/// Users of wheelchairs are not faster than this, m/s.
pub(crate) const WHEELCHAIR_MPS: f64 = 2.0;
/// Room to start is looked for at so many places, half a metre from one another.
const ROOM_TRIES: i32 = 160;
/// A place is reached within this distance, metres.
const REACH_M: f64 = 0.3;
/// Who cannot get on waits behind those who stand at the kerb, within this distance of it, metres.
const QUEUE_M: f64 = 3.0;
/// A walker who gets on less than a fifth as fast as wished for this long goes somewhere else, seconds.
const STUCK_S: f64 = 4.0;
/// Speeds at a destination, at which one turns round; at a place to wait; onto a crossing and round a sharp
/// corner, m/s.
const ARRIVES_MPS: f64 = 0.4;
const HALTS_MPS: f64 = 0.25;
const TURNS_OFF_MPS: f64 = 1.1;
/// Corners by more than this are sharp, radians.
const SHARP_RAD: f64 = 0.5;
/// Sideways acceleration in bends, m/s2, of those who are faster than this, m/s.
const BEND_MPS2: f64 = 1.8;
const BENDS_MPS: f64 = 1.5;
/// On the way over a road, people slow down to no less than this at the other side, m/s.
const ASHORE_MPS: f64 = 1.2;

/// A pedestrian this near to a lane's middle is on the lane for drivers, metres.
const LANE_SIDE_M: f64 = 2.5;

/// At its destination, one of a group waits this long for the others at most, seconds.
pub(crate) const AWAITS_S: f64 = 6.0;

#[derive(Clone, Debug)]
enum Mode {
    /// Along a sidewalk, on the first leg of the route.
    Along,
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
    /// Waits for something, looking somewhere.
    Obstacles {
        yaw_rad: f64,
        until_s: f64,
    },
    /// Sits on something so high for the whole scene.
    Sitting {
        seat_m: f64,
    },
    /// Hit by a vehicle.
    Struck,
}

/// What those who follow the first of a group take over from it.
#[derive(Clone, Debug)]
pub(crate) struct Trip {
    /// How many it has begun before.
    number: u32,
    route: Route,
}

/// A walker.
#[derive(Debug)]
pub(crate) struct Walker {
    model: &'static Model,
    color: [u8; 3],
    body: Body,
    point: Point3<f64>,
    yaw_rad: f64,
    walked_m: f64,
    velocity_mps: Vector2<f64>,
    gait: Gait,
    /// Up and down, m/s.
    upwards_mps: f64,
    /// Far from all agents: it comes to rest, and stands where it is.
    halts: bool,
    asleep: bool,
    stream: Stream,
    speed_mps: f64,
    anywhere: bool,
    /// Where across the way it likes to walk, in its own direction: -1 (right) to 1.
    offset: f64,
    /// How long it has hardly got on, seconds.
    stuck_s: f64,
    way: usize,
    along_m: f64,
    /// What is left of the way to its destination; never empty.
    route: Route,
    mode: Mode,
    /// Those it walks with, if there are any.
    company: Option<WalkingGroup>,
    /// Trips begun, its own or those of the first of its group.
    trips: u32,
    /// Share of its speed at which it walks for the others' sake.
    pace: f64,
    /// The first of its group is near.
    follows: bool,
}

impl Walker {
    #[allow(clippy::too_many_arguments, reason = "all of it is drawn by the caller, from one stream")]
    pub(crate) fn new(
        model: &'static Model,
        color: [u8; 3],
        mut stream: Stream,
        paths: &Paths,
        routes: &Routes,
        place: (usize, f64),
        speed_mps: f64,
        anywhere: bool,
        make_body: impl FnOnce(&Point3<f64>) -> Body,
    ) -> Self {
        // To the right, where nobody comes the other way.
        let offset = stream.uniform(-1.0, 0.1);
        let route = routes.draw(paths, place, anywhere, None, &mut stream);
        let forward = route.front().is_none_or(|leg| leg.to_m >= place.1);
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
            gait: Gait::of(model),
            upwards_mps: 0.0,
            halts: false,
            asleep: false,
            stream,
            speed_mps,
            anywhere,
            offset,
            stuck_s: 0.0,
            way: place.0,
            along_m: place.1,
            route,
            mode: Mode::Along,
            company: None,
            trips: 0,
            pace: 1.0,
            follows: false,
        }
    }

    /// Walks with others, where across the way it is told, as fast as all can.
    pub(crate) fn join(&mut self, company: WalkingGroup, offset: f64, speed_mps: f64) {
        (self.company, self.offset, self.speed_mps) = (Some(company), offset, speed_mps);
    }

    /// Waits at a place until a time.
    pub(crate) fn wait(&mut self, paths: &Paths, place: &WaitingPlace, until_s: f64) {
        (self.way, self.along_m) = (place.way, place.along_m);
        self.route.clear();
        // Of those who stand, this is the place across the way.
        self.offset = place.share;
        (self.point, self.yaw_rad) = (paths.point(self.way, self.along_m, place.share).0, place.yaw_rad);
        self.mode = Mode::Obstacles { yaw_rad: place.yaw_rad, until_s };
    }

    /// Sits down, and stays.
    pub(crate) fn sit(&mut self, seat: &Seat) {
        (self.point, self.yaw_rad) = (seat.point, seat.yaw_rad);
        self.mode = Mode::Sitting { seat_m: seat.seat_m };
    }

    /// Height of the seat that it sits on, metres; 0 if it does not sit on one.
    pub(crate) fn seat_m(&self) -> f64 {
        if let Mode::Sitting { seat_m } = self.mode { seat_m } else { 0.0 }
    }

    pub(crate) fn company(&self) -> Option<&WalkingGroup> {
        self.company.as_ref()
    }

    /// Where it is going, as long as it walks on a way.
    pub(crate) fn trip(&self) -> Option<Trip> {
        let Mode::Along = self.mode else { return None };
        Some(Trip { number: self.trips, route: self.route.clone() })
    }

    /// Whether it can take over the trip of another one: that is new, and both are on the same way.
    pub(crate) fn may_join(&self, first: &Self) -> bool {
        let free = matches!(self.mode, Mode::Along | Mode::Obstacles { .. });
        free && self.way == first.way && self.trips != first.trips
    }

    /// Walks as fast as the others ask for, and where the first of the group goes, if that is new.
    pub(crate) fn keep_up(&mut self, pace: f64, follows: bool, trip: Option<Trip>) {
        (self.pace, self.follows) = (pace, follows);
        if let Some(Trip { number, route }) = trip {
            (self.trips, self.route, self.stuck_s) = (number, route, 0.0);
            self.mode = Mode::Along;
        }
    }

    /// How fast it wishes to walk now, m/s.
    fn pace_mps(&self) -> f64 {
        (self.pace * self.speed_mps).min(self.most_mps())
    }

    /// How fast it can go at all, m/s.
    fn most_mps(&self) -> f64 {
        if self.gait == Gait::Wheels { WHEELCHAIR_MPS } else { RUN_MPS }
    }

    pub(crate) fn model(&self) -> &'static Model {
        self.model
    }

    pub(crate) fn color(&self) -> [u8; 3] {
        self.color
    }

    pub(crate) fn body(&self) -> Body {
        self.body
    }

    /// On the ground.
    pub(crate) fn position(&self) -> Point3<f64> {
        self.point
    }

    pub(crate) fn yaw_rad(&self) -> f64 {
        self.yaw_rad
    }

    pub(crate) fn world_from_object(&self) -> Pose<World, Object> {
        Pose::from_xyz_rpy(self.point.into(), [0.0, 0.0, self.yaw_rad])
    }

    pub(crate) fn velocity_mps(&self) -> Vector2<f64> {
        self.velocity_mps
    }

    pub(crate) fn wished_speed_mps(&self) -> f64 {
        self.speed_mps
    }

    pub(crate) fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// Comes to rest and falls asleep where it stands, or wakes.
    pub(crate) fn set_asleep(&mut self, far: bool) {
        self.halts = far;
        self.asleep = far && self.velocity_mps == Vector2::zeros() && self.upwards_mps == 0.0;
    }

    /// Takes over where the body of a struck walker has skidded to.
    pub(crate) fn skid_to(&mut self, body: &BodyMotion) {
        (self.point.x, self.point.y, self.yaw_rad) = (body.x_m, body.y_m, body.yaw_rad);
    }

    /// The leg that is walked.
    fn leg(&self) -> Leg {
        let here = Leg { way: self.way, to_m: self.along_m, then: Turn::Arrive };
        self.route.front().copied().filter(|leg| leg.way == self.way).unwrap_or(here)
    }

    /// Whether the leg that is walked leads in the sidewalk's direction.
    fn is_forward(&self) -> bool {
        self.leg().to_m >= self.along_m
    }

    /// Goes along the sidewalk to a new destination, if possible this way at first.
    fn set_out(&mut self, around: &Surroundings<'_>, forward: Option<bool>) {
        let from = (self.way, self.along_m);
        self.route = around.routes.draw(around.paths, from, self.anywhere, forward, &mut self.stream);
        (self.stuck_s, self.mode) = (0.0, Mode::Along);
        self.trips += 1;
    }

    /// Moves a walker who would start in somebody or something along its sidewalk to the nearest place where
    /// it does not, beside its line if there is none on it.
    pub(crate) fn find_room(&mut self, paths: &Paths, fixtures: &Fixtures, crowd: &Crowd) {
        let length = paths.ways[self.way].length_m;
        let stands = matches!(self.mode, Mode::Obstacles { .. });
        let share = if stands || self.is_forward() { self.offset } else { -self.offset };
        let (from_m, radius_m) = (self.along_m, self.radius_m());
        let shift = |i: i32| 0.5 * f64::from((i + 1) / 2) * if i % 2 == 0 { 1.0 } else { -1.0 };
        let free = |share: f64| {
            let shifted = (0..ROOM_TRIES).map(|i| from_m + shift(i));
            shifted.filter(|along_m| (0.0..=length).contains(along_m)).find_map(|along_m| {
                let point = paths.point(self.way, along_m, share).0;
                crowd.is_free(point, radius_m, fixtures).then_some((along_m, point))
            })
        };
        let shares = [share, 0.0, -share, 1.0, -1.0];
        if let Some((along_m, point)) = shares.into_iter().find_map(free) {
            (self.along_m, self.point) = (along_m, point);
        }
    }

    /// The angle of a wheelchair's wheels. (How others stride follows from where they are.)
    pub(crate) fn wheel_angle_rad(&self) -> f64 {
        let radius = self.model.wheel_radius_m;
        if radius > 0.0 { self.walked_m / radius } else { 0.0 }
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

    /// Marks the lanes that the walker is still going to cross, with the time until then.
    pub(crate) fn mark(&self, net: &Net, occupancy: &mut Occupancy) {
        if let Mode::Over { crossing, side, done_m } = &self.mode {
            let length = (crossing.ends[1] - crossing.ends[0]).norm();
            for &(lane, along, from_first) in &crossing.lanes {
                let at = if *side == 0 { from_first } else { length - from_first };
                if at > done_m - 1.0 {
                    let in_s = (at - LANE_SIDE_M - done_m).max(0.0) / self.speed_mps;
                    occupancy.add_walker(lane, CrossingWalker { along_m: along, in_s });
                }
            }
        } else if self.is_struck() {
            for (lane, along_m) in net.lanes_at(&self.point, 0.3) {
                occupancy.add_walker(lane, CrossingWalker { along_m, in_s: 0.0 });
            }
        }
    }

    pub(crate) fn radius_m(&self) -> f64 {
        radius_m(self.model.size_m)
    }

    /// What it wishes for now, and the height of the surface there; none for a walker who sits or was struck.
    fn wish(&mut self, around: &Surroundings<'_>) -> Option<(DesiredVelocity, f64)> {
        let &Surroundings { paths, time_s, .. } = around;
        match self.mode.clone() {
            Mode::Struck | Mode::Sitting { .. } => None,
            Mode::Obstacles { yaw_rad, until_s } => {
                if time_s > until_s {
                    self.set_out(around, None);
                }
                let (sin, cos) = frames::math::sin_cos(yaw_rad);
                let wish = DesiredVelocity {
                    ahead: Vector2::new(cos, sin),
                    speed_mps: 0.0,
                    aside_m: 0.0,
                    room_m: [-0.3, 0.3],
                };
                Some((wish, self.point.z))
            }
            Mode::Along => {
                if self.stuck_s > STUCK_S {
                    self.set_out(around, Some(!self.is_forward()));
                }
                Some(self.along_wish(paths))
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
                let waited_s = time_s - since_s;
                let most_s = if crossing.signals.is_empty() { GIVE_UP_S } else { GIVE_UP_AT_LIGHT_S };
                if self.may_go(around, &crossing, waited_s > PATIENCE_S) {
                    self.stuck_s = 0.0;
                    self.mode = Mode::Over { crossing: crossing.clone(), side, done_m: 0.0 };
                } else if waited_s > most_s {
                    // Back to where it left the sidewalk, and somewhere else.
                    self.stuck_s = 0.0;
                    self.route.clear();
                    self.mode = Mode::ToWalk;
                }
                let to = crossing.ends[1 - side];
                Some((
                    DesiredVelocity { speed_mps: 0.0, ..self.straight_wish(&to, [0.0; 2]).0 },
                    self.point.z,
                ))
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
                    self.mode = Mode::Along;
                    if self.route.front().is_none_or(|leg| leg.way != self.way) {
                        self.set_out(around, None);
                    }
                }
                Some(self.straight_wish(&to, [-0.6, 0.6]))
            }
        }
    }

    /// One step of walker `me` of the crowd.
    pub(crate) fn step(&mut self, around: &Surroundings<'_>, crowd: &mut Crowd, me: usize) {
        match self.wish(around) {
            Some((wish, height_m)) => self.go(around, crowd, me, (wish, height_m)),
            None => (self.velocity_mps, self.upwards_mps) = (Vector2::zeros(), 0.0),
        }
        crowd.moved(me, self.point, self.velocity_mps);
        if matches!(self.mode, Mode::Along) {
            self.follow(around);
        }
    }

    /// Moves for a step as wished, as far as there is room.
    fn go(
        &mut self,
        around: &Surroundings<'_>,
        crowd: &Crowd,
        me: usize,
        (wish, height_m): (DesiredVelocity, f64),
    ) {
        let (sweeps, before, radius_m) = (around.sweeps, self.point, self.radius_m());
        let aside_rad = frames::wrap_pi(heading(&wish.ahead) - self.yaw_rad);
        let share = share_of_speed(aside_rad);
        let turned = if self.halts {
            DesiredVelocity { speed_mps: 0.0, aside_m: 0.0, room_m: [0.0; 2], ..wish }
        } else {
            DesiredVelocity { speed_mps: share * wish.speed_mps, ..wish }
        };
        let minded = sweeps.is_minded(me);
        let wish = if minded && !self.is_on_road() {
            dodging::out_of_the_way(sweeps, &before, radius_m, turned)
        } else {
            turned
        };
        let choice = crowd.choice(me, &wish, around.fixtures).cap_magnitude(self.most_mps());
        let blocked = |v: &Vector2<f64>| minded && sweeps.blocks(&before, stopping_way(v), radius_m);
        let way_m = match self.gait {
            Gait::Feet => {
                let pushes = pushed(self.velocity_mps, choice);
                self.velocity_mps = crowd.passable(me, pushes, around.fixtures, &blocked);
                let speed_mps = self.velocity_mps.norm();
                // A walker who shuffles looks where it wants to go.
                let look = if speed_mps > STANDS_MPS { self.velocity_mps } else { wish.ahead };
                self.yaw_rad = self.gait.turned(self.yaw_rad, heading(&look), speed_mps);
                speed_mps * FRAME_PERIOD_S
            }
            Gait::Wheels => {
                let free = |v: &Vector2<f64>| crowd.is_passable(me, v, around.fixtures) && !blocked(v);
                let now = Rolling { yaw_rad: self.yaw_rad, velocity_mps: self.velocity_mps };
                let next = now.step(&wish.ahead, choice, wish.ahead != turned.ahead, &free);
                (self.yaw_rad, self.velocity_mps) = (next.yaw_rad, next.velocity_mps);
                next.speed_mps() * FRAME_PERIOD_S
            }
        };
        let moved = self.velocity_mps * FRAME_PERIOD_S;
        (self.point.x, self.point.y) = (before.x + moved.x, before.y + moved.y);
        self.upwards_mps = climbed(self.upwards_mps, height_m - before.z, self.velocity_mps.norm());
        self.point.z += self.upwards_mps * FRAME_PERIOD_S;
        let on = moved.dot(&wish.ahead) / FRAME_PERIOD_S > 0.2 * wish.speed_mps;
        if on {
            self.stuck_s = 0.0;
        } else if share > 0.5 {
            // Nobody is stuck who turns round.
            self.stuck_s += FRAME_PERIOD_S;
        }
        self.walked_m += way_m;
    }

    /// Along the sidewalk, on the liked line. The second value of wishes is the surface's height.
    fn along_wish(&self, paths: &Paths) -> (DesiredVelocity, f64) {
        let leg = self.leg();
        let sense = if self.is_forward() { 1.0 } else { -1.0 };
        let way = &paths.ways[self.way];
        let left = way.cross(self.point, self.along_m).1;
        let room = paths.room_m(self.way, self.along_m);
        let (sin, cos) = frames::math::sin_cos(way.place(self.along_m).heading_rad);
        let aside = sense * left;
        let wish = DesiredVelocity {
            ahead: Vector2::new(cos, sin) * sense,
            speed_mps: self.along_mps(paths, &leg, sense),
            aside_m: self.offset * room - aside,
            room_m: [-room - aside, room - aside],
        };
        let share = if room > 1e-6 { (left / room).clamp(-1.0, 1.0) } else { 0.0 };
        (wish, paths.point(self.way, self.along_m, share).0.z)
    }

    /// How fast it goes along the sidewalk, given what is ahead.
    fn along_mps(&self, paths: &Paths, leg: &Leg, sense: f64) -> f64 {
        let (pace_mps, rest_m) = (self.pace_mps(), (leg.to_m - self.along_m).abs());
        let end_mps = match leg.then {
            Turn::Arrive => ARRIVES_MPS,
            Turn::Crosswalk { .. } | Turn::Over => TURNS_OFF_MPS,
            Turn::Join { way, last } if pace_mps > TURNS_OFF_MPS && rest_m < RUN_MPS => {
                let onward = &paths.ways[way];
                let from_rad = paths.ways[self.way].place(leg.to_m).heading_rad;
                let to_rad = onward.place(if last { onward.length_m } else { 0.0 }).heading_rad;
                let turned = if (sense > 0.0) == last { std::f64::consts::PI } else { 0.0 };
                let corner_rad = frames::wrap_pi(to_rad - from_rad + turned).abs();
                if corner_rad > SHARP_RAD { TURNS_OFF_MPS } else { pace_mps }
            }
            Turn::Join { .. } => pace_mps,
        };
        let speed_mps = pace_mps.min(before(end_mps, rest_m));
        if speed_mps < BENDS_MPS {
            return speed_mps;
        }
        let bend = paths.ways[self.way].curvature(self.along_m + sense).abs().max(1e-6);
        speed_mps.min((BEND_MPS2 / bend).sqrt().max(BENDS_MPS))
    }

    /// Straight to a place.
    fn straight_wish(&self, to: &Point3<f64>, room_m: [f64; 2]) -> (DesiredVelocity, f64) {
        let way = flat(&self.point, to);
        let gap = way.norm();
        let ahead = if gap > 1e-6 { way / gap } else { Vector2::x() };
        // Nobody walks past it.
        let speed_mps = self.pace_mps().min(before(HALTS_MPS, gap - 0.1)).min(gap / FRAME_PERIOD_S);
        // Heights change evenly on the way.
        let height = self.point.z
            + (to.z - self.point.z) * (self.velocity_mps.norm() * FRAME_PERIOD_S / gap.max(1e-6)).min(1.0);
        (DesiredVelocity { ahead, speed_mps, aside_m: 0.0, room_m }, height)
    }

    /// Where on a kerb a walker from `side` goes: on its right half of the crossing.
    fn kerb(&self, crossing: &Crossing, side: usize, at: usize) -> Point3<f64> {
        let way = flat(&crossing.ends[side], &crossing.ends[1 - side]);
        let left = Vector2::new(-way.y, way.x) * (self.offset * crossing.half_width_m / way.norm().max(1e-6));
        let end = crossing.ends[at];
        Point3::new(end.x + left.x, end.y + left.y, end.z)
    }

    fn over_wish(&mut self, crossing: Crossing, side: usize) -> (DesiredVelocity, f64) {
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
        let wish = DesiredVelocity {
            ahead,
            // Nobody dawdles on the road, nor runs off it.
            speed_mps: self.pace_mps().max(self.speed_mps).min(before(ASHORE_MPS, rest)),
            aside_m: self.offset * half - aside,
            room_m: [-half - aside, half - aside],
        };
        (wish, height)
    }

    /// Finds the place on the sidewalk after a step, and turns off at the end of a leg.
    fn follow(&mut self, around: &Surroundings<'_>) {
        let paths = around.paths;
        let (leg, forward) = (self.leg(), self.is_forward());
        self.along_m = paths.ways[self.way].cross(self.point, self.along_m).0;
        let rest = if forward { leg.to_m - self.along_m } else { self.along_m - leg.to_m };
        let near = if leg.then == Turn::Arrive { REACH_M } else { 1e-6 };
        if rest > near {
            return;
        }
        self.route.pop_front();
        match leg.then {
            // The first of the group says where to go next.
            Turn::Arrive if self.follows => {
                let until_s = around.time_s + AWAITS_S;
                self.mode = Mode::Obstacles { yaw_rad: self.yaw_rad, until_s };
            }
            Turn::Arrive => self.set_out(around, None),
            Turn::Join { way, last } => {
                self.way = way;
                self.along_m = if last { paths.ways[way].length_m } else { 0.0 };
            }
            Turn::Crosswalk { crossing, side } => {
                self.mode = Mode::ToKerb { crossing: paths.crossings[crossing].clone(), side };
            }
            Turn::Over => {
                let clear = |c: &Crossing| around.fixtures.is_way_free(c.ends[0], c.ends[1], self.radius_m());
                let length = paths.ways[self.way].length_m;
                match paths.straight_over(around.net, self.way, self.point).filter(clear) {
                    Some(crossing) => self.mode = Mode::ToKerb { crossing, side: 0 },
                    // A parked car or a pole: a little farther on.
                    None => {
                        let to_m = leg.to_m + if forward { NEXT_TRY_M } else { -NEXT_TRY_M };
                        if (0.0..length).contains(&to_m) {
                            self.route.push_front(Leg { to_m, ..leg });
                        } else {
                            self.set_out(around, None);
                        }
                    }
                }
            }
        }
    }

    /// Whether the road is clear long enough; an impatient walker only asks that everyone can stop. At lights
    /// also whether they hold the traffic, but for those who cross anywhere.
    fn may_go(&self, around: &Surroundings<'_>, crossing: &Crossing, impatient: bool) -> bool {
        let length = (crossing.ends[1] - crossing.ends[0]).norm();
        let needed_s = needed_s(length, self.speed_mps);
        let lights = !crossing.signals.is_empty();
        let held = lights && around.is_held(crossing, needed_s);
        (!lights || held || self.anywhere) && around.is_clear(crossing, needed_s, impatient || held)
    }
}

fn heading(v: &Vector2<f64>) -> f64 {
    frames::math::atan2(v.y, v.x)
}

fn flat(from: &Point3<f64>, to: &Point3<f64>) -> Vector2<f64> {
    (to - from).xy()
}
