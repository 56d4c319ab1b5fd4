//! From light to 8-bit sRGB.

use lanes::{LANES, Lanes, Vec3s, Words};

/// Range of the table: powers of two, with 256 steps to each doubling.
const LEAST: f32 = 1.0 / 8192.0;
const MOST: f32 = 32.0;
const SHIFT: u32 = 23 - 8;

/// A film: 8-bit sRGB of film values, by the leading bits of the number.
#[derive(Clone, Debug)]
pub(super) struct Film(Vec<u8>);

impl Film {
    /// A filmic curve (Narkowicz, "ACES filmic tone mapping curve", 2015) and the sRGB code.
    pub(super) fn new() -> Self {
        let entries = (MOST.to_bits() - LEAST.to_bits()) >> SHIFT;
        let code = |i: u32| {
            let half = 1 << (SHIFT - 1);
            let v = if i == 0 { 0.0 } else { f32::from_bits(LEAST.to_bits() + (i << SHIFT) + half) };
            let linear = (v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14)).min(1.0);
            let coded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * frames::math::f32::pow(linear, 1.0 / 2.4) - 0.055
            };
            (coded * 255.0 + 0.5) as u8
        };
        Self((0..entries).map(code).collect())
    }

    /// Develops the first of eight pixels, as many as there is room for.
    #[inline]
    pub(super) fn develop(&self, light: &Vec3s, pixels: &mut [[u8; 3]]) {
        let (r, g, b) = (Self::indices(light.x), Self::indices(light.y), Self::indices(light.z));
        let code = |i: u32| self.0.get(i as usize).copied().unwrap_or(255);
        for (i, pixel) in pixels.iter_mut().take(LANES).enumerate() {
            *pixel = [code(r[i]), code(g[i]), code(b[i])];
        }
    }

    #[inline]
    fn indices(value: Lanes) -> [u32; LANES] {
        // What is not a number goes to the start.
        let v = value.simd_gt(LEAST).select(value, Lanes::splat(LEAST));
        let bits = v.to_bits().min(Words::splat(MOST.to_bits() - 1));
        ((bits - LEAST.to_bits()) >> SHIFT).to_array()
    }
}
