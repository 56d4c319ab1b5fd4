//! Regular patterns, averaged over a pixel so that they fade instead of flickering.

use lanes::Lanes;

/// Share of the interval `[x - w / 2, x + w / 2]` that lies in the bars `[k, k + bar)` of a pattern of period 1.
#[inline]
pub(super) fn bars(x: Lanes, bar: f32, width: Width) -> Lanes {
    // Length of bar from 0 to t.
    let length = |t: Lanes| {
        let whole = t.floor();
        whole * bar + (t - whole).fast_min(Lanes::splat(bar))
    };
    let half = width.w * 0.5;
    ((length(x + half) - length(x - half)) * width.inverse).fast_clamp(Lanes::ZERO, Lanes::ONE)
}

/// The width of a pixel in periods of a pattern.
#[derive(Clone, Copy)]
pub(super) struct Width {
    pub(super) w: Lanes,
    inverse: Lanes,
}

impl Width {
    #[inline]
    pub(super) fn new(w: Lanes) -> Self {
        let w = w.fast_max(Lanes::splat(1e-4));
        Self { w, inverse: 1.0 / w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bars_average_their_pattern(x in -20.0..20.0f32, bar in 0.05..0.95f32, w in 0.02..3.0f32) {
            // Against many samples of the pattern itself.
            let n = 4000;
            let inside = (0..n)
                .filter(|i| {
                    let t = x + w * ((*i as f32 + 0.5) / n as f32 - 0.5);
                    t - t.floor() < bar
                })
                .count();
            prop_assert!((bars(Lanes::splat(x), bar, Width::new(Lanes::splat(w))).to_array()[5] - inside as f32 / n as f32).abs() < 4e-3);
        }
    }
}
