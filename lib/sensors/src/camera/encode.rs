//! Encoders with settings chosen by measurement (`benches/sensors.rs`).

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use schema::Tag;
use visibility::VisibilityBuffer;

use super::Picture;
use crate::error::SensorError;

/// Colour as JPEG, chroma at half resolution both ways.
pub(super) fn jpeg(picture: &Picture, quality: u8) -> Result<Vec<u8>, SensorError> {
    let size = SensorError::PictureSize { width: picture.width, height: picture.height };
    let (Ok(width), Ok(height)) = (u16::try_from(picture.width), u16::try_from(picture.height)) else {
        return Err(size);
    };
    let mut bytes = Vec::with_capacity(picture.rgb.len() / 8);
    let mut encoder = Encoder::new(&mut bytes, quality.clamp(1, 100));
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    encoder.encode(&picture.rgb, width, height, ColorType::Rgb)?;
    Ok(bytes)
}

/// Three bytes a pixel as PNG.
pub(super) fn png_rgb(rgb: &[u8], buffer: &VisibilityBuffer) -> Result<Vec<u8>, SensorError> {
    let mut bytes = Vec::with_capacity(rgb.len() / 16);
    let mut encoder = png::Encoder::new(&mut bytes, buffer.width, buffer.height);
    encoder.set_color(png::ColorType::Rgb);
    write(encoder, rgb)?;
    Ok(bytes)
}

/// One tag a pixel as PNG with the tags' colours as palette.
pub(super) fn png_palette(tags: &[u8], buffer: &VisibilityBuffer) -> Result<Vec<u8>, SensorError> {
    let mut bytes = Vec::with_capacity(tags.len() / 16);
    let mut encoder = png::Encoder::new(&mut bytes, buffer.width, buffer.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(Tag::ALL.iter().flat_map(|tag| tag.camera_rgb()).collect::<Vec<u8>>());
    write(encoder, tags)?;
    Ok(bytes)
}

/// One fixed filter is as small as a search for the best, and faster: of a street, 1600 x 900, the tags take 19 kB and
/// 0.35 ms, instances 38 kB and 0.8 ms, depth 474 kB and 2.4 ms (on one core; slower compression halves the bytes and
/// takes 20 times as long).
fn write(mut encoder: png::Encoder<'_, &mut Vec<u8>>, data: &[u8]) -> Result<(), SensorError> {
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Paeth);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(())
}
