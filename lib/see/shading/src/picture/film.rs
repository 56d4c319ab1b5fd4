//! From light to 8-bit sRGB.

use simd::{F32x8, LANES, U32x8, Vec3x8};

/// Range of the table: powers of two, with 256 steps to each doubling.
const LEAST: f32 = 1.0 / 8192.0;
const MOST: f32 = 32.0;
const SHIFT: u32 = 23 - 8;

/// A film: 8-bit sRGB of film values, by the leading bits of the number.
#[derive(Clone, Debug)]
pub(super) struct Film(Vec<u8>);

/// The code of a film value, 0 to 1.
fn coded(v: f32) -> f32 {
    let linear = (v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14)).min(1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * frames::math::f32::pow(linear, 1.0 / 2.4) - 0.055
    }
}

impl Film {
    /// A filmic curve (Narkowicz, "ACES filmic tone mapping curve", 2015) and the sRGB code.
    pub(super) fn new() -> Self {
        let entries = (MOST.to_bits() - LEAST.to_bits()) >> SHIFT;
        let code = |i: u32| {
            let half = 1 << (SHIFT - 1);
            let v = if i == 0 { 0.0 } else { f32::from_bits(LEAST.to_bits() + (i << SHIFT) + half) };
            (coded(v) * 255.0 + 0.5) as u8
        };
        Self((0..entries).map(code).collect())
    }

    /// The film value of each code: the middle of those that come out so.
    pub(super) fn values(&self) -> Vec<f32> {
        let at = |i: usize| f32::from_bits(LEAST.to_bits() + ((i as u32) << SHIFT));
        let value = |code: u8| {
            let first = self.0.partition_point(|c| *c < code);
            let next = self.0.partition_point(|c| *c <= code);
            // White has no upper end.
            if code == u8::MAX { at(first) } else { 0.5 * (at(first) + at(next)) }
        };
        (0..=u8::MAX).map(value).collect()
    }

    /// The code of one film value.
    #[inline]
    pub(super) fn code(&self, value: f32) -> u8 {
        let bits = value.max(LEAST).to_bits().min(MOST.to_bits() - 1);
        self.0.get(((bits - LEAST.to_bits()) >> SHIFT) as usize).copied().unwrap_or(255)
    }

    /// The film value of each code, and how many codes lie in a film value there.
    pub(super) fn slopes() -> Vec<(f64, f64)> {
        let film = |code: f64| {
            let (mut low, mut high) = (0.0_f64, f64::from(MOST));
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                let is_below = 255.0 * f64::from(coded(middle as f32)) < code;
                *(if is_below { &mut low } else { &mut high }) = middle;
            }
            0.5 * (low + high)
        };
        (0..=255)
            .map(|code| {
                let code = f64::from(code);
                // White has no upper neighbour: there it is as steep as before.
                let (below, above) = ((code - 0.5).clamp(0.0, 253.5), (code + 0.5).min(254.5));
                (film(code.min(254.5)), (above - below).max(0.5) / (film(above) - film(below)).max(1e-6))
            })
            .collect()
    }

    /// Develops the first of eight pixels, as many as there is room for.
    #[inline]
    pub(super) fn develop(&self, light: &Vec3x8, pixels: &mut [[u8; 3]]) {
        let (r, g, b) = (Self::indices(light.x), Self::indices(light.y), Self::indices(light.z));
        let code = |i: u32| self.0.get(i as usize).copied().unwrap_or(255);
        for (i, pixel) in pixels.iter_mut().take(LANES).enumerate() {
            *pixel = [code(r[i]), code(g[i]), code(b[i])];
        }
    }

    #[inline]
    fn indices(value: F32x8) -> [u32; LANES] {
        // What is not a number goes to the start.
        let v = value.simd_gt(LEAST).select(value, F32x8::splat(LEAST));
        let bits = v.to_bits().min(U32x8::splat(MOST.to_bits() - 1));
        ((bits - LEAST.to_bits()) >> SHIFT).to_array()
    }
}
