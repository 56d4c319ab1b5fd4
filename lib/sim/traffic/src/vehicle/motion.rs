//! How a vehicle moves: its followed point on the route by exactly the way that its speed asks for, its body
//! after it.

use catalogue::{BaseType, Model, trains::Train};
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use schema::FRAME_PERIOD_S;

use crate::bodies::{Body, BodyMotion};
use crate::car_following::COMFORT_BRAKING;
use crate::road::centreline::{Centreline, CentrelinePoint, heading};
use crate::road::net::Net;
use crate::vehicle::lateral::Lateral;
use crate::vehicle::route::Route;
use crate::vehicle::sway::{Springs, Sway};

/// Largest steering angle, radians: that of a town bus's inner wheel.
const MAX_STEER_RAD: f64 = 0.9;
/// Ways are gone to this accuracy, metres: 0.2 mm/s.
const EXACT_M: f64 = 1e-5;
/// Most trials to do so.
const TRIALS: usize = 12;
/// A vehicle that brakes and is slower than this stands, m/s.
const STANDS_MPS: f64 = 0.004;
/// Where ways meet less exactly than this, what is left wears off, metres, and radians.
const SEAM_M: f64 = 1e-3;
const SEAM_RAD: f64 = 1e-3;

fn is_two_wheeled(model: &Model) -> bool {
    matches!(model.base, BaseType::Motorcycle | BaseType::Bicycle)
}

/// What its body leans on.
pub(crate) fn springs(model: &Model) -> Springs {
    if is_two_wheeled(model) {
        return Springs::Rider;
    }
    Springs::Wheels { at_m: [half_base_m(model), 0.5 * model.size_m[1]], travel_m: model.spring_travel_m() }
}

/// From the middle between the axles back to the rear one, metres.
pub(crate) fn half_base_m(model: &Model) -> f64 {
    0.5 * model.wheelbase_m.max(0.5)
}

/// The hitch of a lead: its middle on the ground, the direction that it heads, and how that slopes.
pub(crate) fn hitch(train: &Train, at: Point3<f64>, yaw_rad: f64, pitch_rad: f64) -> Point3<f64> {
    let (sin, cos) = frames::math::sin_cos(yaw_rad);
    at - Vector3::new(cos, sin, -frames::math::tan(pitch_rad)) * train.hitch_m
}

/// Where a vehicle is, how fast it goes, and how its body stands. The followed point is the middle of its
/// footprint.
#[derive(Debug)]
pub(crate) struct Motion {
    /// The followed point, on the road, with the road's slopes there.
    at: CentrelinePoint,
    yaw_rad: f64,
    speed_mps: f64,
    acceleration_mps2: f64,
    steer_rad: f64,
    /// Way in space since the start, metres.
    rolled_m: f64,
    /// Lean of its body.
    sway: Sway,
    /// It hit or was hit: nobody drives it any more.
    crashed: bool,
    body: Body,
}

impl Motion {
    /// At rest at a place.
    pub(crate) fn at_rest(at: CentrelinePoint, yaw_rad: f64, body: Body) -> Self {
        Self {
            at,
            yaw_rad,
            speed_mps: 0.0,
            acceleration_mps2: 0.0,
            steer_rad: 0.0,
            rolled_m: 0.0,
            sway: Sway::default(),
            crashed: false,
            body,
        }
    }

    /// The followed point, on the ground.
    pub(crate) fn position(&self) -> Point3<f64> {
        self.at.point
    }

    pub(crate) fn yaw_rad(&self) -> f64 {
        self.yaw_rad
    }

    pub(crate) fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    pub(crate) fn acceleration_mps2(&self) -> f64 {
        self.acceleration_mps2
    }

    pub(crate) fn steer_rad(&self) -> f64 {
        self.steer_rad
    }

    /// Way in space since the start, metres.
    pub(crate) fn rolled_m(&self) -> f64 {
        self.rolled_m
    }

    /// Whether it hit or was hit.
    pub(crate) fn is_crashed(&self) -> bool {
        self.crashed
    }

    pub(crate) fn body(&self) -> Body {
        self.body
    }

    /// Where it has what it tows, on the ground.
    pub(crate) fn hitch(&self, train: &Train) -> Point3<f64> {
        hitch(train, self.at.point, self.yaw_rad, self.at.pitch_rad)
    }

    /// What of its pose's roll and pitch is lean on its springs, radians; that of two-wheelers is theirs,
    /// wheels and all.
    pub(crate) fn lean_rad(&self, model: &Model) -> [f64; 2] {
        if is_two_wheeled(model) { [0.0; 2] } else { [self.sway.roll_rad, self.sway.pitch_rad] }
    }

