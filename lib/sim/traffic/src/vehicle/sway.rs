//! How bodies lean on their springs: nose down when braking, outwards in curves; two-wheelers into them.

use frames::math::atan;

/// Acceleration due to gravity, m/s2.
const GRAVITY: f64 = 9.81;
/// Pitch and roll of a body on springs, radians per m/s2: half a degree of pitch in comfortable braking, 0.9
/// degrees of roll in a brisk curve.
const PITCH_PER_MPS2: f64 = 0.0035;
const ROLL_PER_MPS2: f64 = 0.005;
/// Largest of both, radians: wheels have two centimetres of room inward.
const MOST_RAD: [f64; 2] = [0.03, 0.025];
/// Largest lean of two-wheelers, radians.
const MOST_LEAN_RAD: f64 = 0.45;
/// Natural frequency of bodies (1.3 Hz), radians per second, and their share of critical damping; of leaning
/// riders.
const SPRING: [f64; 2] = [8.2, 0.7];
const RIDER: [f64; 2] = [6.0, 1.0];

/// What a body leans on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Springs {
    /// Four wheels or more.
    Wheels {
        /// How far the outermost wheels are from the middle, along and across, metres.
        at_m: [f64; 2],
        /// How far the body comes nearer to a wheel, or gets farther from it, at most, metres.
        travel_m: f64,
    },
    /// None: somebody on two wheels.
    Rider,
}

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
    /// One step of `dt` seconds under an acceleration along the heading and one to the left, m/s2:
    /// oscillators towards the lean at rest, stepped implicitly (stable for any step).
    pub(crate) fn step(&mut self, ahead: f64, left: f64, springs: &Springs, dt: f64) {
        let (pitch, roll, [frequency, damping]) = if *springs == Springs::Rider {
            // Gravity and the push outwards balance along the rider.
            (0.0, -atan(left / GRAVITY).clamp(-MOST_LEAN_RAD, MOST_LEAN_RAD), RIDER)
        } else {
            let [pitch, roll] = [-PITCH_PER_MPS2 * ahead, ROLL_PER_MPS2 * left];
            let [most_pitch, most_roll] = MOST_RAD;
            (pitch.clamp(-most_pitch, most_pitch), roll.clamp(-most_roll, most_roll), SPRING)
        };
        let mut step = |angle: &mut f64, axis: usize, rest: f64| {
            let rate = &mut self.rates[axis];
            let stiff = frequency * frequency * dt;
            *rate = (*rate + stiff * (rest - *angle)) / (1.0 + 2.0 * damping * frequency * dt + stiff * dt);
            *angle += dt * *rate;
        };
        step(&mut self.pitch_rad, 0, pitch);
        step(&mut self.roll_rad, 1, roll);
        if let Springs::Wheels { at_m, travel_m } = springs {
            // No wheel leaves its arch.
            let most_m = at_m[0] * self.pitch_rad.abs() + at_m[1] * self.roll_rad.abs();
            let share = if most_m > *travel_m { travel_m / most_m } else { 1.0 };
            (self.pitch_rad, self.roll_rad) = (share * self.pitch_rad, share * self.roll_rad);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR: Springs = Springs::Wheels { at_m: [1.35, 0.9], travel_m: 0.1 };

    /// After a long time under constant accelerations.
    fn settled(ahead: f64, left: f64, springs: &Springs) -> Sway {
        let mut sway = Sway::default();
        (0..400).for_each(|_| sway.step(ahead, left, springs, 0.05));
        sway
    }

    #[test]
    fn bodies_settle_at_the_lean_of_their_springs() {
        let braking = settled(-3.0, 0.0, &CAR);
        assert!((braking.pitch_rad - 0.0105).abs() < 1e-9 && braking.roll_rad == 0.0);
        // In a curve to the left the right side goes down.
        assert!((settled(0.0, 2.0, &CAR).roll_rad - 0.01).abs() < 1e-9);
        assert!((settled(-50.0, -50.0, &CAR).pitch_rad - MOST_RAD[0]).abs() < 1e-9);
    }

    #[test]
    fn riders_lean_into_curves_as_gravity_asks() {
        // v^2 / r = g tan(lean): 10 m/s on 40 m.
        let lean = settled(0.0, 100.0 / 40.0, &Springs::Rider);
        assert!((frames::math::tan(-lean.roll_rad) - 2.5 / 9.81).abs() < 1e-9 && lean.pitch_rad == 0.0);
    }

    #[test]
    fn a_body_swings_once_and_comes_to_rest() {
        let mut sway = settled(-3.0, 0.0, &CAR);
        let swing: Vec<f64> = (0..60)
            .map(|_| {
                sway.step(0.0, 0.0, &CAR, 0.05);
                sway.pitch_rad
            })
            .collect();
        assert!(swing.iter().all(|p| p.abs() < 0.0105) && swing[59].abs() < 1e-5);
    }

    #[test]
    fn no_wheel_goes_farther_than_its_springs_let_it() {
        let stiff = Springs::Wheels { at_m: [3.0, 1.25], travel_m: 0.05 };
        let mut sway = Sway::default();
        let mut most_m = 0.0_f64;
        for step in 0..400 {
            // Full braking in a curve, then the other way round at once.
            let sign = if step < 200 { 1.0 } else { -1.0 };
            sway.step(-8.0 * sign, 6.0 * sign, &stiff, 0.05);
            let corners = [[3.0, 1.25], [3.0, -1.25], [-3.0, 1.25], [-3.0, -1.25]];
            let moved = corners.map(|[x, y]| (-x * sway.pitch_rad + y * sway.roll_rad).abs());
            most_m = moved.into_iter().fold(most_m, f64::max);
        }
        assert!((0.0499..=0.05 + 1e-12).contains(&most_m), "{most_m}");
        // Gentle driving is not touched by it: 2 m/s2 and half of that aside.
        let gentle = settled(-2.0, 1.0, &CAR);
        assert!((gentle.pitch_rad - 0.007).abs() < 1e-9 && (gentle.roll_rad - 0.005).abs() < 1e-9);
    }
}
