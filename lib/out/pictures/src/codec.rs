//! Images of sensors as pixels.

use codecs::images::{self, Limits, RgbImage};

use crate::{Canvas, PictureError};

/// The pixels of a JPEG file.
///
/// # Errors
/// [`PictureError::Image`].
pub fn decode_jpeg(bytes: &[u8]) -> Result<Canvas, PictureError> {
    let RgbImage { width, height, rgb } = images::decode_jpeg(bytes, Limits::SENSOR)?;
    Canvas::from_rgb([width, height], &rgb)
}

/// The size and pixels of a PNG file of 8-bit red, green and blue: all that the sensors write.
///
/// # Errors
/// [`PictureError::Image`].
pub fn decode_png(bytes: &[u8]) -> Result<([u32; 2], Vec<u8>), PictureError> {
    let RgbImage { width, height, rgb } = images::decode_png(bytes, Limits::SENSOR)?;
    Ok(([width, height], rgb))
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
            assert!(matches!(decode_jpeg(&jpeg[..len]), Err(PictureError::Image(_))), "{len}");
            assert!(matches!(decode_png(&png[..len]), Err(PictureError::Image(_))), "{len}");
        }
        assert!(decode_png(&jpeg).is_err() && decode_jpeg(&png).is_err());
    }
}
