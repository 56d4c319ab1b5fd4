//! Why there is no excerpt.

use std::path::PathBuf;

/// Why there is no excerpt.
#[derive(Debug, thiserror::Error)]
pub(crate) enum EmbedError {
    #[error("{path}: {why}")]
    Unreadable { path: PathBuf, why: String },
    #[error("{0}")]
    NoSuch(String),
    #[error("the page would have {0:.1} MB without any point, and 15 MB are the limit: choose fewer {1}")]
    TooLarge(f64, &'static str),
    #[error("of lidar points less than one in {0} would fit: choose fewer frames, agents or cameras")]
    TooThin(usize),
}
