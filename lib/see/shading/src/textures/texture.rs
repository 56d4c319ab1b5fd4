//! A square of texels that repeats, with coarser copies of itself.

use simd::{F32x8, U32x8, floor_words, number_of};

use crate::textures::canvas::Canvas;

/// Shades are kept in steps of this.
const SHADE_STEP: f32 = 1.0 / 128.0;
/// Slopes and tints are kept in steps of this.
const SIGNED_STEP: f32 = 1.0 / 127.0;

/// A texture: shade, two slopes and tint, a byte each from the lowest of a word.
#[derive(Debug)]
pub struct Texture {
    per_m: f32,
    /// Square levels, each half the side of the one before, down to one texel.
    levels: Vec<Vec<u32>>,
    /// For each level, how much stronger its contrast is than the next one's, as a share of its own.
    fading: Vec<f32>,
}

/// Eight places of a texture.
#[derive(Clone, Copy, Debug)]
pub struct Texels {
    /// Factor on the surface's colour; 1 on average.
    pub shade: F32x8,
    /// How much of the second colour there is, less its average.
    pub tint: F32x8,
    /// How much the surface's normal leans along the first and second axis: with `1` along the plane's normal
    /// these make its direction. 0 on average.
    pub lean: [F32x8; 2],
}

impl Texels {
    /// Places without anything to see.
    pub const EVEN: Self = Self { shade: F32x8::ONE, tint: F32x8::ZERO, lean: [F32x8::ZERO; 2] };
}

/// A texel in numbers: shade, slopes, tint.
type Values = [f32; 4];

impl Texture {
    /// Of what was drawn, `per_m` texels to a metre.
    pub(crate) fn new(canvas: &Canvas, per_m: f32) -> Self {
        let side = canvas.side;
        assert!(side.is_power_of_two(), "sides are powers of two");
        let spots = &canvas.spots;
        let mean = |of: &dyn Fn(usize) -> f32| {
            // Rows first: a sum over all would lose digits.
            let row = |y: usize| (0..side).map(|x| of(y * side + x)).sum::<f32>() / side as f32;
            (0..side).map(row).sum::<f32>() / side as f32
        };
        let tint = mean(&|i| spots[i].tint);
        let mut shades: Vec<f32> = spots.iter().map(|spot| spot.shade).collect();
        for _ in 0..3 {
            // Cutting what is too bright moves the mean, a little less each time.
            let scale = 1.0 / mean(&|i| shades[i]);
            shades.iter_mut().for_each(|shade| *shade = (*shade * scale).clamp(0.02, 1.98));
        }
        let wrap = |v: usize| v & (side - 1);
        let mut values: Vec<Values> = (0..side * side)
            .map(|i| {
                let (x, y) = (i % side, i / side);
                let height = |x: usize, y: usize| spots[wrap(y) * side + wrap(x)].height;
                let slope = |low: f32, high: f32| (0.5 * (low - high)).clamp(-1.0, 1.0);
                let along = slope(height(x + side - 1, y), height(x + 1, y));
                let across = slope(height(x, y + side - 1), height(x, y + 1));
                [shades[i], along, across, (spots[i].tint - tint).clamp(-1.0, 1.0)]
            })
            .collect();
        // Cutting what is too steep leaves a lean, which coarser copies would keep.
        for k in [1, 2] {
            let lean = mean(&|i| values[i][k]);
            values.iter_mut().for_each(|texel| texel[k] -= lean);
        }
        let (mut levels, mut contrasts) = (Vec::new(), Vec::new());
        loop {
            levels.push(values.iter().enumerate().map(|(i, texel)| packed(texel, i)).collect());
            contrasts.push(contrast(&values));
            if values.len() == 1 {
                break;
            }
            values = halved(&values);
        }
        let share = |pair: &[f32]| if pair[0] > 0.0 { 1.0 - pair[1] / pair[0] } else { 0.0 };
        let fading = contrasts.windows(2).map(share).collect();
        Self { per_m, levels, fading }
    }

