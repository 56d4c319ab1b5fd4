//! Longitudinal behaviour: the intelligent driver model and speed envelopes.

/// Strongest acceleration, m/s2.
pub(crate) const MAX_ACCELERATION: f64 = 3.0;
/// Strongest braking, m/s2.
pub(crate) const MAX_BRAKING: f64 = 8.0;
/// Braking that drivers plan with, m/s2.
pub(crate) const COMFORT_BRAKING: f64 = 2.5;
/// Gaps are never taken for smaller than this, metres: it bounds the model's answer.
const MIN_GAP_M: f64 = 0.05;

/// The intelligent driver model (Treiber, Hennecke, Helbing, 2000): acceleration from the own speed, the
/// wished speed, and gap and speed of the vehicle ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Idm {
    /// Acceleration on a free road, m/s2.
    pub acceleration: f64,
    /// Comfortable braking, m/s2.
    pub braking: f64,
    /// Time gap to the vehicle ahead, seconds.
    pub headway_s: f64,
    /// Gap to a standing vehicle, metres.
    pub standstill_gap_m: f64,
}

impl Idm {
    /// Acceleration on a free road towards the wished speed, m/s2. Above it, braking is at most comfortable.
    #[must_use]
    pub fn free(&self, speed_mps: f64, wished_mps: f64) -> f64 {
        let ratio = speed_mps / wished_mps.max(0.1);
        let fourth = ratio * ratio * ratio * ratio;
        (self.acceleration * (1.0 - fourth)).max(-self.braking)
    }

    /// Acceleration behind something that moves at `ahead_mps`, m/s2, at least `-8`.
    #[must_use]
    pub fn following(&self, speed_mps: f64, wished_mps: f64, gap_m: f64, ahead_mps: f64) -> f64 {
        let approach =
            speed_mps * (speed_mps - ahead_mps) / (2.0 * (self.acceleration * self.braking).sqrt());
        let wished_gap = self.standstill_gap_m + (speed_mps * self.headway_s + approach).max(0.0);
        let share = wished_gap / gap_m.max(MIN_GAP_M);
        (self.free(speed_mps, wished_mps) - self.acceleration * share * share).max(-MAX_BRAKING)
    }
}

/// The gap at which a driver neither accelerates nor brakes behind a vehicle of the same speed, metres:
/// `(s0 + v T) / sqrt(1 - (v / v0)^4)`.
#[must_use]
pub fn equilibrium_gap_m(idm: &Idm, speed_mps: f64, wished_mps: f64) -> f64 {
    let ratio = speed_mps / wished_mps;
    (idm.standstill_gap_m + speed_mps * idm.headway_s) / (1.0 - ratio * ratio * ratio * ratio).sqrt()
}

/// Highest speed from which `target_mps` is reached within `distance_m` at a braking, m/s.
pub(crate) fn envelope(target_mps: f64, distance_m: f64, braking: f64) -> f64 {
    (target_mps * target_mps + 2.0 * braking * distance_m.max(0.0)).sqrt()
}

/// Braking that brings a vehicle to rest within a distance, m/s2.
pub(crate) fn braking_to_stop(speed_mps: f64, distance_m: f64) -> f64 {
    speed_mps * speed_mps / (2.0 * distance_m.max(0.01))
}

/// The time for a way with an even acceleration up to a top speed, seconds.
pub(crate) fn time_s(way_m: f64, speed_mps: f64, acceleration: f64, top_mps: f64) -> f64 {
    let way_m = way_m.max(0.0);
    let gaining_m = (top_mps * top_mps - speed_mps * speed_mps).max(0.0) / (2.0 * acceleration);
    if way_m <= gaining_m {
        ((speed_mps * speed_mps + 2.0 * acceleration * way_m).sqrt() - speed_mps) / acceleration
    } else {
        let top = top_mps.max(speed_mps);
        (top - speed_mps) / acceleration + (way_m - gaining_m) / top
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn idm() -> Idm {
        Idm { acceleration: 2.0, braking: 2.5, headway_s: 1.2, standstill_gap_m: 4.2 }
    }

    #[test]
    fn a_platoon_settles_at_the_equilibrium_gap() {
        let (mut x, mut v) = ([0.0, -60.0], [8.0, 12.0]);
        for _ in 0..6000 {
            let a = idm().following(v[1], 13.0, x[0] - x[1], v[0]);
            v[1] += 0.05 * a;
            x[0] += 0.05 * v[0];
            x[1] += 0.05 * v[1];
        }
        let expected = equilibrium_gap_m(&idm(), 8.0, 13.0);
        assert!((x[0] - x[1] - expected).abs() < 1e-6, "{} {expected}", x[0] - x[1]);
    }

    proptest! {
        #[test]
        fn equilibrium_means_no_acceleration(wished in 2.0..40.0f64, share in 0.0..0.95f64, gap in 0.0..8.0f64, headway in 0.5..2.5f64) {
            let idm = Idm { standstill_gap_m: gap + 0.1, headway_s: headway, ..idm() };
            let speed = share * wished;
            let gap = equilibrium_gap_m(&idm, speed, wished);
            prop_assert!(idm.following(speed, wished, gap, speed).abs() < 1e-9);
            prop_assert!(idm.following(speed, wished, 0.9 * gap, speed) < 0.0);
            prop_assert!(idm.following(speed, wished, 1.1 * gap, speed) > 0.0);
        }

        #[test]
        fn a_driver_stops_before_a_wall(speed in 0.0..25.0f64, standstill in 0.5..6.0f64) {
            let idm = Idm { standstill_gap_m: standstill, ..idm() };
            let (mut v, mut gap) = (speed, speed * speed / (2.0 * 3.0) + 4.0 + standstill);
            for _ in 0..4000 {
                let next: f64 = (v + 0.05 * idm.following(v, 14.0, gap, 0.0)).max(0.0);
                gap -= 0.05 * 0.5 * (v + next);
                v = next;
            }
            prop_assert!(gap > 0.0 && v < 0.2, "{gap} {v}");
        }

        #[test]
        fn times_are_those_of_small_steps(way in 0.0..80.0f64, speed in 0.0..20.0f64, more in 0.0..10.0f64, a in 0.4..3.0f64) {
            let top = speed.max(1.0) + more;
            let (mut v, mut gone, mut steps) = (speed, 0.0, 0u32);
            while gone < way && steps < 1_000_000 {
                let next: f64 = (v + 0.001 * a).min(top);
                gone += 0.0005 * (v + next);
                v = next;
                steps += 1;
            }
            let expected = 0.001 * f64::from(steps);
            prop_assert!((time_s(way, speed, a, top) - expected).abs() < 0.01, "{} {expected}", time_s(way, speed, a, top));
        }
    }
}
