//! How people can move: how hard they push off and brake, how fast they turn and climb, by what they have
//! with them. Everything that moves a walker keeps to these bounds, but for what hits it.

use catalogue::{Model, Special};
use nalgebra::Vector2;
use schema::FRAME_PERIOD_S;

/// Fastest change of velocity in the plane, and up and down, m/s2: 3 in all.
pub(crate) const PUSH_MPS2: f64 = 2.6;

/// How long somebody needs to get over a road and clear of it, from standing, seconds.
pub(crate) fn needed_s(length_m: f64, speed_mps: f64) -> f64 {
    length_m / speed_mps + 1.0 + speed_mps / PUSH_MPS2
}
const CLIMB_MPS2: f64 = 1.45;
/// Nobody runs faster, m/s: joggers.
pub(crate) const RUN_MPS: f64 = 3.3;
/// Slower than this somebody stands, m/s.
pub(crate) const STANDS_MPS: f64 = 0.3;
/// Fastest turns, radians per second: standing, walking, and of what rolls.
const TURN_STANDING_RADPS: f64 = std::f64::consts::PI;
const TURN_WALKING_RADPS: f64 = std::f64::consts::FRAC_PI_2;
const TURN_ROLLING_RADPS: f64 = std::f64::consts::FRAC_PI_3;
/// What rolls gains and loses speed by no more than this of its own accord, m/s2, as it turns at the same
/// time.
const ROLL_MPS2: f64 = 1.4;
/// What rolls and goes aside goes on as if at this speed, m/s.
const ROLLS_ON_MPS: f64 = 0.5;
/// It is pulled back no faster than this, m/s.
const BACK_MPS: f64 = 0.7;
/// Who looks aside of the way by more than the first angle slows down, and stands to turn at the second one,
/// radians.
const LOOKS_RAD: [f64; 2] = [0.9, 2.1];

/// How a walker moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gait {
    /// On its own feet, which go to all sides.
    Feet,
    /// On wheels, which go where they point: a wheelchair, a pram.
    Wheels,
}

impl Gait {
    pub(crate) fn of(model: &Model) -> Self {
        let rolls = matches!(model.special, Special::Wheelchair | Special::Pram);
        if rolls { Self::Wheels } else { Self::Feet }
    }

    /// The heading after a step of turning towards another one, at a speed.
    pub(crate) fn turned(self, yaw_rad: f64, to_rad: f64, speed_mps: f64) -> f64 {
        let most_radps = match self {
            Self::Wheels => TURN_ROLLING_RADPS,
            Self::Feet if speed_mps < STANDS_MPS => TURN_STANDING_RADPS,
            Self::Feet => TURN_WALKING_RADPS,
        };
        let most = most_radps * FRAME_PERIOD_S;
        frames::wrap_pi(yaw_rad + frames::wrap_pi(to_rad - yaw_rad).clamp(-most, most))
    }
}

/// Share of its speed at which somebody goes a way that lies so far aside of where it looks.
pub(crate) fn share_of_speed(aside_rad: f64) -> f64 {
    let [full, none] = LOOKS_RAD;
    ((none - aside_rad.abs()) / (none - full)).clamp(0.0, 1.0)
}

/// The velocity after a step of changing it towards another one.
pub(crate) fn pushed(velocity_mps: Vector2<f64>, to_mps: Vector2<f64>) -> Vector2<f64> {
    let change = to_mps - velocity_mps;
    let most = PUSH_MPS2 * FRAME_PERIOD_S;
    velocity_mps + change * (most / change.norm().max(most))
}

/// The velocity after a step of braking.
pub(crate) fn braked(velocity_mps: Vector2<f64>) -> Vector2<f64> {
    pushed(velocity_mps, Vector2::zeros())
}

/// The way that is gone while braking from now on, metres.
pub(crate) fn braking_way(velocity_mps: &Vector2<f64>) -> Vector2<f64> {
    velocity_mps * (velocity_mps.norm() / (2.0 * PUSH_MPS2))
}

/// The same of one who goes on for a step before.
pub(crate) fn stopping_way(velocity_mps: &Vector2<f64>) -> Vector2<f64> {
    velocity_mps * FRAME_PERIOD_S + braking_way(velocity_mps)
}

/// Something on wheels, which goes where they point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rolling {
    pub(crate) yaw_rad: f64,
    pub(crate) velocity_mps: Vector2<f64>,
}

impl Rolling {
    fn ahead(yaw_rad: f64) -> Vector2<f64> {
        let (sin, cos) = frames::math::sin_cos(yaw_rad);
        Vector2::new(cos, sin)
    }

    /// Along its wheels; negative backwards.
    pub(crate) fn speed_mps(&self) -> f64 {
        self.velocity_mps.dot(&Self::ahead(self.yaw_rad))
    }

