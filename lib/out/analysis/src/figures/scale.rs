//! From values to positions on an axis.

use frames::math;

/// A round step among 1, 2 and 5 times a power of ten, so that `max` is at most `steps` of them.
fn round_step(max: f64, steps: f64) -> f64 {
    let rough = (max / steps).max(f64::MIN_POSITIVE);
    let power = math::pow(10.0, math::log10(rough).floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// An axis from its first to its last tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    log: bool,
    pub(super) ticks: Vec<f64>,
}

impl Scale {
    /// From 0 to the first round number that is not below `max`.
    pub(super) fn linear(max: f64) -> Self {
        // Counts have no ticks between whole numbers.
        let step = round_step(max, 5.0).max(1.0);
        let n = (max / step).ceil().max(1.0) as u32;
        Self { log: false, ticks: (0..=n).map(|i| f64::from(i) * step).collect() }
    }

    /// From 0 to 1: shares.
    pub(super) fn unit() -> Self {
        Self { log: false, ticks: (0..=5).map(|i| f64::from(i) / 5.0).collect() }
    }

    /// Decades that hold `min` (above their start where it can be, so that its bar is seen) and `max`. Both
    /// are at least 1.
    pub(super) fn log(min: f64, max: f64) -> Self {
        let first = (math::log10(min.max(1.0)).ceil() - 1.0).max(0.0);
        let last = math::log10(max.max(1.0)).ceil().max(first + 1.0);
        let decades = (last - first) as u32;
        Self {
            log: true,
            ticks: (0..=decades).map(|i| math::pow(10.0, first + f64::from(i)).round()).collect(),
        }
    }

    /// Position in 0..=1. On a logarithmic axis everything below the first tick is at 0.
    pub(super) fn position(&self, value: f64) -> f64 {
        let (first, last) =
            (self.ticks.first().copied().unwrap_or(0.0), self.ticks.last().copied().unwrap_or(1.0));
        let share = if self.log {
            math::log10(value.max(first) / first) / math::log10(last / first)
        } else {
            (value - first) / (last - first)
        };
        share.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_reach_the_largest_value() {
        assert_eq!(Scale::linear(46.0).ticks, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
        assert_eq!(Scale::linear(50.0).ticks.last(), Some(&50.0));
        assert_eq!(Scale::linear(3.0).ticks, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(Scale::linear(0.0).ticks, [0.0, 1.0]);
        assert_eq!(Scale::log(37.0, 4100.0).ticks, [10.0, 100.0, 1000.0, 10_000.0]);
        assert_eq!(Scale::log(1.0, 1.0).ticks, [1.0, 10.0]);
        assert_eq!(Scale::log(100.0, 150.0).ticks, [10.0, 100.0, 1000.0]);
    }

    #[test]
    fn positions_are_shares_of_the_axis() {
        assert_eq!(Scale::linear(50.0).position(25.0), 0.5);
        let log = Scale::log(11.0, 1000.0);
        assert!((log.position(100.0) - 0.5).abs() < 1e-12);
        assert_eq!((log.position(0.0), log.position(1000.0)), (0.0, 1.0));
    }
}
