//! Why a picture cannot be drawn.

/// A picture cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// It is too large, or has no pixels.
    #[error("a picture of {0} x {1} pixels cannot be made")]
    Size(u32, u32),
    /// An image of a sensor is broken.
    #[error("the {kind} cannot be decoded: {problem}")]
    Decode {
        /// What was to be decoded.
        kind: &'static str,
        /// Why.
        problem: String,
    },
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
    /// A PNG cannot be encoded.
    #[error("cannot encode the PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// A JPEG cannot be encoded.
    #[error("cannot encode the JPEG: {0}")]
    Jpeg(#[from] jpeg_encoder::EncodingError),
}
