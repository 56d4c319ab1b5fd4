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
mod error;
mod jpeg;
mod png_file;
mod rgb;
mod shrink;

pub use animation::AnimationWriter;
pub use error::ImageError;
pub use jpeg::{Chroma, decode_jpeg, encode_jpeg, jpeg_size};
pub use png_file::{
    AnyImage, Pixels, PngRows, PngStyle, decode_any, decode_png, encode_png, png_size, write_grey_rows,
};
pub use rgb::{Limits, RgbImage};
pub use shrink::shrink;

#[cfg(test)]
mod tests;
