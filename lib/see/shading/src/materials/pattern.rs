//! Regular patterns, averaged over a pixel so that they fade instead of flickering.

use simd::F32x8;

use crate::textures::{Noise, Textures};

/// What patterns are made of.
#[derive(Clone, Copy)]
pub(crate) struct PatternSet {
    pub(super) noise: &'static Noise,
    pub(super) textures: &'static Textures,
}

impl PatternSet {
    pub(crate) fn get() -> Self {
        Self { noise: Noise::get(), textures: Textures::get() }
    }
}

/// Share of the interval `[x - w / 2, x + w / 2]` that lies in the bars `[k, k + bar)` of a pattern of period
/// 1.
#[inline]
pub(super) fn bars(x: F32x8, bar: f32, width: Width) -> F32x8 {
    bars_of(x, F32x8::splat(bar), width)
}

/// `bars` whose bars differ.
#[inline]
pub(super) fn bars_of(x: F32x8, bar: F32x8, width: Width) -> F32x8 {
    // Length of bar from 0 to t.
    let length = |t: F32x8| {
        let whole = t.floor();
        whole * bar + (t - whole).fast_min(bar)
    };
    let half = width.w * 0.5;
    ((length(x + half) - length(x - half)) * width.inverse).fast_clamp(F32x8::ZERO, F32x8::ONE)
}

/// The width of a pixel in periods of a pattern.
#[derive(Clone, Copy)]
pub(super) struct Width {
    pub(super) w: F32x8,
    inverse: F32x8,
}

impl Width {
    #[inline]
    pub(super) fn new(w: F32x8) -> Self {
        let w = w.fast_max(F32x8::splat(1e-4));
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
            prop_assert!((bars(F32x8::splat(x), bar, Width::new(F32x8::splat(w))).to_array()[5] - inside as f32 / n as f32).abs() < 4e-3);
        }
    }
}
