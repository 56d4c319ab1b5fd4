//! Which prediction finds which target.

use std::cmp::Ordering;

/// Surest first.
pub(crate) fn by_score(a: f64, b: f64) -> Ordering {
    b.partial_cmp(&a).unwrap_or(Ordering::Equal)
}

/// Distances of some predictions from some targets of one sample and class: a row of all targets for each
/// prediction.
pub(crate) struct Distances {
    targets: usize,
    values_m: Vec<f64>,
}

impl Distances {
    /// Measures all of them, m.
    pub(crate) fn new<P, T>(predictions: &[P], targets: &[T], measure: impl Fn(&P, &T) -> f64) -> Self {
        let pairs = predictions.iter().flat_map(|p| targets.iter().map(move |t| (p, t)));
        Self { targets: targets.len(), values_m: pairs.map(|(p, t)| measure(p, t)).collect() }
    }

    /// The target of each prediction: these choose in their order the nearest that is free, the first of
    /// several, and take it if it `is_near` enough.
    pub(crate) fn assign(&self, predictions: usize, is_near: impl Fn(f64) -> bool) -> Vec<Option<usize>> {
        let mut taken = vec![false; self.targets];
        let choose = |prediction: usize| {
            let row = &self.values_m[prediction * self.targets..(prediction + 1) * self.targets];
            let mut best: Option<(usize, f64)> = None;
            for (target, &away) in row.iter().enumerate() {
                if !taken[target] && best.is_none_or(|(_, least)| away < least) {
                    best = Some((target, away));
                }
            }
            let found = best.filter(|(_, away)| is_near(*away)).map(|(target, _)| target);
            if let Some(target) = found {
                taken[target] = true;
            }
            found
        };
        (0..predictions).map(choose).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_takes_the_nearest_that_is_free() {
        let (predictions, targets) = ([0.0_f64, 0.2, 5.0, 1.2], [0.1_f64, 1.0]);
        let distances = Distances::new(&predictions, &targets, |p, t| (p - t).abs());
        assert_eq!(distances.assign(4, |d| d < 2.0), [Some(0), Some(1), None, None]);
        // What is too far away stays free.
        assert_eq!(distances.assign(4, |d| d < 0.5), [Some(0), None, None, Some(1)]);
        let none = Distances::new(&predictions, &[0.0; 0], |p: &f64, t: &f64| (p - t).abs());
        assert_eq!(none.assign(4, |_| true), [None; 4]);
    }
}
