//! What street lamps give in each direction.

use simd::{F32x8, smoothstep};

/// Their light is followed so far, metres.
pub(super) const REACH_M: f32 = 40.0;
/// Cosines of the angles from straight down between which they are cut off: 65 to 80 degrees, so that they
/// blind nobody.
const CUT_OFF: [f32; 2] = [0.17, 0.42];
/// The integral of [`intensity`]'s shape over all directions.
const SHAPE_SR: f32 = 2.373_86;
/// Share of the lamp's flux that comes out of an old, dusty luminaire.
const OUTPUT: f32 = 0.55;
/// Candela by lumen where [`intensity`] is 1.
pub(super) const CD_PER_LM: f32 = OUTPUT / SHAPE_SR;

/// The greatest [`intensity`].
pub(super) const MOST: f32 = 0.6125;

/// Intensity by cosines of the angles from straight down, in [`CD_PER_LM`]: more to the sides than below, so
/// that the road between two lamps is lit.
#[inline]
pub(super) fn intensity(down: F32x8) -> F32x8 {
    let [dark, full] = CUT_OFF;
    down.fast_max(F32x8::ZERO) * (1.4 - down * 0.8) * smoothstep(dark, full, down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_light_together_is_the_flux() {
        // Rings of equal height have equal solid angles.
        const RINGS: usize = 20_000;
        let ring = |k: usize| 1.0 - 2.0 * (k as f32 + 0.5) / RINGS as f32;
        let sum: f64 =
            (0..RINGS).map(|k| f64::from(intensity(F32x8::splat(ring(k))).to_array()[0])).sum::<f64>();
        let shape_sr = sum * 4.0 * std::f64::consts::PI / RINGS as f64;
        assert!((shape_sr - f64::from(SHAPE_SR)).abs() < 1e-3, "{shape_sr}");
        let most = (0..=RINGS).map(|k| intensity(F32x8::splat(k as f32 / RINGS as f32)).to_array()[0]);
        assert!((most.fold(0.0, f32::max) - MOST).abs() < 1e-5);
        // Nothing goes up, or nearly level.
        for down in [-1.0f32, -0.3, 0.0, 0.16] {
            assert_eq!(intensity(F32x8::splat(down)).to_array()[0], 0.0, "{down}");
        }
    }
}
