//! Why an image cannot be decoded or encoded.

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
    #[error("is {width} x {height} pixels: at most {most_px} x {most_px} are possible")]
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
