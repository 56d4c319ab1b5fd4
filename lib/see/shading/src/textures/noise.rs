//! Noise for textures and clouds: one square tile of fractal value noise with a chain of coarser copies.
//!
//! The tile repeats without a seam. Coarser copies are averages, so a texture seen from afar fades to its
//! mean and does not flicker when the camera moves.

use std::sync::OnceLock;

use simd::{F32x8, U32x8, floor_words, lerp, number_of};

/// Side of the tile, texels; a power of two.
const SIDE: usize = 256;
/// Copies: from full size down to one texel.
const LEVELS: usize = SIDE.ilog2() as usize + 1;
/// Lattice cells across the tile in the coarsest octave.
const COARSEST: usize = 4;

/// The tile.
#[derive(Debug)]
pub struct Noise {
    /// Square levels, each half the side of the one before.
    levels: [Vec<u8>; LEVELS],
    /// Each texel of the finest level with its right, lower and lower right neighbour, a byte each from the
    /// lowest.
    quads: Vec<u32>,
}

/// Mixes two lattice coordinates and a seed to 32 even bits (the finaliser of MurmurHash3).
#[inline]
pub fn hash2(x: i32, y: i32, seed: u32) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed;
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// A word as a number in `[0, 1)`.
#[inline]
pub fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

impl Noise {
    /// The one tile; its numbers are fixed.
    pub fn get() -> &'static Self {
        static TILE: OnceLock<Noise> = OnceLock::new();
        TILE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let mut sum = vec![0.0f32; SIDE * SIDE];
        let mut amplitude = 1.0;
        let mut cells = COARSEST;
        while cells <= SIDE {
            for (index, value) in sum.iter_mut().enumerate() {
                let at = |i: usize| i as f32 * cells as f32 / SIDE as f32;
                *value += amplitude * (lattice(at(index % SIDE), at(index / SIDE), cells as i32) - 0.5);
            }
            amplitude *= 0.62;
            cells *= 2;
        }
        // Spread to the whole range: mean in the middle, 2.2 standard deviations to the ends.
        let mean = sum.iter().sum::<f32>() / sum.len() as f32;
        let variance = sum.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>() / sum.len() as f32;
        let scale = 127.5 / (2.2 * variance.sqrt());
        let mut level: Vec<u8> =
            sum.iter().map(|v| (127.5 + (v - mean) * scale).round().clamp(0.0, 255.0) as u8).collect();
        let levels = std::array::from_fn(|_| {
            let finer = level.clone();
            let side = finer.len().isqrt();
            if side > 1 {
                level = (0..side * side / 4)
                    .map(|i| {
                        let corner = 2 * (i / (side / 2)) * side + 2 * (i % (side / 2));
                        let four = [corner, corner + 1, corner + side, corner + side + 1];
                        (four.iter().map(|&c| u32::from(finer[c])).sum::<u32>().div_ceil(4)) as u8
                    })
                    .collect();
            }
            finer
        });
        let finest: &Vec<u8> = &levels[0];
        let quads = (0..SIDE * SIDE)
            .map(|i| {
                let (row, column) = (i & !(SIDE - 1), i & (SIDE - 1));
                let below = (row + SIDE) & (SIDE * SIDE - 1);
                let right = (column + 1) & (SIDE - 1);
                let four = [row | column, row | right, below | column, below | right];
                u32::from_le_bytes(four.map(|k| finest[k]))
            })
            .collect();
        Self { levels, quads }
    }

    /// [`at`](Self::at) eight places, whose footprints are alike: all are read as the smallest of them wants
    /// it.
    #[inline]
    pub fn at_all(&self, x: F32x8, y: F32x8, footprint: F32x8) -> F32x8 {
        let f = footprint.as_array();
        let (first, last) = (f[0], f[7]);
        let least = if first < last { first } else { last };
        if least < 1.0 {
            return self.interpolated_all(x, y);
        }
        let level = level_of(least);
        if level >= LEVELS - 1 {
            return F32x8::splat(0.5);
        }
        let scale = f32::from_bits((127 - level as u32) << 23);
        let (mask, shift) = ((SIDE as u32 - 1) >> level, SIDE.ilog2() - level as u32);
        let (column, row) = (floor_words(x * scale) & mask, floor_words(y * scale) & mask);
        let index = (row << shift) | column;
        let texels = &self.levels[level];
        let values = index.to_array().map(|i| u32::from(texels.get(i as usize).copied().unwrap_or(128)));
        number_of(values.into()) * (1.0 / 255.0)
    }

    #[inline]
    fn interpolated_all(&self, x: F32x8, y: F32x8) -> F32x8 {
        const MASK: u32 = SIDE as u32 - 1;
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let index = ((floor_words(y0) & MASK) << SIDE.ilog2()) | (floor_words(x0) & MASK);
        let four: U32x8 = index.to_array().map(|i| self.quads.get(i as usize).copied().unwrap_or(0)).into();
        let texel = |shift: u32| number_of((four >> shift) & 0xff);
        let upper = lerp(texel(0), texel(8), fx);
        let lower = lerp(texel(16), texel(24), fx);
        lerp(upper, lower, fy) * (1.0 / 255.0)
    }

    /// Value in 0 to 1 (mean 1/2) at a place in texels, averaged over about `footprint` texels.
    ///
    /// Texels that are larger than the footprint are interpolated, smaller ones are taken as they are.
    #[inline]
    pub fn at(&self, x: f32, y: f32, footprint: f32) -> f32 {
        if footprint < 1.0 {
            return self.interpolated(x, y);
        }
        let level = level_of(footprint);
        if level >= LEVELS - 1 {
            return 0.5;
        }
        let scale = f32::from_bits((127 - level as u32) << 23);
        let mask = (SIDE >> level) - 1;
        let (column, row) =
            ((x * scale).floor() as i32 as usize & mask, (y * scale).floor() as i32 as usize & mask);
        let index = (row << (SIDE.ilog2() as usize - level)) | column;
        f32::from(self.levels[level].get(index).copied().unwrap_or(128)) * (1.0 / 255.0)
    }

    /// The finest level between texel centres.
    #[inline]
    fn interpolated(&self, x: f32, y: f32) -> f32 {
        const MASK: usize = SIDE - 1;
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (column, row) = (x0 as i32 as usize, y0 as i32 as usize);
        let (left, right) = (column & MASK, column.wrapping_add(1) & MASK);
        let (top, bottom) = ((row & MASK) * SIDE, (row.wrapping_add(1) & MASK) * SIDE);
        let texels = &self.levels[0];
        let texel = |i: usize| f32::from(texels.get(i).copied().unwrap_or(128));
        let (a, b) = (texel(top | left), texel(top | right));
        let (c, d) = (texel(bottom | left), texel(bottom | right));
        let upper = a + (b - a) * fx;
        let lower = c + (d - c) * fx;
        (upper + (lower - upper) * fy) * (1.0 / 255.0)
    }
}

