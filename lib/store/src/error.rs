//! What can go wrong with a store.

use std::io;

/// An error of the store, naming the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The device is full or the quota is used up. Worth another try after making room.
    #[error(
        "{path}: no space left on the device (make room and run the same command again; nothing committed is lost)"
    )]
    Full {
        /// The file that could not be written.
        path: String,
    },
    /// Reading or writing failed.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What was tried.
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// A shard that a manifest names is not there.
    #[error(
        "{path}: missing, although a manifest names it (run `convoy verify`, then the stage with --force)"
    )]
    Missing {
        /// The file.
        path: String,
    },
    /// A shard is shorter or longer than its manifest says.
    #[error(
        "{path}: has {found} bytes, its manifest says {expected}: truncated or changed (run the stage again with --force)"
    )]
    Size {
        /// The file.
        path: String,
        /// Bytes in the manifest.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// A shard cannot be decoded.
    #[error("{path}: unreadable: {problem} (run `convoy verify`, then the stage with --force)")]
    Corrupt {
        /// The file.
        path: String,
        /// What is wrong.
        problem: String,
    },
    /// A stage writes the same shard twice in one try.
    #[error("{path}: two outputs of one stage have this name (give sensors and agents different names)")]
    Twice {
        /// The file.
        path: String,
    },
    /// A store of another layout version.
    #[error("{path}: store format {found}, this program reads and writes {expected} (use a fresh store)")]
    Format {
        /// The file that says so.
        path: String,
        /// Version found.
        found: u32,
        /// Version of this program.
        expected: u32,
    },
}

/// A damaged record counts as one that is not there: what it said is done again.
///
/// # Errors
/// All others.
pub(crate) fn sound<T>(record: Result<Option<T>, StoreError>) -> Result<Option<T>, StoreError> {
    match record {
        Err(StoreError::Corrupt { .. }) => Ok(None),
        other => other,
    }
}

impl StoreError {
    /// Wraps an I/O error; a full device gets its own variant.
    #[must_use]
    pub fn io(path: impl Into<String>, action: &'static str, source: io::Error) -> Self {
        let path = path.into();
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
                Self::Full { path }
            }
            _ => Self::Io { path, action, source },
        }
    }

    /// Whether another try may succeed without changing the command.
    #[must_use]
    pub fn is_transient(&self) -> bool {
        match self {
            Self::Full { .. } => true,
            Self::Io { source, .. } => {
                matches!(source.kind(), io::ErrorKind::TimedOut | io::ErrorKind::StaleNetworkFileHandle)
            }
            _ => false,
        }
    }
}
