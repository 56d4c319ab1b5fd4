//! How far numbers may be from what other scenes would have given: a bootstrap over scenes.
//!
//! Frames of a scene are alike, so that scenes are drawn, not frames: as many as there are, with replacement
//! (Efron 1979). All modes are scored on the same drawn scenes, so that their difference is a paired one.

use std::collections::BTreeMap;

use random::Stream;
use rayon::prelude::*;

use crate::measures::Measure;
use crate::mode::Mode;

/// The share of drawn scores that lie below an interval, and above it.
const TAIL: f64 = 0.025;

/// A score with what drawn scenes say of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Within this 95 % of the scores of drawn scenes lie; NaN where there are none.
    pub interval: [f64; 2],
    /// How much more it is than the same score without cooperation, and the interval of that; none where
    /// there is no other.
    pub gain: Option<[f64; 3]>,
}

/// The spread of each of the measures `whole` of `parts`, one part a scene, by so many rounds.
pub(crate) fn spreads<P: Sync>(
    parts: &[&P],
    whole: &[Measure],
    rounds: u32,
    measures: impl Fn(&[&P]) -> Vec<Measure> + Sync,
) -> Vec<Spread> {
    let drawn: Vec<Vec<f64>> = (0..rounds)
        .into_par_iter()
        .map(|round| {
            let mut stream = Stream::new(0, u64::from(round), "evaluation/bootstrap", 0);
            let some: Vec<&P> = parts.iter().filter_map(|_| stream.choose(parts).copied()).collect();
            measures(&some).into_iter().map(|measure| measure.value).collect()
        })
        .collect();
    let alone: BTreeMap<_, usize> = whole
        .iter()
        .enumerate()
        .filter(|(_, measure)| measure.mode == Mode::None)
        .map(|(i, measure)| (key(measure), i))
        .collect();
    let spread = |(i, measure): (usize, &Measure)| {
        let other = alone.get(&key(measure)).filter(|other| **other != i);
        let gain = other.map(|&other| {
            let [low, high] = interval(drawn.iter().map(|values| values[i] - values[other]));
            [measure.value - whole[other].value, low, high]
        });
        Spread { interval: interval(drawn.iter().map(|values| values[i])), gain }
    };
    whole.iter().enumerate().map(spread).collect()
}

/// What a measure is of, whatever the mode.
fn key(of: &Measure) -> (&'static str, &'static str, &'static str, &'static str, Option<u64>) {
    (of.metrics, of.class, of.level, of.name, of.threshold.map(f64::to_bits))
}

/// Between which values all but the tails lie; values that are no numbers are left out.
fn interval(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    values.sort_unstable_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return [f64::NAN; 2] };
    [TAIL, 1.0 - TAIL].map(|share| {
        let place = share * last as f64;
        let (below, part) = (place.floor() as usize, place.fract());
        let above = values[(below + 1).min(last)];
        values[below] + part * (above - values[below])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measure(mode: Mode, value: f64) -> Measure {
        let name = "mAP";
        Measure { metrics: "simbev2x", mode, class: "all", level: "all", name, threshold: None, value }
    }

    #[test]
    fn intervals_are_those_of_a_mean_and_gains_are_paired() {
        // Two modes whose scores differ by 1 in every scene, though scenes differ by up to 100.
        let scenes: Vec<f64> = (0..100).map(f64::from).collect();
        let mean = |some: &[&f64]| some.iter().copied().sum::<f64>() / some.len() as f64;
        let parts: Vec<&f64> = scenes.iter().collect();
        let measures =
            |some: &[&f64]| vec![measure(Mode::None, mean(some)), measure(Mode::X2x, mean(some) + 1.0)];
        let spreads = spreads(&parts, &measures(&parts), 2000, measures);
        // The mean of 100 draws of 0 to 99 is 49.5, its deviation 28.87 / 10.
        let [low, high] = spreads[0].interval;
        assert!((low - (49.5 - 1.96 * 2.887)).abs() < 0.4 && (high - (49.5 + 1.96 * 2.887)).abs() < 0.4);
        assert_eq!(spreads[0].gain, None);
        let [gain, low, high] = spreads[1].gain.expect("is beside another");
        assert!([gain, low, high].iter().all(|gain| (gain - 1.0).abs() < 1e-9));
    }

    #[test]
    fn intervals_lie_between_values() {
        assert_eq!(interval((0..=40).map(f64::from)), [1.0, 39.0]);
        assert_eq!(interval([f64::NAN, 3.0].into_iter()), [3.0, 3.0]);
        assert!(interval(std::iter::empty()).iter().all(|value| value.is_nan()));
    }
}