    /// Turns towards a velocity, for a step, and rolls on where the wheels point then if that is free; else
    /// brakes, and turns when it stands. Whoever `flees` something may be pulled back.
    pub(crate) fn step(
        &self,
        on: &Vector2<f64>,
        choice: Vector2<f64>,
        flees: bool,
        free: &dyn Fn(&Vector2<f64>) -> bool,
    ) -> Self {
        // It cannot go aside alone.
        let aside = choice + on * (ROLLS_ON_MPS - choice.dot(on)).max(0.0);
        let backs = flees && choice.dot(&Self::ahead(self.yaw_rad)) < 0.0;
        let to_rad = if backs { self.yaw_rad } else { frames::math::atan2(aside.y, aside.x) };
        let yaw_rad = Gait::Wheels.turned(self.yaw_rad, to_rad, 0.0);
        let towards = Self::ahead(yaw_rad);
        // Slower, the more it has to turn still: it needs room for that.
        let aligned = aside.try_normalize(1e-9).unwrap_or(towards).dot(&towards).max(0.0);
        let wished = choice.dot(&towards);
        let to_mps = if backs { wished } else { wished.max(0.0) * aligned * aligned };
        let velocity_mps = towards * rolled(self.speed_mps(), to_mps);
        if free(&velocity_mps) {
            return Self { yaw_rad, velocity_mps };
        }
        let velocity_mps = braked(self.velocity_mps);
        let stands = velocity_mps == Vector2::zeros();
        Self { yaw_rad: if stands { yaw_rad } else { self.yaw_rad }, velocity_mps }
    }
}

/// The speed along its heading of something on wheels after a step, of which one is wished for.
fn rolled(speed_mps: f64, to_mps: f64) -> f64 {
    let most = ROLL_MPS2 * FRAME_PERIOD_S;
    speed_mps + (to_mps.max(-BACK_MPS) - speed_mps).clamp(-most, most)
}

/// The speed upwards after a step of climbing to a height that is so far above, of one who moves on in the
/// plane: it stops there without falling.
pub(crate) fn climbed(upwards_mps: f64, above_m: f64, speed_mps: f64) -> f64 {
    let stops_mps = (1.6 * CLIMB_MPS2 * above_m.abs()).sqrt();
    let to_mps = (above_m.abs() / FRAME_PERIOD_S).min(stops_mps).min(speed_mps).copysign(above_m);
    let most = CLIMB_MPS2 * FRAME_PERIOD_S;
    upwards_mps + (to_mps - upwards_mps).clamp(-most, most)
}

/// The speed at which one can still brake at ease to another speed within a way, m/s.
pub(crate) fn before(speed_mps: f64, way_m: f64) -> f64 {
    (speed_mps * speed_mps + 2.0 * 0.8 * PUSH_MPS2 * way_m.max(0.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_stop_holds_that_of_a_step_later() {
        let mut velocity = Vector2::new(2.0, -1.5);
        while velocity.norm() > 0.0 {
            let later = braked(velocity);
            assert!(stopping_way(&later).norm() <= braking_way(&velocity).norm() + 1e-12, "{velocity}");
            assert!((velocity - later).norm() <= PUSH_MPS2 * FRAME_PERIOD_S + 1e-12);
            velocity = later;
        }
    }

    #[test]
    fn who_climbs_a_kerb_arrives_and_stays() {
        let (mut height, mut upwards) = (0.0_f64, 0.0_f64);
        for _ in 0..60 {
            let next = climbed(upwards, 0.15 - height, 1.3);
            assert!((next - upwards).abs() <= CLIMB_MPS2 * FRAME_PERIOD_S + 1e-12);
            (upwards, height) = (next, height + next * FRAME_PERIOD_S);
            assert!((-1e-9..0.165).contains(&height), "{height}");
        }
        assert!((height - 0.15).abs() < 2e-3 && upwards.abs() < 0.02, "{height} {upwards}");
    }

    #[test]
    fn a_chair_turns_round_and_rolls_back_where_it_came_from() {
        let mut chair = Rolling { yaw_rad: 0.0, velocity_mps: Vector2::new(1.0, 0.0) };
        let on = Vector2::new(-1.0, 0.0);
        let mut turned = 0;
        for _ in 0..120 {
            let aside_rad = frames::wrap_pi(std::f64::consts::PI - chair.yaw_rad);
            let next = chair.step(&on, on * share_of_speed(aside_rad), false, &|_| true);
            assert!((next.velocity_mps - chair.velocity_mps).norm() < 3.0 * FRAME_PERIOD_S);
            assert!(next.velocity_mps.perp(&Rolling::ahead(next.yaw_rad)).abs() < 1e-12);
            turned += u32::from(next.yaw_rad != chair.yaw_rad);
            chair = next;
        }
        // 180 degrees at 60 a second.
        assert!((59..=62).contains(&turned), "{turned} steps");
        assert!((chair.velocity_mps - on).norm() < 1e-6, "{chair:?}");
        // Out of the way of a bus it is pulled back.
        let pulled = Rolling { yaw_rad: 0.0, velocity_mps: Vector2::zeros() }.step(&on, on, true, &|_| true);
        assert!(pulled.yaw_rad == 0.0 && pulled.speed_mps() < 0.0);
    }

    #[test]
    fn chairs_turn_slower_than_people_and_those_who_stand_faster() {
        let turn = |gait: Gait, speed_mps: f64| gait.turned(0.1, 3.0, speed_mps) - 0.1;
        for (gait, speed_mps, degps) in
            [(Gait::Feet, 0.0, 180.0), (Gait::Feet, 1.3, 90.0), (Gait::Wheels, 0.0, 60.0)]
        {
            assert!((turn(gait, speed_mps).to_degrees() / FRAME_PERIOD_S - degps).abs() < 1e-9);
        }
        assert_eq!(Gait::Feet.turned(0.1, 0.11, 1.0), 0.11);
        assert_eq!([0.0, -0.9, 1.5, 2.1, 3.0].map(share_of_speed), [1.0, 1.0, 0.5, 0.0, 0.0]);
    }
}
