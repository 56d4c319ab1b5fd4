//! JPEG files.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::error::ImageError;
use super::rgb::{Limits, RgbImage};

/// How finely a JPEG keeps colours (brightness is always kept whole).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chroma {
    /// As finely as brightness where the quality is 90 or more, at half resolution both ways below.
    ByQuality,
    /// At half resolution both ways.
    Half,
}

/// A JPEG of red, green and blue, three bytes a pixel, of a quality from 1 to 100.
///
/// # Errors
/// A side is longer than a JPEG can have, or there are not as many pixels.
pub fn encode_jpeg(
    [width, height]: [u32; 2],
    rgb: &[u8],
    quality: u8,
    chroma: Chroma,
) -> Result<Vec<u8>, ImageError> {
    let (Ok(short_width), Ok(short_height)) = (u16::try_from(width), u16::try_from(height)) else {
        let (width, height, most_px) = (width as usize, height as usize, usize::from(u16::MAX));
        return Err(ImageError::Size { width, height, most_px });
    };
    let mut bytes = Vec::with_capacity(rgb.len() / 8);
    let mut encoder = Encoder::new(&mut bytes, quality.clamp(1, 100));
    if chroma == Chroma::Half {
        encoder.set_sampling_factor(SamplingFactor::F_2_2);
    }
    encoder.encode(rgb, short_width, short_height, ColorType::Rgb)?;
    Ok(bytes)
}

type Decoder<'f> = JpegDecoder<ZCursor<&'f [u8]>>;

/// The size of a JPEG, and its decoder behind the headers.
fn headers(bytes: &[u8], limits: Limits) -> Result<([u32; 2], Decoder<'_>), ImageError> {
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(limits.side_px)
        .set_max_height(limits.side_px);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(ImageError::Jpeg)?;
    let (width, height) = decoder.dimensions().ok_or(ImageError::Pixels)?;
    Ok((limits.check(width, height)?, decoder))
}

/// Width and height of a JPEG.
///
/// # Errors
/// It is none, or too large.
pub fn jpeg_size(bytes: &[u8], limits: Limits) -> Result<[u32; 2], ImageError> {
    Ok(headers(bytes, limits)?.0)
}

/// The pixels of a JPEG. Its size is looked at before anything is decoded.
///
/// # Errors
/// It is none, broken, or too large.
pub fn decode_jpeg(bytes: &[u8], limits: Limits) -> Result<RgbImage, ImageError> {
    let (size, mut decoder) = headers(bytes, limits)?;
    RgbImage::of(size, decoder.decode().map_err(ImageError::Jpeg)?)
}
