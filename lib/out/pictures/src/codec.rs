//! Images of sensors as pixels.

use std::io::Cursor;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::{Canvas, PictureError};

/// Largest side of an image, pixels.
const MOST_PX: usize = 16_384;
/// Most memory that decoding a PNG may take, bytes.
const MOST_BYTES: usize = 1 << 30;

/// The pixels of a JPEG file.
///
/// # Errors
/// [`PictureError::Decode`].
pub fn decode_jpeg(bytes: &[u8]) -> Result<Canvas, PictureError> {
    let wrong = |problem: String| PictureError::Decode { kind: "JPEG", problem };
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(MOST_PX)
        .set_max_height(MOST_PX);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    let rgb = decoder.decode().map_err(|e| wrong(e.to_string()))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| wrong("it has no size".into()))?;
    Canvas::from_rgb([width as u32, height as u32], &rgb)
}

/// The size and pixels of a PNG file of 8-bit red, green and blue: all that the sensors write.
///
/// # Errors
/// [`PictureError::Decode`].
pub fn decode_png(bytes: &[u8]) -> Result<([u32; 2], Vec<u8>), PictureError> {
    let wrong = |problem: String| PictureError::Decode { kind: "PNG", problem };
    let limits = png::Limits { bytes: MOST_BYTES };
    let decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let mut reader = decoder.read_info().map_err(|e| wrong(e.to_string()))?;
    let info = reader.info();
    let size = [info.width, info.height];
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err(wrong("it is not of 8-bit red, green and blue".into()));
    }
    let len = reader.output_buffer_size().filter(|len| *len <= MOST_BYTES);
    let mut rgb = vec![0; len.ok_or_else(|| wrong("it is too large".into()))?];
    reader.next_frame(&mut rgb).map_err(|e| wrong(e.to_string()))?;
    Ok((size, rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_come_back() {
        let mut canvas = Canvas::new([64, 32], [40, 90, 200]).expect("fits");
        canvas.rectangle([0.0, 0.0], [32.0, 32.0], [220, 60, 20]);
        let jpeg = decode_jpeg(&canvas.to_jpeg(95).expect("encodes")).expect("decodes");
        assert_eq!(jpeg.size(), [64, 32]);
        for (at, want) in [([8, 16], [220, 60, 20]), ([56, 16], [40, 90, 200])] {
            let got = jpeg.pixel(at).expect("is inside");
            assert!((0..3).all(|k| got[k].abs_diff(want[k]) < 6), "{at:?}: {got:?}");
        }
        let (size, rgb) = decode_png(&canvas.to_png().expect("encodes")).expect("decodes");
        assert_eq!((size, rgb), ([64, 32], canvas.to_rgb()));
    }

    #[test]
    fn broken_images_are_errors() {
        let canvas = Canvas::new([64, 32], [1, 2, 3]).expect("fits");
        let (jpeg, png) = (canvas.to_jpeg(80).expect("encodes"), canvas.to_png().expect("encodes"));
        for len in [0, 1, 10, 40] {
            assert!(matches!(decode_jpeg(&jpeg[..len]), Err(PictureError::Decode { .. })), "{len}");
            assert!(matches!(decode_png(&png[..len]), Err(PictureError::Decode { .. })), "{len}");
        }
        assert!(decode_png(&jpeg).is_err() && decode_jpeg(&png).is_err());
    }
}
