//! The distributions that planning, traffic and sensors draw from, on libm alone (the same bits everywhere).

use crate::Stream;

impl Stream {
    /// Uniform in `[0, 1)`, 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform integer in `low..=high` (`low` when the range is empty), without modulo bias to 2^-64.
    pub fn int_inclusive(&mut self, low: i64, high: i64) -> i64 {
        if high <= low {
            return low;
        }
        let span = (i128::from(high) - i128::from(low) + 1) as u128;
        let scaled = (u128::from(self.next_u64()) * span) >> 64;
        (i128::from(low) + scaled as i128) as i64
    }

    /// Uniform index in `0..len`, or `None` when `len` is 0.
    pub fn index(&mut self, len: usize) -> Option<usize> {
        (len > 0).then(|| self.int_inclusive(0, len as i64 - 1) as usize)
    }

    /// A uniformly drawn element.
    pub fn choose<'a, T>(&mut self, items: &'a [T]) -> Option<&'a T> {
        self.index(items.len()).map(|i| &items[i])
    }

    /// An element drawn with a probability in proportion to its weight; `None` when no weight is above 0.
    pub fn choose_weighted<'a, T>(&mut self, items: &'a [T], weight: impl Fn(&T) -> f64) -> Option<&'a T> {
        let weights = items.iter().map(|item| weight(item).max(0.0));
        let mut rest = self.unit() * weights.clone().sum::<f64>();
        // Rounding may leave a little beyond the last one.
        let mut last = None;
        for (item, weight) in items.iter().zip(weights).filter(|(_, weight)| *weight > 0.0) {
            last = Some(item);
            if rest < weight {
                break;
            }
            rest -= weight;
        }
        last
    }

    /// One of some items with their weights, all alike where all weights are 1: as [`Stream::choose`] draws
    /// then, to the bit.
    pub fn choose_common<T: Copy>(&mut self, items: &[(T, f64)]) -> Option<T> {
        #[allow(clippy::float_cmp, reason = "what nobody changed")]
        let all_alike = items.iter().all(|(_, weight)| *weight == 1.0);
        let drawn =
            if all_alike { self.choose(items) } else { self.choose_weighted(items, |(_, weight)| *weight) };
        drawn.map(|(item, _)| *item)
    }

    /// `true` with a probability of 0 to 1.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// `count` distinct indices of `0..len` in draw order (all of them when `count >= len`).
    pub fn sample_indices(&mut self, len: usize, count: usize) -> Vec<usize> {
        let mut indices: Vec<usize> = (0..len).collect();
        let count = count.min(len);
        for i in 0..count {
            let j = self.int_inclusive(i as i64, len as i64 - 1) as usize;
            indices.swap(i, j);
        }
        indices.truncate(count);
        indices
    }

    /// Normal (Box and Muller, 1958).
    pub fn normal(&mut self, mean: f64, std_dev: f64) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return mean + std_dev * spare;
        }
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.unit()));
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * self.unit());
        self.spare_normal = Some(radius * sin);
        mean + std_dev * radius * cos
    }

    /// Log-normal: `exp(normal(mean, std_dev))`.
    pub fn log_normal(&mut self, mean: f64, std_dev: f64) -> f64 {
        libm::exp(self.normal(mean, std_dev))
    }

    /// Gamma with scale 1 (Marsaglia and Tsang, 2000; shapes below 1 by their boost).
    pub fn gamma(&mut self, shape: f64) -> f64 {
        if shape < 1.0 {
            let boost = libm::pow(1.0 - self.unit(), 1.0 / shape);
            return self.gamma(shape + 1.0) * boost;
        }
        let d = shape - 1.0 / 3.0;
        let c = 1.0 / libm::sqrt(9.0 * d);
        loop {
            let x = self.normal(0.0, 1.0);
            let v = 1.0 + c * x;
            if v <= 0.0 {
                continue;
            }
            let v = v * v * v;
            let u = 1.0 - self.unit();
            if libm::log(u) < 0.5 * x * x + d - d * v + d * libm::log(v) {
                return d * v;
            }
        }
    }

    /// Beta on `[0, 1]`, as a ratio of gammas.
    pub fn beta(&mut self, a: f64, b: f64) -> f64 {
        let x = self.gamma(a);
        let y = self.gamma(b);
        // Both underflow only for tiny shapes; the middle is as good as any answer then.
        if x + y > 0.0 { x / (x + y) } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(mut draw: impl FnMut() -> f64) -> (f64, f64) {
        let n = 40_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let x = draw();
            sum += x;
            squares += x * x;
        }
        let mean = sum / f64::from(n);
        (mean, squares / f64::from(n) - mean * mean)
    }

    #[test]
    fn moments_match_theory() {
        let mut s = Stream::new(27, 0, "test/moments", 0);
        let close = |got: (f64, f64), mean: f64, var: f64| {
            assert!((got.0 - mean).abs() < 0.02 * (1.0 + mean), "mean {} not {mean}", got.0);
            assert!((got.1 - var).abs() < 0.05 * (1.0 + var), "variance {} not {var}", got.1);
        };
        close(moments(|| s.uniform(2.0, 4.0)), 3.0, 4.0 / 12.0);
        close(moments(|| s.normal(4.2, 1.0)), 4.2, 1.0);
        close(moments(|| s.gamma(2.5)), 2.5, 2.5);
        close(moments(|| s.gamma(0.6)), 0.6, 0.6);
        // Beta(a, b): mean a / (a + b), variance ab / ((a + b)^2 (a + b + 1)).
        close(moments(|| s.beta(3.2, 2.2)), 3.2 / 5.4, 3.2 * 2.2 / (5.4 * 5.4 * 6.4));
        close(moments(|| s.beta(0.8, 0.2)), 0.8, 0.16 / 2.0);
    }

    #[test]
    fn weights_are_shares() {
        let mut s = Stream::new(27, 0, "test/weights", 0);
        let items = [(0, 0.0), (1, 3.0), (2, 1.0), (3, -2.0)];
        let mut counts = [0u32; 4];
        for _ in 0..40_000 {
            counts[s.choose_weighted(&items, |item| item.1).expect("an item").0] += 1;
        }
        // A standard deviation is 87.
        assert!(counts[0] == 0 && counts[3] == 0 && (29_600..30_400).contains(&counts[1]), "{counts:?}");
        assert_eq!(s.choose_weighted(&items[..1], |item| item.1), None);
        let [mut a, mut b] = [0; 2].map(|_| Stream::new(28, 0, "test/common", 0));
        let (plain, alike) = ([1, 2, 3, 4, 5], [1, 2, 3, 4, 5].map(|item| (item, 1.0)));
        for _ in 0..1000 {
            assert_eq!(a.choose(&plain).copied(), b.choose_common(&alike));
        }
        assert_eq!(b.choose_common(&[(1, 0.0), (2, 0.5)]), Some(2));
    }

    #[test]
    fn integers_cover_their_range_evenly() {
        let mut s = Stream::new(27, 0, "test/int", 0);
        let mut counts = [0u32; 7];
        for _ in 0..70_000 {
            counts[(s.int_inclusive(-3, 3) + 3) as usize] += 1;
        }
        assert!(counts.iter().all(|&c| (9_500..10_500).contains(&c)), "{counts:?}");
        assert_eq!(s.int_inclusive(5, 4), 5);
    }

    #[test]
    fn samples_are_distinct() {
        let mut s = Stream::new(27, 0, "test/sample", 0);
        let mut picked = s.sample_indices(50, 20);
        picked.sort_unstable();
        picked.dedup();
        assert_eq!(picked.len(), 20);
        assert_eq!(s.sample_indices(3, 9).len(), 3);
    }
}