    /// Texels in a metre.
    #[must_use]
    pub fn per_m(&self) -> f32 {
        self.per_m
    }

    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| 4 * level.len()).sum()
    }

    /// Eight places, metres along its axes, each averaged over about `footprint_m`: of the coarser copies the
    /// one is read that the smallest of the first and last place wants, between the middles of its texels.
    #[inline]
    #[must_use]
    pub fn at(&self, x_m: F32x8, y_m: F32x8, footprint_m: F32x8) -> Texels {
        let f = footprint_m.as_array();
        let least = 1.4 * self.per_m * if f[0] < f[7] { f[0] } else { f[7] };
        // The exponent of a floating-point number is the floor of its base-2 logarithm.
        let level = if least < 1.0 { 0 } else { (least.to_bits() >> 23) as usize - 127 };
        let top = self.levels.len() - 1;
        if level >= top {
            return Texels::EVEN;
        }
        let scale = f32::from_bits((127 - level as u32) << 23);
        // Contrast falls evenly to that of the next copy, so that none shows where it begins.
        let into = least * scale - 1.0;
        let kept = if into > 0.0 { 1.0 - into * self.fading[level] } else { 1.0 };
        let per_m = self.per_m * scale;
        let shift = (top - level) as u32;
        let mask = (1u32 << shift) - 1;
        let (x, y) = (x_m * per_m - 0.5, y_m * per_m - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (left, upper) = (floor_words(x0), floor_words(y0));
        let (right, lower) = ((left + 1) & mask, ((upper + 1) & mask) << shift);
        let (left, upper) = (left & mask, (upper & mask) << shift);
        let texels = &self.levels[level][..];
        let read = |index: U32x8| -> U32x8 {
            index.to_array().map(|i| texels.get(i as usize).copied().unwrap_or(0)).into()
        };
        let four = [upper | left, upper | right, lower | left, lower | right].map(read);
        let (gx, gy) = ((1.0 - fx) * kept, 1.0 - fy);
        let fx = fx * kept;
        let weights = [gx * gy, fx * gy, gx * fy, fx * fy];
        let signed = |shift: u32| weighted(&four, &weights, shift) * SIGNED_STEP - 128.0 * SIGNED_STEP * kept;
        Texels {
            shade: weighted(&four, &weights, 0) * SHADE_STEP + (1.0 - kept),
            lean: [signed(8), signed(16)],
            tint: signed(24),
        }
    }
}

/// The sum of a byte of four words, each by its weight.
#[inline]
fn weighted(four: &[U32x8; 4], weights: &[F32x8; 4], shift: u32) -> F32x8 {
    let [a, b, c, d] = *four;
    let [wa, wb, wc, wd] = *weights;
    let byte = |words: U32x8| number_of((words >> shift) & 0xff);
    byte(a) * wa + byte(b) * wb + byte(c) * wc + byte(d) * wd
}

/// How far shades are from 1: the root of the mean square.
fn contrast(values: &[Values]) -> f32 {
    let side = values.len().isqrt();
    // Rows first: a sum over all would lose digits.
    let row = |row: &[Values]| {
        row.iter().map(|texel| (texel[0] - 1.0) * (texel[0] - 1.0)).sum::<f32>() / side as f32
    };
    (values.chunks(side).map(row).sum::<f32>() / side as f32).sqrt()
}

/// Means of two by two.
fn halved(values: &[Values]) -> Vec<Values> {
    let side = values.len().isqrt();
    let half = side / 2;
    (0..half * half)
        .map(|i| {
            let corner = 2 * (i / half) * side + 2 * (i % half);
            let four = [corner, corner + 1, corner + side, corner + side + 1].map(|k| values[k]);
            std::array::from_fn(|k| 0.25 * four.iter().map(|texel| texel[k]).sum::<f32>())
        })
        .collect()
}

