//! Images in memory, and how large they may be.

use super::error::ImageError;

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

    pub(super) fn check(self, width: usize, height: usize) -> Result<[u32; 2], ImageError> {
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
    pub(super) fn of([width, height]: [u32; 2], rgb: Vec<u8>) -> Result<Self, ImageError> {
        if rgb.len() != 3 * width as usize * height as usize {
            return Err(ImageError::Pixels);
        }
        Ok(Self { width, height, rgb })
    }
}
