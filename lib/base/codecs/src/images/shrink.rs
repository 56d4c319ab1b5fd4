//! Thumbnails.

use super::error::ImageError;
use super::jpeg::{Chroma, decode_jpeg, encode_jpeg};
use super::rgb::Limits;

/// The JPEG of an image at most so many pixels wide, of a quality from 1 to 100: each pixel is the mean of
/// those that it covers.
///
/// # Errors
/// It is no JPEG, or too large for one.
pub fn shrink(jpeg: &[u8], width_px: u32, quality: u8) -> Result<Vec<u8>, ImageError> {
    let image = decode_jpeg(jpeg, Limits::SENSOR)?;
    let [width, height] = [image.width as usize, image.height as usize];
    let small_width = (width_px.max(1) as usize).min(width);
    let small_height = (height * small_width).div_ceil(width);
    let small = means(&image.rgb, [width, height], [small_width, small_height]);
    encode_jpeg([small_width as u32, small_height as u32], &small, quality, Chroma::ByQuality)
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
}
