//! A vehicle. Each part of it changes its own data alone; others read it, or call its methods.
//!
//! * [`Route`]: where it goes
//! * [`Motion`]: where it is
//! * [`Lateral`]: its offset from the middle of its lane
//! * [`Driver`]: how its driver behaves
//! * [`LaneChoice`]: which lane it asks for
//! * [`Claim`]: what is reserved for it in junctions
//! * [`Doors`]: which doors are open
//! * [`Towed`]: the section that it tows

pub(crate) mod activity;
pub(crate) mod attention;
pub(crate) mod claim;
pub(crate) mod doors;
pub(crate) mod driver;
pub(crate) mod given_route;
pub(crate) mod lane_choice;
pub(crate) mod lateral;
pub(crate) mod motion;
pub(crate) mod route;
pub(crate) mod sway;
pub(crate) mod towed;

use catalogue::{BaseType, Model, swept_m};
use nalgebra::{Point3, Vector3};

use self::activity::Activity;
use self::claim::Claim;
use self::doors::Doors;
use self::driver::Driver;
use self::lane_choice::LaneChoice;
use self::lateral::{LaneChange, Lateral};
use self::motion::{Course, Motion, half_base_m};
use self::route::Route;
use self::towed::Towed;
use crate::bodies::{Body, BodyMotion};
use crate::car_following::envelope;
use crate::road::kerbside::Kerbside;
use crate::road::net::{Net, PLANNED_BRAKING, bend_speed};
use crate::road::sides::Side;

/// Bicycles go no faster, m/s.
const BICYCLE_MPS: f64 = 8.0;
/// Slower than this is standing, m/s.
const STANDING_MPS: f64 = 0.3;
/// Lookahead at rest, metres.
const NEAR_M: f64 = 40.0;
/// Routes are drawn so much farther than drivers look, metres.
const BEYOND_VIEW_M: f64 = 60.0;
/// Drivers make room for what reaches into their lane from so far before it on, metres and seconds, until
/// they are so far past it, metres; they go back over so much way.
const ASIDE_FROM_M: f64 = 10.0;
const ASIDE_FROM_S: f64 = 3.0;
const ASIDE_PAST_M: f64 = 0.5;
const BACK_S: f64 = 2.5;
/// The shortest way aside, metres.
const SHORTEST_ASIDE_M: f64 = 6.0;
/// Nobody steers for less than this, metres.
const ASIDE_M: f64 = 0.02;
/// Sideways acceleration that drivers accept who change lanes or go aside, m/s2; their way is looked at in so
/// many parts.
const SWERVE_MPS2: f64 = 3.4;
const SWERVE_PARTS: u32 = 10;
/// Drivers stop this far before the end of a road, metres.
const ROAD_END_M: f64 = 1.0;

/// A vehicle. The followed point is the middle of its footprint, which moves along the route.
#[derive(Debug)]
pub(crate) struct Vehicle {
    model: &'static Model,
    /// Its emergency lights flash.
    flashes: bool,
    driver: Driver,
    route: Route,
    lateral: Lateral,
    lane_choice: LaneChoice,
    motion: Motion,
    claim: Claim,
    doors: Doors,
    towed: Option<Towed>,
    wake: Activity,
    /// Its odometer where it has passed what it keeps aside of, metres.
    aside_until_m: f64,
}

impl Vehicle {
    /// Awake where its route and its motion begin, with nothing reserved.
    pub(crate) fn new(
        net: &Net,
        model: &'static Model,
        driver: Driver,
        route: Route,
        motion: Motion,
        doors: Doors,
        flashes: bool,
    ) -> Self {
        let mut vehicle = Self {
            model,
            flashes,
            driver,
            route,
            lateral: Lateral::default(),
            lane_choice: LaneChoice::default(),
            motion,
            claim: Claim::default(),
            doors,
            towed: None,
            wake: Activity::Awake,
            aside_until_m: f64::NEG_INFINITY,
        };
        vehicle.route.choose_turn_lane(net);
        vehicle.draw_route(net);
        vehicle
    }

    /// It tows something.
    pub(crate) fn towing(self, towed: Option<Towed>) -> Self {
        Self { towed, ..self }
    }

