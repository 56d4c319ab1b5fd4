//! What can go wrong in making sensor readings.

/// A sensor reading could not be made.
#[derive(Debug, thiserror::Error)]
pub enum SensorError {
    /// The picture has no pixels, or more columns or rows than its file formats hold.
    #[error("a picture of {width} x {height} pixels can't be made: 1 to {} pixels a side", MAX_SIDE_PX)]
    PictureSize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Intrinsics that no camera has.
    #[error(
        "a camera's focal lengths must be above 0 and its axis somewhere, not fx {fx}, fy {fy}, cx {cx}, cy {cy}"
    )]
    Intrinsics {
        /// Focal length in columns, pixels.
        fx: f64,
        /// Focal length in rows, pixels.
        fy: f64,
        /// Column of the axis.
        cx: f64,
        /// Row of the axis.
        cy: f64,
    },
    /// A lens that cannot make the picture.
    #[error("camera: {problem}")]
    Lens {
        /// What is wrong.
        problem: String,
    },
    /// A colour picture was asked for and nobody to paint it.
    #[error("colour pictures need a painter")]
    NoPainter,
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] render::RenderError),
    /// A scan pattern with more rays than a sweep can number.
    #[error("lidar: {problem}")]
    ScanPattern {
        /// What is wrong.
        problem: String,
    },
    /// The PNG encoder refused.
    #[error("PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The JPEG encoder refused.
    #[error("JPEG: {0}")]
    Jpeg(#[from] jpeg_encoder::EncodingError),
}

/// Longest side of a picture, pixels.
pub(crate) const MAX_SIDE_PX: u32 = 16_384;
