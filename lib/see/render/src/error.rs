//! What can go wrong in looking.

/// A renderer could not answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A snapshot speaks of meshes that the renderer was never given.
    #[error(
        "a snapshot of {in_snapshot} meshes was placed over {prepared} prepared ones: prepare all of them first"
    )]
    Unprepared {
        /// Meshes that the snapshot lists.
        in_snapshot: usize,
        /// Meshes that were prepared.
        prepared: usize,
    },
    /// A renderer did not answer each question once.
    #[error("the renderer gave {answered} answers to {asked} questions")]
    Unanswered {
        /// Cameras or ray batches that were asked for.
        asked: usize,
        /// Those that were answered.
        answered: usize,
    },
    /// The device behind a renderer failed: it is lost, or its memory is full.
    #[error("the renderer's device failed")]
    Device(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// There is no such camera.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
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
}

/// Longest side of a picture, pixels.
pub(crate) const MAX_SIDE_PX: u32 = 16_384;
