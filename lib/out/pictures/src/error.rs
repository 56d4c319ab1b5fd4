//! Why a picture cannot be drawn.

use codecs::images::ImageError;

/// A picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// It is too large, or has no pixels.
    #[error("a picture of {0} x {1} pixels cannot be made")]
    Size(u32, u32),
    /// An image cannot be decoded or encoded.
    #[error("the image {0}")]
    Image(#[from] ImageError),
    /// Arrays are not of the shape that they should have.
    #[error("{what}: {found} values, expected {expected}")]
    Shape {
        /// What they are.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// Points have not what they are to be coloured by.
    #[error("these points have no {by}: colour them by {others}")]
    NoColour {
        /// What they have not.
        by: &'static str,
        /// What they have.
        others: String,
    },
}
