//! What can go wrong in making sensor readings.

/// A sensor reading could not be made.
#[derive(Debug, thiserror::Error)]
pub enum SensorError {
    /// There is no such camera, or its pictures are too large for their formats.
    #[error(transparent)]
    Camera(#[from] render::CameraError),
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
