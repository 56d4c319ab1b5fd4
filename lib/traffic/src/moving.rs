//! How a vehicle moves: its followed point on the route by exactly the way that its speed asks for, its body after it.

use nalgebra::{Point3, Vector3};
use schema::FRAME_PERIOD_S;
use schema::models::{BaseType, swept_m};

use crate::net::Net;
use crate::vehicles::Vehicle;
use crate::ways::{Place, heading};

/// Largest steering angle, radians: that of a town bus's inner wheel.
const MAX_STEER_RAD: f64 = 0.9;
/// Ways are gone to this accuracy, metres: 0.2 mm/s.
const EXACT_M: f64 = 1e-5;
/// Most trials to do so.
const TRIALS: usize = 12;
/// Who brakes and is slower than this stands, m/s.
const STANDS_MPS: f64 = 0.004;
/// Where ways meet less exactly than this, what is left wears off, metres; over how many seconds, and metres at least.
const SEAM_M: f64 = 1e-3;
const WEARS_OFF_S: f64 = 1.0;
const WEARS_OFF_M: f64 = 3.0;

/// A way from beside a lane's middle to the middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glide {
    /// Place to the left of the middle at the beginning, metres.
    pub(crate) from_m: f64,
    /// Way over and way gone, metres.
    pub(crate) span_m: f64,
    pub(crate) gone_m: f64,
}

impl Glide {
    /// Goes on; whether the middle is not reached yet.
    pub(crate) fn advance(&mut self, step_m: f64) -> bool {
        self.gone_m += step_m;
        self.gone_m < self.span_m
    }

    /// Place to the left of the lane's middle, metres, and its change per metre of way: a quintic whose slope and curvature
    /// are zero at both ends.
    pub(crate) fn offset(&self) -> [f64; 2] {
        let u = (self.gone_m / self.span_m).clamp(0.0, 1.0);
        let share = u * u * u * (10.0 - u * (15.0 - 6.0 * u));
        let slope = 30.0 * u * u * (1.0 - u) * (1.0 - u);
        [self.from_m * (1.0 - share), -self.from_m * slope / self.span_m]
    }
}

impl Vehicle {
    /// The followed point's place to the left of the lane's middle, metres, and its change per metre of way.
    fn offset(&self) -> [f64; 2] {
        self.offset_after(0.0)
    }

    /// The same after some more metres of way.
    pub(crate) fn offset_after(&self, on_m: f64) -> [f64; 2] {
        let glides = self.shift.iter().map(|s| s.glide).chain(self.slack);
        let after = glides.map(|g| Glide { gone_m: g.gone_m + on_m, ..g }.offset());
        after.fold([0.0; 2], |sum, o| [sum[0] + o[0], sum[1] + o[1]])
    }

    /// From the middle back to the rear axle, metres.
    pub(crate) fn half_base_m(&self) -> f64 {
        0.5 * self.model.wheelbase_m.max(0.5)
    }

    /// How far it reaches inwards and outwards from a circle that its middle goes round on, metres.
    pub(crate) fn reaches_m(&self, radius_m: f64) -> [f64; 2] {
        let [length, width, _] = self.model.size_m;
        swept_m([length, width], self.half_base_m(), radius_m)
    }

    /// The followed point's place at a distance along the lane it is on, or along its straight continuation: in the middle,
    /// or beside it.
    fn place_at(&self, net: &Net, along_m: f64) -> Place {
        let mut place = net.lanes[self.route[0]].way.place_beyond(along_m);
        let [left, slope] = self.offset();
        if left != 0.0 || slope != 0.0 {
            let (sin, cos) = frames::math::sin_cos(place.heading_rad);
            let up = left * frames::math::tan(place.roll_rad);
            place.point += Vector3::new(-sin * left, cos * left, up);
            // The slope is one of metres gone, not of metres along the lane.
            place.heading_rad =
                frames::wrap_pi(place.heading_rad + frames::math::asin(slope.clamp(-0.9, 0.9)));
        }
        place
    }

    /// Metres along the lane to the place that lies a way on in space from where the vehicle is, which is at `from_m` on this
    /// lane: fewer than that way while crossing over, more on the inside of a bend. By secants, from a guess.
    fn along_after(&self, net: &Net, from_m: f64, step_m: f64, guess_m: f64) -> f64 {
        let (mut before, mut along_m) = ((from_m, -step_m), guess_m);
        for _ in 0..TRIALS {
            let off_m = (self.place_at(net, along_m).point - self.place.point).norm() - step_m;
            if off_m.abs() < EXACT_M {
                break;
            }
            let slope = (off_m - before.1) / (along_m - before.0);
            before = (along_m, off_m);
            // Way in space grows with way along the lane, at half to twice its rate in any bend that is driven.
            let slope = if slope.is_finite() { slope.clamp(0.3, 3.0) } else { 1.0 };
            along_m = (along_m - off_m / slope).clamp(from_m, from_m + 4.0 * step_m);
        }
        along_m
    }

