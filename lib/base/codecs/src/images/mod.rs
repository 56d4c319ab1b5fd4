//! PNG and JPEG: the one place where images are encoded and decoded.
//!
//! ```
//! use codecs::images::{Limits, Pixels, PngStyle, RgbImage, decode_png, encode_png};
//!
//! let rgb = [[200, 40, 40], [30, 60, 210]].concat();
//! let file = encode_png([2, 1], &Pixels::Rgb(&rgb), PngStyle::SMALL)?;
//! assert_eq!(decode_png(&file, Limits::SENSOR)?, RgbImage { width: 2, height: 1, rgb });
//! # Ok::<(), codecs::images::ImageError>(())
//! ```

mod animation;
mod jpeg;
mod png_file;
mod shrink;

pub use animation::AnimationWriter;
pub use jpeg::{Chroma, decode_jpeg, encode_jpeg, jpeg_size};
pub use png_file::{
    AnyImage, Pixels, PngRows, PngStyle, decode_any, decode_png, encode_png, png_size, write_grey_rows,
};
pub use shrink::shrink;

/// An image cannot be decoded or encoded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// It is no PNG, or a broken one.
    #[error("is no PNG that can be read: {0}")]
    Png(png::DecodingError),
    /// It is no JPEG, or a broken one.
    #[error("is no JPEG that can be read: {0}")]
    Jpeg(zune_jpeg::errors::DecodeErrors),
    /// It begins as neither a PNG nor a JPEG.
    #[error("is neither PNG nor JPEG")]
    Unknown,
    /// A side has no pixels, or too many.
    #[error("has {width} x {height} pixels, at most {most_px} along a side are possible")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Most pixels along a side.
        most_px: usize,
    },
    /// The decoded image takes more memory than it may.
    #[error("is too large")]
    TooLarge,
    /// Its pixels are of another kind.
    #[error("is a PNG of {color:?} with {depth:?} bits, expected red, green, blue of 8")]
    Kind {
        /// Channels that it has.
        color: png::ColorType,
        /// Bits of each.
        depth: png::BitDepth,
    },
    /// It has fewer pixels than its header says.
    #[error("has not as many pixels as it says")]
    Pixels,
    /// A PNG cannot be encoded.
    #[error("cannot be written as PNG: {0}")]
    EncodePng(#[from] png::EncodingError),
    /// A JPEG cannot be encoded.
    #[error("cannot be written as JPEG: {0}")]
    EncodeJpeg(#[from] jpeg_encoder::EncodingError),
}

/// How large an image that is decoded may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most pixels along a side.
    pub side_px: usize,
    /// Most memory for a decoded PNG, bytes.
    pub bytes: usize,
}

impl Limits {
    /// Images of sensors.
    pub const SENSOR: Self = Self { side_px: 1 << 14, bytes: 1 << 30 };

    /// Images of at most so many pixels along a side.
    #[must_use]
    pub const fn of_side(side_px: usize) -> Self {
        // Eight bytes a pixel, and as much for the decoder.
        Self { side_px, bytes: 16 * side_px * side_px }
    }

    fn check(self, width: usize, height: usize) -> Result<[u32; 2], ImageError> {
        let most_px = self.side_px;
        if width == 0 || height == 0 || width > most_px || height > most_px {
            return Err(ImageError::Size { width, height, most_px });
        }
        Ok([width as u32, height as u32])
    }
}

/// An image of 8-bit red, green and blue, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

impl RgbImage {
    fn of([width, height]: [u32; 2], rgb: Vec<u8>) -> Result<Self, ImageError> {
        if rgb.len() != 3 * width as usize * height as usize {
            return Err(ImageError::Pixels);
        }
        Ok(Self { width, height, rgb })
    }
}

#[cfg(test)]
mod tests;