/// The level whose texels are as large as a footprint of at least a texel.
#[inline]
fn level_of(footprint: f32) -> usize {
    // The exponent of a floating-point number is the floor of its base-2 logarithm.
    ((footprint * 1.4).to_bits() >> 23) as usize - 127
}

/// Value noise that repeats after `cells` cells.
pub(crate) fn lattice(x: f32, y: f32, cells: i32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (sx, sy) = (smooth(x - x0), smooth(y - y0));
    let value = |dx: i32, dy: i32| {
        unit(hash2((x0 as i32 + dx).rem_euclid(cells), (y0 as i32 + dy).rem_euclid(cells), cells as u32))
    };
    let upper = value(0, 0) + (value(1, 0) - value(0, 0)) * sx;
    let lower = value(0, 1) + (value(1, 1) - value(0, 1)) * sx;
    upper + (lower - upper) * sy
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_repeats_without_a_seam_and_fades_to_its_mean() {
        let noise = Noise::get();
        for i in 0..100 {
            // Multiples of a quarter: adding a period rounds nothing.
            let (x, y) = (i as f32 * 2.75, i as f32 * 5.25);
            assert_eq!(noise.at(x, y, 1.0), noise.at(x + 256.0, y - 512.0, 1.0));
            assert!((noise.at(x, y, 100.0) - 0.5).abs() < 0.2);
            assert_eq!(noise.at(x, y, 1e6), 0.5);
        }
        let values: Vec<f32> = (0..4096).map(|i| noise.at(i as f32 * 7.3, i as f32 * 3.1, 1.0)).collect();
        let mean = values.iter().sum::<f32>() / 4096.0;
        assert!((mean - 0.5).abs() < 0.03, "{mean}");
        assert!(values.iter().any(|&v| v < 0.15) && values.iter().any(|&v| v > 0.85));
    }

    #[test]
    fn eight_are_read_as_one_is() {
        let noise = Noise::get();
        for footprint in [0.2, 0.99, 1.0, 1.5, 3.0, 70.0, 1e5] {
            let x: [f32; 8] = std::array::from_fn(|i| i as f32 * 37.3 - 400.0);
            let y: [f32; 8] = std::array::from_fn(|i| i as f32 * -11.7 + 255.4);
            let all = noise.at_all(x.into(), y.into(), F32x8::splat(footprint)).to_array();
            for i in 0..8 {
                assert_eq!(all[i], noise.at(x[i], y[i], footprint), "{footprint} {i}");
            }
        }
    }

    #[test]
    fn neighbours_are_close() {
        let noise = Noise::get();
        for i in 0..1000 {
            let (x, y) = (i as f32 * 0.37, 11.0);
            assert!((noise.at(x, y, 0.5) - noise.at(x + 0.01, y, 0.5)).abs() < 0.02);
        }
    }
}