    /// Pose on the slope under it, leaning on its springs: the slope is given along the road, the body may be
    /// askew.
    pub(crate) fn world_from_object(&self) -> Pose<World, Object> {
        let (at, sway) = (&self.at, &self.sway);
        let (sin, cos) = frames::math::sin_cos(self.yaw_rad - at.heading_rad);
        let pitch = at.pitch_rad * cos - at.roll_rad * sin;
        let roll = at.roll_rad * cos + at.pitch_rad * sin;
        Pose::from_xyz_rpy(at.point.into(), [roll + sway.roll_rad, pitch + sway.pitch_rad, self.yaw_rad])
    }

    /// Metres along the lane to the place that lies a way on in space from where the vehicle is, which is at
    /// `from_m` on this lane: fewer than that way while crossing over, more on the inside of a bend. By
    /// secants, from a guess.
    fn along_after(&self, course: &Course<'_>, from_m: f64, step_m: f64, guess_m: f64) -> f64 {
        let (mut before, mut along_m) = ((from_m, -step_m), guess_m);
        for _ in 0..TRIALS {
            let off_m = (course.point_at(along_m).point - self.at.point).norm() - step_m;
            if off_m.abs() < EXACT_M {
                break;
            }
            let slope = (off_m - before.1) / (along_m - before.0);
            before = (along_m, off_m);
            // Way in space grows with way along the lane, at half to twice its rate in any bend that is
            // driven.
            let slope = if slope.is_finite() { slope.clamp(0.3, 3.0) } else { 1.0 };
            along_m = (along_m - off_m / slope).clamp(from_m, from_m + 4.0 * step_m);
        }
        along_m
    }

    /// Moves the followed point a way on in space, over to the next lanes where they begin. Where the ends of
    /// two ways do not meet, or meet at an angle while the vehicle is beside their middles, it does not jump:
    /// what it is then off the new way wears off.
    fn go(&mut self, course: &mut Course<'_>, step_m: f64) {
        let mut from_m = course.route.along_m();
        course.route.advance_to(self.along_after(course, from_m, step_m, from_m + step_m));
        while course.route.goes_on() && course.route.along_m() >= course.lane().length_m {
            let length_m = course.lane().length_m;
            let reached = course.point_at(course.route.along_m());
            let end = course.point_at(length_m);
            course.route.enter_next(course.net);
            from_m -= length_m;
            let along_m = course.route.along_m();
            let start = course.point_at(0.0);
            let turned_rad = frames::wrap_pi(start.heading_rad - end.heading_rad).abs();
            if (start.point - end.point).norm() < SEAM_M && turned_rad < SEAM_RAD {
                course.route.correct_to(self.along_after(course, from_m, step_m, along_m));
            } else {
                let (along_m, left_m) = course.lane().cross_beyond(reached.point, along_m);
                let ahead_rad = course.lane().place_beyond(along_m).heading_rad;
                let slope = frames::math::sin(frames::wrap_pi(reached.heading_rad - ahead_rad));
                course.lateral.cross_seam([left_m, slope], self.speed_mps);
                course.route.correct_to(along_m);
            }
            course.route.choose_turn_lane(course.net);
        }
        self.at = course.point_at(course.route.along_m());
    }

    /// Moves the followed point one step along its course, and turns the body after it: the rear axle never
    /// slides sideways (the kinematic bicycle with its reference in the middle between the axles). Returns
    /// whether it moved.
    pub(super) fn advance(&mut self, course: &mut Course<'_>, model: &Model, acceleration_mps2: f64) -> bool {
        let dt = FRAME_PERIOD_S;
        let mut speed = (self.speed_mps + acceleration_mps2 * dt).max(0.0);
        if speed < STANDS_MPS && acceleration_mps2 < 0.1 {
            speed = 0.0;
        }
        let mut step = 0.5 * (self.speed_mps + speed) * dt;
        let remaining = course.route.remaining_m(course.net);
        if step >= remaining {
            step = remaining.max(0.0);
            speed = 0.0;
        }
        self.acceleration_mps2 = (speed - self.speed_mps) / dt;
        self.speed_mps = speed;
        let before_rad = self.yaw_rad;
        let moves = step > 0.0;
        if moves {
            let from = self.at.point;
            self.rolled_m += step;
            course.lateral.advance(step);
            self.go(course, step);
            self.turn_after(&from, half_base_m(model));
        }
        let turn = frames::wrap_pi(self.yaw_rad - before_rad) / dt;
        self.sway.step(self.acceleration_mps2, speed * turn, &springs(model), dt);
        moves
    }

