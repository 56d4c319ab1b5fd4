//! Small functions of inner loops.

use crate::{F32x8, U32x8};

/// `exp(-x)` for `x >= 0`, to a relative error of about 2e-3 (next to nothing beyond 87).
#[inline]
#[must_use]
pub fn exp_neg(x: F32x8) -> F32x8 {
    let t = (x * -std::f32::consts::LOG2_E).fast_max(F32x8::splat(-126.0));
    let floor = t.floor();
    // 2^f on [0, 1): the exponential series to degree 5.
    let f = (t - floor) * std::f32::consts::LN_2;
    let series = f * (1.0 / 120.0) + 1.0 / 24.0;
    let series = f * series + 1.0 / 6.0;
    let series = f * series + 0.5;
    let series = f * (f * series + 1.0) + 1.0;
    series * F32x8::from_bits(floor_words(floor + 127.0) << 23)
}

/// From `a` to `b` by shares.
#[inline]
#[must_use]
pub fn lerp(a: F32x8, b: F32x8, share: F32x8) -> F32x8 {
    a + (b - a) * share
}

/// 0 below `low`, 1 above `high`, smooth between.
#[inline]
#[must_use]
pub fn smoothstep(low: f32, high: f32, x: F32x8) -> F32x8 {
    let t = ((x - low) * (1.0 / (high - low))).fast_clamp(F32x8::ZERO, F32x8::ONE);
    t * t * (3.0 - 2.0 * t)
}

/// The floors of numbers within 2^31 of 0, as words; those below 0 wrapped round.
#[inline]
#[must_use]
pub fn floor_words(x: F32x8) -> U32x8 {
    x.floor().fast_trunc_int().cast_unsigned()
}

/// Words below 2^31 as numbers.
#[inline]
#[must_use]
pub fn number_of(words: U32x8) -> F32x8 {
    F32x8::from_i32x8(words.cast_signed())
}

/// Mixes two lattice coordinates and a seed to 32 even bits (the finaliser of MurmurHash3).
#[inline]
#[must_use]
pub fn hash2(x: U32x8, y: U32x8, seed: U32x8) -> U32x8 {
    let h = (x * 0x9e37_79b1u32) ^ (y * 0x85eb_ca77u32) ^ seed;
    let h = (h ^ (h >> 16)) * 0x85eb_ca6bu32;
    let h = (h ^ (h >> 13)) * 0xc2b2_ae35u32;
    h ^ (h >> 16)
}

/// Words as numbers in `[0, 1)`.
#[inline]
#[must_use]
pub fn unit(words: U32x8) -> F32x8 {
    number_of(words >> 8) * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::STEPS;

    #[test]
    fn the_exponential_is_one() {
        for i in 0..1000 {
            let x: [f32; 8] = std::array::from_fn(|k| (8 * i + k) as f32 * 0.01);
            for (x, got) in x.into_iter().zip(exp_neg(x.into()).to_array()) {
                let want = libm::exp(-f64::from(x));
                assert!((f64::from(got) - want).abs() <= 2e-3 * want, "{x}: {got} {want}");
            }
        }
        assert!(exp_neg(F32x8::splat(1e9)).to_array()[3] < 1e-30);
    }

    #[test]
    fn floors_wrap_below_zero() {
        let x = F32x8::new([-1.5, -1.0, -0.25, 0.0, 0.75, 1.0, 2.5, -7.0]);
        let want = [-2i32, -1, -1, 0, 0, 1, 2, -7].map(|w| w as u32);
        assert_eq!(floor_words(x).to_array(), want);
    }

    #[test]
    fn lanes_do_what_one_would() {
        // The same mix as in 32-bit words, one by one.
        let one = |x: i32, y: i32, seed: u32| {
            let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
            h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
            h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
            h ^ (h >> 16)
        };
        let (x, y) = ([-3i32, 5, 0, 1 << 30, -1, 77, 8, 9], [7i32, -5, 0, 3, -2_000_000, 1, 2, 3]);
        let got = hash2(x.map(|v| v as u32).into(), y.map(|v| v as u32).into(), U32x8::splat(9));
        let want: [u32; 8] = std::array::from_fn(|i| one(x[i], y[i], 9));
        assert_eq!(got.to_array(), want);
        for (word, number) in want.into_iter().zip(unit(got).to_array()) {
            assert_eq!(number, (word >> 8) as f32 / 16_777_216.0);
        }
        let s = smoothstep(1.0, 3.0, STEPS).to_array();
        assert_eq!([s[0], s[1], s[2], s[3], s[7]], [0.0, 0.0, 0.5, 1.0, 1.0]);
    }
}
