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
        problem: SourceFault,
    },
    /// The store cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Stopped by a signal.
    #[error("stopped: what is finished is kept; run the same command again")]
    Stopped,
}

/// What is wrong with a file of a dataset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SourceFault {
    /// It says what no store can hold.
    #[error("{0}")]
    Content(String),
    /// The same, of a part of it.
    #[error("{place}: {fault}")]
    At {
        /// The part.
        place: String,
        /// What is wrong there.
        fault: Box<Self>,
    },
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// It is a broken archive.
    #[error(transparent)]
    Archive(#[from] codecs::NpzError),
    /// It is a broken array, or holds a broken pickle.
    #[error(transparent)]
    Npy(#[from] crate::npy::NpyError),
    /// It is broken JSON.
    #[error(transparent)]
    Json(#[from] crate::json::JsonError),
    /// It is a broken list of scenes.
    #[error(transparent)]
    Index(#[from] crate::infos::IndexError),
    /// It is a broken picture.
    #[error(transparent)]
    Picture(#[from] codecs::images::ImageError),
}

impl SourceFault {
    /// The same, of a part of the file.
    #[must_use]
    pub(crate) fn at(self, place: impl std::fmt::Display) -> Self {
        Self::At { place: place.to_string(), fault: Box::new(self) }
    }
}

impl From<String> for SourceFault {
    fn from(problem: String) -> Self {
        Self::Content(problem)
    }
}

impl From<&str> for SourceFault {
    fn from(problem: &str) -> Self {
        Self::Content(problem.to_owned())
    }
}

impl ImportError {
    pub(crate) fn source(path: &Path, problem: impl Into<SourceFault>) -> Self {
        Self::Source { path: path.to_owned(), place: String::new(), problem: problem.into() }
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
