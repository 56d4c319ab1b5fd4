//! Encoders with settings chosen by measurement (`benches/sensors.rs`).

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use render::{CameraError, VisibilityBuffer};
use schema::table::Blob;
use schema::tables::CameraRow;

use crate::error::SensorError;
use shading::Picture;

/// An encoded image as a row of its table.
pub(super) fn camera_row(frame: u32, image: Vec<u8>) -> CameraRow {
    CameraRow { frame, time_s: crate::frame_time_s(frame), image: Blob(image) }
}

/// Colour as JPEG, chroma at half resolution both ways.
pub(super) fn jpeg(picture: &Picture, quality: u8) -> Result<Vec<u8>, SensorError> {
    let size = CameraError::PictureSize { width: picture.width, height: picture.height };
    let (Ok(width), Ok(height)) = (u16::try_from(picture.width), u16::try_from(picture.height)) else {
        return Err(size.into());
    };
    let mut bytes = Vec::with_capacity(picture.rgb.len() / 8);
    let mut encoder = Encoder::new(&mut bytes, quality.clamp(1, 100));
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    encoder.encode(&picture.rgb, width, height, ColorType::Rgb)?;
    Ok(bytes)
}

/// What a picture's pixels have in common with their neighbours, which decides the PNG filter.
///
/// Measured on 228 pictures of four towns, 640 x 360, on one core: with the difference to the left tags take
/// 20.7 kB and 0.2 ms, instances 16.0 kB and 0.4 ms, depth 244 kB and 0.9 ms; with Paeth's predictor 14.0 kB
/// and 2.7 ms, 10.7 kB and 4.9 ms, 112 kB and 3.4 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Areas of one colour.
    Flat,
    /// Gradients.
    Smooth,
}

/// Three bytes a pixel as PNG, 8 bits each.
pub(super) fn png_rgb(
    rgb: &[u8],
    content: Content,
    buffer: &VisibilityBuffer,
) -> Result<Vec<u8>, SensorError> {
    let mut bytes = Vec::with_capacity(rgb.len() / 16);
    let mut encoder = png::Encoder::new(&mut bytes, buffer.width, buffer.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(match content {
        Content::Flat => png::Filter::Sub,
        Content::Smooth => png::Filter::Paeth,
    });
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(bytes)
}