/// A texel as a word, rounded up or down by a pattern of its place: means of many keep what one loses.
fn packed(texel: &Values, index: usize) -> u32 {
    let threshold = crate::textures::noise::unit((index as u32).wrapping_mul(0x9e37_79b1));
    let byte = |v: f32| ((v + threshold).floor().clamp(0.0, 255.0)) as u32;
    let signed = |v: f32| byte(v * 127.0 + 128.0);
    byte(texel[0] * 128.0) | signed(texel[1]) << 8 | signed(texel[2]) << 16 | signed(texel[3]) << 24
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use simd::STEPS;

    use super::*;
    use crate::textures::Textures;
    use crate::textures::canvas::Spot;

    /// Shade, slopes and tint of a texel.
    fn values(word: u32) -> [f64; 4] {
        let [shade, along, across, tint] = word.to_le_bytes().map(f64::from);
        [shade / 128.0, (along - 128.0) / 127.0, (across - 128.0) / 127.0, (tint - 128.0) / 127.0]
    }

    fn mean(level: &[u32]) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for word in level {
            sum.iter_mut().zip(values(*word)).for_each(|(sum, v)| *sum += v / level.len() as f64);
        }
        sum
    }

    #[test]
    fn colours_stay_true_and_surfaces_level_at_every_distance() {
        for (name, texture) in Textures::get().all() {
            for level in texture.levels.iter().filter(|level| level.len() >= 16) {
                let [shade, along, across, tint] = mean(level);
                assert!((shade - 1.0).abs() < 0.01, "{name} {}: {shade}", level.len());
                for other in [along, across, tint] {
                    assert!(other.abs() < 0.01, "{name} {}: {along} {across} {tint}", level.len());
                }
            }
        }
    }

    #[test]
    fn edges_go_on() {
        // Steps from column to column, and those over the edge: of one kind.
        for (name, texture) in Textures::get().all() {
            let level = &texture.levels[0];
            let side = level.len().isqrt();
            let step = |x: usize| {
                let next = (x + 1) % side;
                let of =
                    |y: usize| (values(level[y * side + x])[0] - values(level[y * side + next])[0]).abs();
                let over =
                    |y: usize| (values(level[x * side + y])[0] - values(level[next * side + y])[0]).abs();
                (0..side).map(|y| of(y) + over(y)).sum::<f64>() / side as f64
            };
            let most = (0..side - 1).map(step).fold(0.0, f64::max);
            assert!(step(side - 1) <= 1.05 * most, "{name}: {} {most}", step(side - 1));
        }
    }

    #[test]
    fn all_are_there_and_small() {
        let all = Textures::get().all();
        assert!(all.iter().map(|(_, texture)| texture.bytes()).sum::<usize>() < 16 << 20);
        for (name, texture) in all {
            let spread = texture.levels[0].iter().map(|w| (values(*w)[0] - 1.0).abs()).sum::<f64>();
            assert!(spread / texture.levels[0].len() as f64 > 0.02, "{name} shows nothing");
        }
    }

    #[test]
    fn made_anew_they_are_the_same() {
        for (again, texture) in [
            (crate::textures::plants::leaves(), &Textures::get().leaves),
            (crate::textures::stone::plaster(), &Textures::get().plaster),
        ] {
            assert_eq!(again.levels, texture.levels);
        }
    }

    #[test]
    fn a_slope_leans_the_normal_away_from_what_is_higher() {
        // A ridge of four texels across the tile, as high as one is wide.
        let canvas = Canvas::new(16, |x, _| {
            let up = 1.0 - (x * 16.0 - 8.0).abs() / 4.0;
            Spot { height: 2.0 * up.max(0.0), shade: 1.0, tint: 0.0 }
        });
        let texture = Texture::new(&canvas, 16.0);
        let seen = texture.at((STEPS + 4.5) * (1.0 / 16.0), F32x8::splat(0.3), F32x8::splat(1e-3));
        let [along, across] = seen.lean.map(F32x8::to_array);
        // It rises by half a texel a texel, then falls.
        assert!((along[1] + 0.5).abs() < 0.01 && (along[6] - 0.5).abs() < 0.01, "{along:?}");
        assert!(across.iter().all(|v| v.abs() < 0.01), "{across:?}");
        assert!(seen.shade.to_array().iter().all(|v| (v - 1.0).abs() < 0.01));
    }

    proptest! {
        #[test]
        fn it_repeats_and_eight_are_read_as_one_is(x in -8.0..8.0f32, y in -8.0..8.0f32, footprint in 1e-3..3.0f32) {
            let texture = &Textures::get().brick;
            // Multiples of a texel's 256th: adding a period rounds nothing.
            let even = |v: f32| (v * 65_536.0).round() / 65_536.0;
            let (x, y, f) = (STEPS * 0.125 + even(x), F32x8::splat(even(y)), F32x8::splat(footprint));
            let (here, there) = (texture.at(x, y, f), texture.at(x + 2.0, y - 4.0, f));
            prop_assert_eq!(here.shade, there.shade);
            prop_assert_eq!(here.lean, there.lean);
            for i in 0..8 {
                let one = texture.at(F32x8::splat(x.as_array()[i]), y, f);
                prop_assert_eq!(one.tint.as_array()[0], here.tint.as_array()[i]);
            }
        }
    }
}
