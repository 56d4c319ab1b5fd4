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

    /// Of a PNG file of 8-bit red, green, blue.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn from_png(bytes: &[u8]) -> Result<Self, String> {
        let wrong = |e: png::DecodingError| format!("the picture is no PNG: {e}");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(wrong)?;
        if reader.output_color_type() != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err("the picture has not 8 bits of red, green and blue each".into());
        }
        let size = reader.output_buffer_size().ok_or("the picture is too large")?;
        let mut rgb = vec![0; size];
        let png::OutputInfo { width, height, .. } = reader.next_frame(&mut rgb).map_err(wrong)?;
        Ok(Self { width, height, rgb })
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn to_png(&self) -> Result<Vec<u8>, String> {
        encode(self.width, self.height, png::ColorType::Rgb, png::Filter::Paeth, &self.rgb)
    }
}

/// A byte of grey a pixel, row by row, as a PNG file.
///
/// # Errors
/// It has other than `width` times `height` bytes.
pub(crate) fn grey_png(width: u32, height: u32, grey: &[u8]) -> Result<Vec<u8>, String> {
    encode(width, height, png::ColorType::Grayscale, png::Filter::Sub, grey)
}

fn encode(
    width: u32,
    height: u32,
    color: png::ColorType,
    filter: png::Filter,
    pixels: &[u8],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(filter);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
    written.map_err(|e| format!("the picture cannot be written: {e}"))?;
    Ok(bytes)
}
