//! Pictures of a store in other formats.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// A picture: rows from the top, 8-bit red, green, blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<u8>,
}

impl Picture {
    /// Of a JPEG file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn from_jpeg(bytes: &[u8]) -> Result<Self, String> {
        let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
        let rgb = decoder.decode().map_err(|e| format!("the picture is no JPEG: {e}"))?;
        let (width, height) = decoder.dimensions().ok_or("the picture has no size")?;
        let side = |n: usize| u32::try_from(n).map_err(|_| "the picture is too large".to_owned());
        Ok(Self { width: side(width)?, height: side(height)?, rgb })
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn to_png(&self) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Paeth);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&self.rgb));
        written.map_err(|e| format!("the picture cannot be written: {e}"))?;
        Ok(bytes)
    }
}
