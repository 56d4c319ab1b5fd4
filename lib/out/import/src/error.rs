//! What can go wrong with an import.

use std::path::{Path, PathBuf};

use store::StoreError;

/// A dataset cannot be imported, or a scene of it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// What was asked for cannot be: the folder is no dataset, the store holds something else. Nothing was
    /// written.
    #[error("{0}")]
    Refused(String),
    /// A file of the dataset is missing, broken, or says what no store can hold.
    #[error("{}: {place}{problem}", path.display())]
    Source {
        /// The file, or what the infos call it.
        path: PathBuf,
        /// Scene, agent, frame and place in the file, each followed by `: `; may be empty.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// The store cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Stopped by a signal.
    #[error("stopped: what is finished is kept; run the same command again")]
    Stopped,
}

impl ImportError {
    pub(crate) fn source(path: &Path, problem: impl std::fmt::Display) -> Self {
        Self::Source { path: path.to_owned(), place: String::new(), problem: problem.to_string() }
    }

    /// The same with where in the dataset it happened, before what is said already.
    #[must_use]
    pub(crate) fn within(self, what: impl std::fmt::Display) -> Self {
        match self {
            Self::Source { path, place, problem } => {
                Self::Source { path, place: format!("{what}: {place}"), problem }
            }
            other => other,
        }
    }
}