    pub(crate) fn model(&self) -> &'static Model {
        self.model
    }

    /// What it tows.
    pub(crate) fn towed(&self) -> Option<&Towed> {
        self.towed.as_ref()
    }

    /// Its bodies, and what it tows after it: middle on the ground, yaw and size.
    pub(crate) fn sections(&self) -> impl Iterator<Item = (Point3<f64>, f64, [f64; 3])> {
        let own = (self.motion.position(), self.motion.yaw_rad(), self.model.size_m);
        let towed = self.towed.as_ref().map(|t| (t.position(), t.yaw_rad(), t.train().towed.size_m));
        std::iter::once(own).chain(towed)
    }

    /// The bodies that the engine of physics moves.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = Body> {
        std::iter::once(self.motion.body()).chain(self.towed.as_ref().map(Towed::body))
    }

    /// Whether its emergency lights flash.
    pub(crate) fn flashes(&self) -> bool {
        self.flashes
    }

    pub(crate) fn driver(&self) -> &Driver {
        &self.driver
    }

    pub(crate) fn route(&self) -> &Route {
        &self.route
    }

    pub(crate) fn lateral(&self) -> &Lateral {
        &self.lateral
    }

    pub(crate) fn lane_choice(&self) -> &LaneChoice {
        &self.lane_choice
    }

    pub(crate) fn motion(&self) -> &Motion {
        &self.motion
    }

    pub(crate) fn claim(&self) -> &Claim {
        &self.claim
    }

    pub(crate) fn doors(&self) -> &Doors {
        &self.doors
    }

    pub(crate) fn wake(&self) -> Activity {
        self.wake
    }

    pub(crate) fn speed_mps(&self) -> f64 {
        self.motion.speed_mps()
    }

    /// Whether it stands, or hardly moves.
    pub(crate) fn stands(&self) -> bool {
        self.speed_mps() < STANDING_MPS
    }

    pub(crate) fn is_crashed(&self) -> bool {
        self.motion.is_crashed()
    }

    /// From its front to its rear, what it tows included, metres.
    pub(crate) fn length_m(&self) -> f64 {
        match &self.towed {
            Some(towed) => self.half_length_m() + towed.train().rear_m(),
            None => self.model.size_m[0],
        }
    }

    /// From its middle back to the rear of what it tows, or its own, metres.
    pub(crate) fn rear_m(&self) -> f64 {
        self.towed.as_ref().map_or(self.half_length_m(), |towed| towed.train().rear_m())
    }

    /// From its middle to its front, and to its own rear, metres.
    pub(crate) fn half_length_m(&self) -> f64 {
        0.5 * self.model.size_m[0]
    }

    /// From the middle between the axles back to the rear one, metres.
    pub(crate) fn half_base_m(&self) -> f64 {
        half_base_m(self.model)
    }

    /// How far it reaches inwards and outwards from a circle that its middle goes round on, metres.
    pub(crate) fn reaches_m(&self, radius_m: f64) -> [f64; 2] {
        let [length, width, _] = self.model.size_m;
        let [inwards_m, outwards_m] = swept_m([length, width], self.half_base_m(), radius_m);
        let Some(train) = self.towed.as_ref().map(Towed::train) else { return [inwards_m, outwards_m] };
        // What is towed cuts the corner; in most bends by less than it would on a whole circle.
        let towed_m = radius_m - train.axle_radius_m(radius_m) + 0.5 * train.towed.size_m[1];
        [inwards_m.max(towed_m), outwards_m]
    }

    /// How far ahead it looks, metres.
    pub(crate) fn view_m(&self) -> f64 {
        let speed = self.speed_mps();
        NEAR_M + 2.0 * speed + speed * speed / (2.0 * PLANNED_BRAKING)
    }

    /// The lanes of the route with the way from the vehicle's middle to their beginnings (negative for the
    /// first).
    pub(crate) fn lanes_ahead<'a>(&'a self, net: &'a Net) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.route.lanes_ahead(net)
    }

    /// The followed point after some more metres of way; none beyond the end of the route.
    pub(crate) fn point_ahead(&self, net: &Net, on_m: f64) -> Option<Point3<f64>> {
        let length = |lane: usize| net.lanes[lane].centre.length_m;
        let (lane, start) = self.lanes_ahead(net).find(|(lane, start)| on_m <= start + length(*lane))?;
        let place = net.lanes[lane].centre.place(on_m - start);
        let left = self.lateral.offset_after(on_m)[0];
        let (sin, cos) = frames::math::sin_cos(place.heading_rad);
        Some(place.point + Vector3::new(-sin, cos, 0.0) * left)
    }

    /// The side that it asks to be let in to.
    pub(crate) fn asked_side(&self, net: &Net) -> Option<Side> {
        let wanted = self.lane_choice.wanted()?;
        let beside = &net.lanes[self.route.lane()].beside;
        Side::BOTH.into_iter().find(|s| beside[*s as usize].as_ref().is_some_and(|b| b.lane == wanted))
    }

    /// From the front to the next junction on the route, metres; far where none is in view.
    pub(crate) fn junction_gap_m(&self, net: &Net) -> f64 {
        let mut ahead = self.lanes_ahead(net);
        let next = ahead.find(|(lane, _)| net.lanes[*lane].junction.is_some());
        next.map_or(f64::INFINITY, |(_, start)| start - self.half_length_m())
    }

    /// From the front to the place to stop at the end of a road that leads nowhere, metres, where one is in
    /// view.
    pub(crate) fn end_of_road_m(&self, net: &Net) -> Option<f64> {
        let leads_on = self.route.last().is_some_and(|l| !net.lanes[l].next.is_empty());
        let end = self.lanes_ahead(net).last().map_or(0.0, |(lane, start)| start + net.lanes[lane].usable_m);
        (!leads_on).then_some(end - self.half_length_m() - ROAD_END_M)
    }

    /// The wished speed on a lane without traffic and curves, m/s.
    fn lane_speed(&self, net: &Net, lane: usize) -> f64 {
        let speed = net.lanes[lane].limit_mps * (1.0 - self.driver.profile().speed_difference);
        if self.model.base == BaseType::Bicycle { speed.min(BICYCLE_MPS) } else { speed }
    }

    /// The wished speed here without traffic, m/s.
    pub(crate) fn speed_here(&self, net: &Net) -> f64 {
        let (lane, along_m) = (self.route.lane(), self.route.along_m());
        self.lane_speed(net, lane).min(net.curve_speed(lane, along_m)).max(0.1)
    }

    /// The wished speed here: limits and curves, ahead too.
    pub(crate) fn wished_speed(&self, net: &Net) -> f64 {
        let [limit, bend] = self.wished_speeds(net);
        limit.min(bend).max(0.1)
    }

    /// The speeds wished for here for the sake of limits and of bends, ahead too.
    pub(crate) fn wished_speeds(&self, net: &Net) -> [f64; 2] {
        let mut wished = [f64::INFINITY, self.swerve_speed(net)];
        let view = self.view_m();
        for (lane, start) in self.lanes_ahead(net) {
            if start > view {
                break;
            }
            let (limit, curve) = if start <= 0.0 {
                (self.lane_speed(net, lane), net.curve_speed(lane, self.route.along_m()))
            } else {
                let before = start - self.half_length_m();
                (
                    envelope(self.lane_speed(net, lane), before, PLANNED_BRAKING),
                    envelope(net.lanes[lane].curve_mps[0], before, PLANNED_BRAKING),
                )
            };
            wished = [wished[0].min(limit), wished[1].min(curve)];
        }
        wished
    }

    /// The speed at which it changes lanes or goes aside at ease, in a bend too, m/s.
    fn swerve_speed(&self, net: &Net) -> f64 {
        let Some(rest_m) = self.lateral.rest_m() else { return f64::INFINITY };
        let (mut lane, mut start_m) = (self.route.lane(), -self.route.along_m());
        let mut ahead = self.lanes_ahead(net).peekable();
        let mut least = f64::INFINITY;
        for k in 0..=SWERVE_PARTS {
            let on_m = rest_m * f64::from(k) / f64::from(SWERVE_PARTS);
            while let Some(next) = ahead.next_if(|(_, start_m)| *start_m <= on_m) {
                (lane, start_m) = next;
            }
            let bend = net.curvature(lane, on_m - start_m) + self.lateral.bend_after(on_m);
            least = least.min(envelope(bend_speed(bend, SWERVE_MPS2), on_m, PLANNED_BRAKING));
        }
        least
    }
}

