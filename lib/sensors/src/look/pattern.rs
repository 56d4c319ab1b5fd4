//! Regular patterns, averaged over a pixel so that they fade instead of flickering.

/// Share of the interval `[x - w / 2, x + w / 2]` that lies in the bars `[k, k + bar)` of a pattern of period 1.
#[inline]
pub(super) fn bars(x: f32, bar: f32, w: f32) -> f32 {
    let w = w.max(1e-4);
    // Length of bar from 0 to t.
    let length = |t: f32| {
        let whole = t.floor();
        whole * bar + (t - whole).min(bar)
    };
    ((length(x + 0.5 * w) - length(x - 0.5 * w)) / w).clamp(0.0, 1.0)
}

/// 0 below `low`, 1 above `high`, smooth between.
#[inline]
pub(crate) fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
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
            prop_assert!((bars(x, bar, w) - inside as f32 / n as f32).abs() < 4e-3);
        }
    }
}