    /// Moves the followed point a way on in space, over to the next lanes where they begin. Where the ends of two ways do not
    /// meet, or meet at an angle while the vehicle is beside their middles, it does not jump: what it is then off the new
    /// way wears off.
    fn go(&mut self, net: &Net, step_m: f64) {
        let mut from_m = self.along_m;
        self.along_m = self.along_after(net, from_m, step_m, from_m + step_m);
        self.odometer_m += self.along_m - from_m;
        while self.route.len() > 1 && self.along_m >= net.lanes[self.route[0]].way.length_m {
            let length_m = net.lanes[self.route[0]].way.length_m;
            let (end, reached) = (self.place_at(net, length_m).point, self.place_at(net, self.along_m).point);
            self.route.pop_front();
            self.along_m -= length_m;
            from_m -= length_m;
            if (self.place_at(net, 0.0).point - end).norm() < SEAM_M {
                self.along_m = self.along_after(net, from_m, step_m, self.along_m);
            } else {
                let (along_m, left_m) = net.lanes[self.route[0]].way.cross_beyond(reached, self.along_m);
                self.slack = None;
                let span_m = (WEARS_OFF_S * self.speed_mps).max(WEARS_OFF_M);
                self.slack = Some(Glide { from_m: left_m - self.offset()[0], span_m, gone_m: 0.0 });
                self.along_m = along_m;
            }
            self.arrive(net);
        }
        self.extend_route(net);
        self.place = self.place_at(net, self.along_m);
    }

    /// Moves the followed point one step along the route, and turns the body after it: the rear axle never slides
    /// sideways (the kinematic bicycle with its reference in the middle between the axles).
    pub(crate) fn advance(&mut self, net: &Net, acceleration_mps2: f64) {
        let dt = FRAME_PERIOD_S;
        let mut speed = (self.speed_mps + acceleration_mps2 * dt).max(0.0);
        if speed < STANDS_MPS && acceleration_mps2 < 0.1 {
            speed = 0.0;
        }
        let mut step = 0.5 * (self.speed_mps + speed) * dt;
        let remaining: f64 =
            self.route.iter().map(|&l| net.lanes[l].way.length_m).sum::<f64>() - self.along_m;
        if step >= remaining {
            step = remaining.max(0.0);
            speed = 0.0;
        }
        self.acceleration_mps2 = (speed - self.speed_mps) / dt;
        self.speed_mps = speed;
        let before_rad = self.yaw_rad;
        if step > 0.0 {
            let from = self.place.point;
            self.rolled_m += step;
            if self.shift.as_mut().is_some_and(|shift| !shift.glide.advance(step)) {
                self.shift = None;
            }
            if self.slack.as_mut().is_some_and(|slack| !slack.advance(step)) {
                self.slack = None;
            }
            self.go(net, step);
            self.turn_after(&from);
        }
        let turn = frames::wrap_pi(self.yaw_rad - before_rad) / dt;
        let two_wheeled = matches!(self.model.base, BaseType::Motorcycle | BaseType::Bicycle);
        self.sway.step(self.acceleration_mps2, speed * turn, two_wheeled, dt);
    }

    /// Turns the body after its followed point, which has come straight from another place.
    fn turn_after(&mut self, from: &Point3<f64>) {
        self.yaw_rad = after_rod(self.yaw_rad, &(self.place.point - from), self.half_base_m());
        // The bicycle model: seen from the rear axle, the front axle is twice as far ahead as the middle.
        let slip = frames::wrap_pi(self.place.heading_rad - self.yaw_rad).clamp(-1.5, 1.5);
        self.steer_rad =
            frames::math::atan(2.0 * frames::math::tan(slip)).clamp(-MAX_STEER_RAD, MAX_STEER_RAD);
    }

    /// Ground point under a crashed vehicle: the plane of the last place on the route.
    pub(crate) fn slide_to(&mut self, x_m: f64, y_m: f64) {
        let place = &mut self.place;
        let (sin, cos) = frames::math::sin_cos(place.heading_rad);
        let (dx, dy) = (x_m - place.point.x, y_m - place.point.y);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let z = place.point.z - ahead * frames::math::tan(place.pitch_rad)
            + left * frames::math::tan(place.roll_rad);
        place.point = Point3::new(x_m, y_m, z);
    }
}

/// Heading of a rod whose front end is dragged straight on from one place to another, while its hind end, `rod_m` behind,
/// rolls after it: tan(slip / 2) decays with the way over the rod's length.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_over_begins_and_ends_along_the_lanes() {
        let at = |gone_m: f64| Glide { from_m: -3.5, span_m: 40.0, gone_m }.offset();
        assert_eq!(at(0.0), [-3.5, 0.0]);
        assert_eq!(at(40.0)[0].abs(), 0.0);
        assert!((at(20.0)[0] + 1.75).abs() < 1e-12);
        for k in 1..400 {
            let gone = 0.1 * f64::from(k);
            let slope = (at(gone + 1e-5)[0] - at(gone - 1e-5)[0]) / 2e-5;
            assert!((at(gone)[1] - slope).abs() < 1e-8, "at {gone}: {} instead of {slope}", at(gone)[1]);
            assert!((0.0..=1.875 * 3.5 / 40.0 + 1e-12).contains(&at(gone)[1]));
        }
    }
}
