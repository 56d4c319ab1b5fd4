#![doc = include_str!("../README.md")]

use jpeg_encoder::{ColorType, Encoder};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// A photograph cannot be shrunk.
#[derive(Debug, thiserror::Error)]
pub enum ThumbnailError {
    /// It is broken.
    #[error("the picture is no JPEG: {0}")]
    Decode(String),
    /// The small one cannot be encoded.
    #[error("cannot encode the JPEG: {0}")]
    Encode(#[from] jpeg_encoder::EncodingError),
}

/// The JPEG of a picture at most so many pixels wide, of a quality from 1 to 100: each pixel is the mean of those that it covers.
///
/// # Errors
/// It is no JPEG, or too large for one.
pub fn shrink(jpeg: &[u8], width_px: u16, quality: u8) -> Result<Vec<u8>, ThumbnailError> {
    let wrong = |problem: &str| ThumbnailError::Decode(problem.to_owned());
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(jpeg), options);
    let rgb = decoder.decode().map_err(|e| wrong(&e.to_string()))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| wrong("it has no size"))?;
    if width == 0 || height == 0 || rgb.len() != 3 * width * height {
        return Err(wrong("it has not as many pixels as it says"));
    }
    let small_width = usize::from(width_px.max(1)).min(width);
    let small_height = (height * small_width).div_ceil(width);
    let small = means(&rgb, [width, height], [small_width, small_height]);
    let mut bytes = Vec::new();
    let encoder = Encoder::new(&mut bytes, quality.clamp(1, 100));
    // No side is longer than that of a JPEG.
    encoder.encode(&small, small_width as u16, small_height as u16, ColorType::Rgb)?;
    Ok(bytes)
}

/// Means over blocks of pixels, as even as whole pixels allow.
fn means(rgb: &[u8], [width, height]: [usize; 2], [small_width, small_height]: [usize; 2]) -> Vec<u8> {
    let mut small = Vec::with_capacity(3 * small_width * small_height);
    for row in 0..small_height {
        let rows = row * height / small_height
            ..((row + 1) * height / small_height).max(row * height / small_height + 1);
        for column in 0..small_width {
            let (from, to) = (column * width / small_width, (column + 1) * width / small_width);
            let mut sum = [0_usize; 3];
            for y in rows.clone() {
                for pixel in rgb[3 * (y * width + from)..3 * (y * width + to)].chunks_exact(3) {
                    (0..3).for_each(|k| sum[k] += usize::from(pixel[k]));
                }
            }
            let pixels = rows.len() * (to - from);
            small.extend(sum.map(|sum| ((sum + pixels / 2) / pixels) as u8));
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_means() {
        let rgb = [0, 0, 0, 10, 20, 30, 20, 40, 60, 30, 60, 90, 7, 7, 7, 9, 9, 9];
        assert_eq!(means(&rgb, [2, 3], [1, 3]), [5, 10, 15, 25, 50, 75, 8, 8, 8]);
        assert_eq!(means(&rgb, [2, 3], [2, 3]), rgb);
    }

    #[test]
    fn pictures_keep_their_shape_and_colours() {
        let rgb: Vec<u8> =
            (0..64 * 36).flat_map(|i| if i % 64 < 32 { [200, 40, 40] } else { [30, 60, 210] }).collect();
        let mut jpeg = Vec::new();
        Encoder::new(&mut jpeg, 95).encode(&rgb, 64, 36, ColorType::Rgb).expect("encodes");
        let small = shrink(&jpeg, 32, 95).expect("shrinks");
        let mut decoder = JpegDecoder::new(ZCursor::new(&small));
        let pixels = decoder.decode().expect("decodes");
        assert_eq!(decoder.dimensions(), Some((32, 18)));
        for (at, want) in [(3 * (9 * 32 + 4), [200, 40, 40]), (3 * (9 * 32 + 28), [30, 60, 210])] {
            assert!(
                (0..3).all(|k| i32::from(pixels[at + k]).abs_diff(want[k]) < 8),
                "{:?}",
                &pixels[at..at + 3]
            );
        }
        assert!(shrink(&jpeg[..20], 32, 80).is_err() && shrink(&[], 32, 80).is_err());
    }
}
