//! Pictures of a store in other formats.

use codecs::images::{ImageError, Limits, Pixels, PngStyle, RgbImage, decode_jpeg, encode_png};

/// A JPEG file as a PNG file.
///
/// # Errors
/// It is no JPEG, or broken.
pub(crate) fn png_of_jpeg(jpeg: &[u8]) -> Result<Vec<u8>, ImageError> {
    let RgbImage { width, height, rgb } = decode_jpeg(jpeg, Limits::SENSOR)?;
    encode_png([width, height], &Pixels::Rgb(&rgb), PngStyle::SMOOTH)
}

/// A byte of grey a pixel, row by row, as a PNG file.
///
/// # Errors
/// It has other than `width` times `height` bytes.
pub(crate) fn grey_png(size: [u32; 2], grey: &[u8]) -> Result<Vec<u8>, ImageError> {
    encode_png(size, &Pixels::Grey(grey), PngStyle::FLAT)
}
