//! Pictures: decoded, coloured, with coarser copies.

use codecs::images::{AnyImage, ImageError, Limits, decode_any};
use frames::math;
use schema::mesh_textures::{Image, Level, Wrap};

use crate::limits::{DETAIL_SIDE, IMAGE_SIDE};

/// sRGB bytes and linear light, by tables.
pub(crate) struct Curve {
    linear: [f32; 256],
    /// Bytes of linear light in steps of a 4095th.
    bytes: Vec<u8>,
}

impl Curve {
    /// IEC 61966-2-1.
    pub(crate) fn new() -> Self {
        let linear = std::array::from_fn(|byte| {
            let v = byte as f64 / 255.0;
            (if v <= 0.040_45 { v / 12.92 } else { math::pow((v + 0.055) / 1.055, 2.4) }) as f32
        });
        let byte = |step: u32| {
            let v = f64::from(step) / 4095.0;
            let v = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * math::pow(v, 1.0 / 2.4) - 0.055 };
            (255.0 * v).round() as u8
        };
        Self { linear, bytes: (0..=4095).map(byte).collect() }
    }

    pub(crate) fn linear(&self, rgb: [u8; 3]) -> [f32; 3] {
        rgb.map(|byte| self.linear[usize::from(byte)])
    }

    pub(crate) fn bytes(&self, rgb: [f32; 3]) -> [u8; 3] {
        rgb.map(|v| self.bytes[(v.clamp(0.0, 1.0) * 4095.0).round() as usize])
    }
}

/// A picture as its file has it.
pub(crate) struct Decoded {
    pub(crate) picture: Level,
    /// How much of each texel is there, of 255; empty: all of it.
    pub(crate) alpha: Vec<u8>,
}

/// Decodes a PNG or JPEG. Its size is looked at before anything is decoded.
pub(crate) fn decode(bytes: &[u8]) -> Result<Decoded, ImageError> {
    let AnyImage { image, alpha } = decode_any(bytes, Limits::of_side(IMAGE_SIDE))?;
    let texels = image.rgb.as_chunks::<3>().0.to_vec();
    Ok(Decoded { picture: Level { width: image.width, height: image.height, texels }, alpha })
}

/// What the bytes of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// sRGB colours.
    Colour,
    /// sRGB, of light that is kept less finely.
    Glow,
    /// Shares of 255, kept less finely as well.
    Numbers,
}

impl Meaning {
    /// Light or shares.
    fn shares(self, bytes: [u8; 3], curve: &Curve) -> [f32; 3] {
        if self == Self::Numbers { bytes.map(|v| f32::from(v) / 255.0) } else { curve.linear(bytes) }
    }

    /// And back.
    fn bytes(self, shares: [f32; 3], curve: &Curve) -> [u8; 3] {
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        if self == Self::Numbers { shares.map(byte) } else { curve.bytes(shares) }
    }

    /// Pixels along a side at most.
    fn side(self) -> u32 {
        if self == Self::Colour { IMAGE_SIDE as u32 } else { DETAIL_SIDE }
    }
}

/// A picture whose colours are multiplied by factors, with its coarser copies: means of up to two by two
/// texels, of their light.
pub(crate) fn image(
    picture: &Level,
    factors: [f32; 3],
    wrap: [Wrap; 2],
    meaning: Meaning,
    curve: &Curve,
) -> Image {
    let mut first = picture.clone();
    if factors != [1.0; 3] {
        for texel in &mut first.texels {
            let seen = meaning.shares(*texel, curve);
            *texel = meaning.bytes([0, 1, 2].map(|k| seen[k] * factors[k]), curve);
        }
    }
    while first.width.max(first.height) > meaning.side() {
        first = halved(&first, meaning, curve);
    }
    let mut levels = vec![first];
    while let Some(last) = levels.last().filter(|last| last.width > 1 || last.height > 1) {
        let next = halved(last, meaning, curve);
        levels.push(next);
    }
    Image { levels, wrap }
}

fn halved(from: &Level, meaning: Meaning, curve: &Curve) -> Level {
    let [width, height] = [from.width.div_ceil(2), from.height.div_ceil(2)];
    let mut texels = Vec::with_capacity((width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0_f32; 3];
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let [x, y] = [(2 * x + dx).min(from.width - 1), (2 * y + dy).min(from.height - 1)];
                let seen = meaning.shares(from.texels[(y * from.width + x) as usize], curve);
                (0..3).for_each(|k| sum[k] += 0.25 * seen[k]);
            }
            texels.push(meaning.bytes(sum, curve));
        }
    }
    Level { width, height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_way_to_light_and_back() {
        let curve = Curve::new();
        for byte in 0..=255_u8 {
            let there = curve.bytes(curve.linear([byte; 3]))[0];
            // Steps of a 4095th are coarser than the darkest bytes.
            assert!(there.abs_diff(byte) <= u8::from(byte < 16), "{byte} {there}");
        }
    }

    #[test]
    fn coarser_copies_have_the_mean_light() {
        let curve = Curve::new();
        let texels = (0..15).map(|i| if i % 2 == 0 { [255, 0, 0] } else { [0, 0, 255] }).collect();
        let image = image(
            &Level { width: 5, height: 3, texels },
            [1.0; 3],
            [Wrap::Repeat; 2],
            Meaning::Colour,
            &curve,
        );
        let sizes: Vec<_> = image.levels.iter().map(|l| (l.width, l.height)).collect();
        assert_eq!(sizes, [(5, 3), (3, 2), (2, 1), (1, 1)]);
        // A chequerboard: half of each; half the light is byte 188.
        assert_eq!(image.levels[1].texels[0], [188, 0, 188]);
    }

    #[test]
    fn numbers_are_no_light_and_large_ones_are_kept_at_half() {
        let curve = Curve::new();
        let level = |width: u32| {
            let texels = (0..width).map(|i| if i % 2 == 0 { [200, 0, 255] } else { [100, 0, 255] }).collect();
            Level { width, height: 1, texels }
        };
        let of = |width, meaning| image(&level(width), [0.5, 1.0, 1.0], [Wrap::Repeat; 2], meaning, &curve);
        let numbers = of(2, Meaning::Numbers);
        assert_eq!(numbers.levels[0].texels, [[100, 0, 255], [50, 0, 255]]);
        assert_eq!(numbers.levels[1].texels, [[75, 0, 255]]);
        // Half the light of byte 200 is byte 146.
        assert_eq!(of(2, Meaning::Glow).levels[0].texels[0][0], 146);
        let sides = [Meaning::Colour, Meaning::Glow, Meaning::Numbers].map(|m| of(2048, m).levels[0].width);
        assert_eq!(sides, [2048, 1024, 1024]);
    }
}