/// What happens to a vehicle.
impl Vehicle {
    pub(crate) fn claim_mut(&mut self) -> &mut Claim {
        &mut self.claim
    }

    pub(crate) fn lane_choice_mut(&mut self) -> &mut LaneChoice {
        &mut self.lane_choice
    }

    /// Draws branches until the route reaches beyond the view.
    fn draw_route(&mut self, net: &Net) {
        let reach_m = self.view_m() + BEYOND_VIEW_M;
        self.route.extend(net, reach_m);
    }

    /// The driver looks about: draws what it overlooks in a step.
    pub(crate) fn perceive(&mut self, step: u32) {
        self.driver.perceive(step);
    }

    /// Begins a lane change to a place beside.
    pub(crate) fn change_lane(&mut self, net: &Net, (lane, along_m): (usize, f64), change: LaneChange) {
        self.route.change_to(lane, along_m);
        self.lateral.begin(change);
        self.claim.leave_line();
        self.route.choose_turn_lane(net);
        self.draw_route(net);
    }

    /// Drives for a step at an acceleration.
    pub(crate) fn drive(&mut self, net: &Net, acceleration_mps2: f64) {
        let mut course = Course { net, route: &mut self.route, lateral: &mut self.lateral };
        if self.motion.advance(&mut course, self.model, acceleration_mps2) {
            self.draw_route(net);
        }
        if let Some(towed) = &mut self.towed {
            let train = towed.train();
            let under = self.route.place_behind(net, train.hitch_m + train.rod_m);
            towed.follow(self.motion.hitch(train), &under);
        }
    }

