//! Why pictures could not be made.

use std::path::PathBuf;

use export_core::ExportError;
use pictures::PictureError;
use runner::{EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE};
use scene::SceneError;
use store::StoreError;

/// Pictures cannot be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum VizError {
    /// What is asked for cannot be had.
    #[error("{0}")]
    Refused(String),
    /// The store has not what is wanted of it, or it is damaged.
    #[error(transparent)]
    Source(#[from] ExportError),
    /// A picture cannot be drawn.
    #[error("{place}: {source}")]
    Picture {
        /// Which one.
        place: String,
        /// Why.
        source: PictureError,
    },
    /// An array of a scene is not as it should be.
    #[error("{path}: {problem} (run {stage} for this scene again with --force)")]
    Archive {
        /// The archive.
        path: String,
        /// What is wrong.
        problem: String,
        /// The program that made it.
        stage: &'static str,
    },
    /// A file cannot be written.
    #[error("{}: cannot write: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
}

impl VizError {
    /// The exit code, where it is known: what the user can correct, what another try may.
    pub(crate) fn exit_code(&self) -> Option<u8> {
        Some(match self {
            Self::Refused(_) | Self::Source(ExportError::Refused(_)) => EXIT_USAGE,
            Self::Source(ExportError::Store(e)) if e.is_usage() => EXIT_USAGE,
            Self::Picture { source: PictureError::NoColour { .. }, .. } => EXIT_USAGE,
            Self::Source(_) | Self::Picture { .. } | Self::Archive { .. } => EXIT_SOME_FAILED,
            Self::Write { .. } => EXIT_TRY_AGAIN,
        })
    }
}

impl From<SceneError> for VizError {
    fn from(fault: SceneError) -> Self {
        Self::Source(fault.into())
    }
}

impl From<StoreError> for VizError {
    fn from(fault: StoreError) -> Self {
        Self::Source(fault.into())
    }
}

/// Names the picture that could not be drawn.
pub(crate) trait Drawing<T> {
    /// At a place.
    fn drawing(self, place: impl FnOnce() -> String) -> Result<T, VizError>;
}

impl<T> Drawing<T> for Result<T, PictureError> {
    fn drawing(self, place: impl FnOnce() -> String) -> Result<T, VizError> {
        self.map_err(|source| VizError::Picture { place: place(), source })
    }
}