    /// Turns the body after its followed point, which has come straight from another place.
    fn turn_after(&mut self, from: &Point3<f64>, half_base_m: f64) {
        self.yaw_rad = after_rod(self.yaw_rad, &(self.at.point - from), half_base_m);
        // The bicycle model: seen from the rear axle, the front axle is twice as far ahead as the middle.
        let slip = frames::wrap_pi(self.at.heading_rad - self.yaw_rad).clamp(-1.5, 1.5);
        self.steer_rad =
            frames::math::atan(2.0 * frames::math::tan(slip)).clamp(-MAX_STEER_RAD, MAX_STEER_RAD);
    }

    /// It has been driving at this speed before the scene began.
    pub(super) fn roll(&mut self, speed_mps: f64) {
        self.speed_mps = speed_mps;
    }

    /// Something pushed it aside: goes on from where its body is, back to its course over some metres.
    pub(super) fn nudge(&mut self, course: &mut Course<'_>, body: &BodyMotion) {
        let point = Point3::new(body.x_m, body.y_m, self.at.point.z);
        let (along_m, left_m) = course.lane().cross_beyond(point, course.route.along_m());
        course.route.advance_to(along_m);
        course.lateral.cross_seam([left_m, 0.0], self.speed_mps);
        self.at = course.point_at(along_m);
        self.yaw_rad = body.yaw_rad;
        let (sin, cos) = frames::math::sin_cos(self.yaw_rad);
        let [x, y] = body.velocity_mps;
        self.speed_mps = (x * cos + y * sin).clamp(0.0, self.speed_mps);
    }

    /// Nothing moves it any more.
    pub(super) fn rest(&mut self) {
        self.acceleration_mps2 = 0.0;
    }

    /// It touched something: nobody drives it from now on.
    pub(super) fn crash(&mut self) {
        self.crashed = true;
    }

    /// Takes over where the body of a crashed vehicle has skidded to, on the plane of the last place on its
    /// route.
    pub(super) fn skid_to(&mut self, body: &BodyMotion, model: &Model) {
        let at = &mut self.at;
        let (sin, cos) = frames::math::sin_cos(at.heading_rad);
        let (dx, dy) = (body.x_m - at.point.x, body.y_m - at.point.y);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let z = at.point.z - ahead * frames::math::tan(at.pitch_rad) + left * frames::math::tan(at.roll_rad);
        at.point = Point3::new(body.x_m, body.y_m, z);
        self.yaw_rad = body.yaw_rad;
        let [x, y] = body.velocity_mps;
        self.speed_mps = (x * x + y * y).sqrt();
        self.acceleration_mps2 = -COMFORT_BRAKING;
        // Nothing holds the body where it leaned when it hit.
        self.sway.step(0.0, 0.0, &springs(model), FRAME_PERIOD_S);
    }
}

/// What a followed point moves along: the lanes of a route, and beside their middles where it changes lanes.
pub(super) struct Course<'a> {
    pub(super) net: &'a Net,
    pub(super) route: &'a mut Route,
    pub(super) lateral: &'a mut Lateral,
}

impl Course<'_> {
    /// The middle of the lane it is on.
    fn lane(&self) -> &Centreline {
        &self.net.lanes[self.route.lane()].centre
    }

    /// The followed point at a distance along the lane it is on, or along its straight continuation: in the
    /// middle, or beside it.
    fn point_at(&self, along_m: f64) -> CentrelinePoint {
        let mut at = self.lane().place_beyond(along_m);
        let [left, slope] = self.lateral.offset_after(0.0);
        if left != 0.0 || slope != 0.0 {
            let (sin, cos) = frames::math::sin_cos(at.heading_rad);
            let up = left * frames::math::tan(at.roll_rad);
            at.point += Vector3::new(-sin * left, cos * left, up);
            // The slope is one of metres gone, not of metres along the lane.
            at.heading_rad = frames::wrap_pi(at.heading_rad + frames::math::asin(slope.clamp(-0.9, 0.9)));
        }
        at
    }
}

/// Heading of a rod whose front end is dragged straight on from one place to another, while its hind end,
/// `rod_m` behind, rolls after it: tan(slip / 2) decays with the way over the rod's length.
pub(crate) fn after_rod(yaw_rad: f64, moved: &Vector3<f64>, rod_m: f64) -> f64 {
    let way = (moved.x * moved.x + moved.y * moved.y).sqrt();
    if way < 1e-9 {
        return yaw_rad;
    }
    let towards = heading(moved);
    let slip = frames::wrap_pi(towards - yaw_rad).clamp(-1.5, 1.5);
    let half = frames::math::tan(0.5 * slip) * frames::math::exp(-way / rod_m);
    frames::wrap_pi(towards - 2.0 * frames::math::atan(half))
}
