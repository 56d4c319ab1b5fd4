//! How bodies lean on their springs: nose down when braking, outwards in curves; two-wheelers into them.

use frames::math::atan;

/// Acceleration due to gravity, m/s2.
const GRAVITY: f64 = 9.81;
/// Pitch and roll of a body on springs, radians per m/s2: half a degree of pitch in comfortable braking, 0.9 degrees of roll
/// in a brisk curve. Softer cars lean more, but here the wheels lean with the body.
const PITCH_PER_MPS2: f64 = 0.0035;
const ROLL_PER_MPS2: f64 = 0.005;
/// Largest of both, radians.
const MOST_RAD: f64 = 0.03;
/// Largest lean of two-wheelers, radians.
const MOST_LEAN_RAD: f64 = 0.6;
/// Natural frequency of bodies (1.3 Hz), radians per second, and their share of critical damping; of leaning riders.
const SPRING: [f64; 2] = [8.2, 0.7];
const RIDER: [f64; 2] = [6.0, 1.0];

/// Pitch and roll of a vehicle's body against the road, and their rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sway {
    /// Positive nose down, radians.
    pub(crate) pitch_rad: f64,
    /// Positive right side down, radians.
    pub(crate) roll_rad: f64,
    rates: [f64; 2],
}

impl Sway {
    /// One step of `dt` seconds under an acceleration along the heading and one to the left, m/s2: oscillators towards the
    /// lean at rest, stepped implicitly (stable for any step).
    pub(crate) fn step(&mut self, ahead: f64, left: f64, two_wheeled: bool, dt: f64) {
        let (pitch, roll, [frequency, damping]) = if two_wheeled {
            // Gravity and the push outwards balance along the rider.
            (0.0, -atan(left / GRAVITY).clamp(-MOST_LEAN_RAD, MOST_LEAN_RAD), RIDER)
        } else {
            let bounded = |angle: f64| angle.clamp(-MOST_RAD, MOST_RAD);
            (bounded(-PITCH_PER_MPS2 * ahead), bounded(ROLL_PER_MPS2 * left), SPRING)
        };
        let mut step = |angle: &mut f64, axis: usize, rest: f64| {
            let rate = &mut self.rates[axis];
            let stiff = frequency * frequency * dt;
            *rate = (*rate + stiff * (rest - *angle)) / (1.0 + 2.0 * damping * frequency * dt + stiff * dt);
            *angle += dt * *rate;
        };
        step(&mut self.pitch_rad, 0, pitch);
        step(&mut self.roll_rad, 1, roll);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a long time under constant accelerations.
    fn settled(ahead: f64, left: f64, two_wheeled: bool) -> Sway {
        let mut sway = Sway::default();
        (0..400).for_each(|_| sway.step(ahead, left, two_wheeled, 0.05));
        sway
    }

    #[test]
    fn bodies_settle_at_the_lean_of_their_springs() {
        let braking = settled(-3.0, 0.0, false);
        assert!((braking.pitch_rad - 0.0105).abs() < 1e-9 && braking.roll_rad == 0.0);
        // In a curve to the left the right side goes down.
        assert!((settled(0.0, 2.0, false).roll_rad - 0.01).abs() < 1e-9);
        assert!((settled(-50.0, -50.0, false).pitch_rad - MOST_RAD).abs() < 1e-9);
    }

    #[test]
    fn riders_lean_into_curves_as_gravity_asks() {
        // v^2 / r = g tan(lean): 10 m/s on 40 m.
        let lean = settled(0.0, 100.0 / 40.0, true);
        assert!((frames::math::tan(-lean.roll_rad) - 2.5 / 9.81).abs() < 1e-9 && lean.pitch_rad == 0.0);
    }

    #[test]
    fn a_body_swings_once_and_comes_to_rest() {
        let mut sway = settled(-3.0, 0.0, false);
        let swing: Vec<f64> = (0..60)
            .map(|_| {
                sway.step(0.0, 0.0, false, 0.05);
                sway.pitch_rad
            })
            .collect();
        assert!(swing.iter().all(|p| p.abs() < 0.0105) && swing[59].abs() < 1e-5);
    }
}