    /// It has been driving at this speed before the scene began.
    pub(crate) fn roll(&mut self, net: &Net, speed_mps: f64) {
        self.motion.roll(speed_mps);
        self.draw_route(net);
    }

    /// Keeps clear of parked vehicles that reach into its lane and leave room to pass.
    pub(crate) fn make_room(&mut self, net: &Net, kerbside: &Kerbside) {
        let (half_m, width_m, speed) = (self.half_length_m(), self.model.size_m[1], self.speed_mps());
        let rear_m = self.rear_m();
        let view_m = half_m + ASIDE_FROM_M + ASIDE_FROM_S * speed;
        let (mut room_m, mut first_m) = ([f64::NEG_INFINITY, f64::INFINITY], f64::INFINITY);
        let mut past_m = f64::NEG_INFINITY;
        for (lane, start) in self.route.lanes_ahead(net).take_while(|(_, start)| *start < view_m) {
            for intrusion in kerbside.on_lane(lane).iter().filter(|i| i.lets_by(width_m)) {
                let [from_m, to_m] = intrusion.along_m.map(|along_m| start + along_m);
                if from_m < view_m && to_m + rear_m + ASIDE_PAST_M > 0.0 {
                    let [low, high] = intrusion.room_m(width_m);
                    room_m = [room_m[0].max(low), room_m[1].min(high)];
                    first_m = first_m.min(from_m - half_m - ASIDE_PAST_M);
                    past_m = past_m.max(to_m + rear_m + ASIDE_PAST_M);
                }
            }
        }
        let odometer_m = self.route.odometer_m();
        let kept_m = self.lateral.kept_aside_m();
        let wished_m = if room_m[0] > room_m[1] {
            0.5 * (room_m[0] + room_m[1])
        } else {
            0f64.clamp(room_m[0], room_m[1])
        };
        // The one that it is still beside may be on the lane before.
        let stays = odometer_m < self.aside_until_m && kept_m.abs() > wished_m.abs();
        if first_m.is_finite() && wished_m != 0.0 {
            self.aside_until_m = odometer_m + past_m;
        }
        if stays || (wished_m - kept_m).abs() < ASIDE_M {
            return;
        }
        let span_m = if wished_m.abs() > kept_m.abs() {
            first_m.clamp(SHORTEST_ASIDE_M, SHORTEST_ASIDE_M.max(ASIDE_FROM_S * speed))
        } else {
            (BACK_S * speed).max(SHORTEST_ASIDE_M)
        };
        self.lateral.keep_aside(wished_m, span_m);
    }

    /// Something pushed it aside without more harm: it drives on from where its body is.
    pub(crate) fn nudge(&mut self, net: &Net, body: &BodyMotion) {
        let mut course = Course { net, route: &mut self.route, lateral: &mut self.lateral };
        self.motion.nudge(&mut course, body);
    }

    /// It touched something: nobody drives it from now on.
    pub(crate) fn crash(&mut self) {
        self.motion.crash();
    }

    /// Takes over where the body of a crashed vehicle has skidded to.
    pub(crate) fn skid_to(&mut self, body: &BodyMotion) {
        self.motion.skid_to(body, self.model);
    }

    /// The same of what it tows.
    pub(crate) fn towed_skids_to(&mut self, body: &BodyMotion) {
        if let Some(towed) = &mut self.towed {
            towed.skid_to(body);
        }
    }

    /// Those inside may open doors while it stands, or shut them.
    pub(crate) fn move_doors(&mut self) {
        self.doors.step(self.motion.speed_mps());
    }

    /// Sets its activity; an inactive vehicle waits for no other one.
    pub(crate) fn set_wake(&mut self, wake: Activity) {
        if wake == Activity::Asleep && self.wake != Activity::Asleep {
            self.motion.rest();
            self.claim.stop_waiting();
            self.claim.yield_to(Vec::new());
        }
        self.wake = wake;
    }
}
