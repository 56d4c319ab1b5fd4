//! What can go wrong with a store.

use std::io;

use crate::holder::Holder;

/// An error of the store, naming the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Writing failed, whatever was being written: the device is full, the quota used up, the disk broken,
    /// the folder not ours. No scene is to blame, so a stage stops here; worth another try once that is
    /// mended.
    #[error(
        "{path}: cannot {action}: {source} ({}, then run the same command again; nothing committed is lost)",
        remedy(source)
    )]
    Write {
        /// The file that could not be written.
        path: String,
        /// What was tried.
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// Reading failed. Where nobody answered, no scene is to blame, and it is worth another try.
    #[error("{path}: cannot {action}: {source}{}", if may_come_back(source) { AGAIN } else { "" })]
    Read {
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
    /// Two processes did the same stage of the same scene at once, from different inputs, configurations or
    /// code.
    #[error(
        "{path}: another process wrote other outputs of this stage at the same time; neither is kept (let one run end, then run the same command again)"
    )]
    Contested {
        /// The manifest that both wanted to write.
        path: String,
    },
    /// Somebody else works on the store, and the two do not go together.
    #[error(
        "{path}: held by {holder}; this is {work}: nothing was touched (run the same command again once that has ended, or give another --store)"
    )]
    Held {
        /// The place.
        path: String,
        /// Who.
        holder: Box<Holder>,
        /// What was to be done instead.
        work: String,
    },
    /// A service refuses, or cannot do what is asked for: for want of rights, of a bucket, of a condition.
    #[error(
        "{path}: cannot {action}: {problem} (mend that, or give another --store; nothing committed is lost)"
    )]
    Refused {
        /// What was asked for.
        path: String,
        /// What was tried.
        action: &'static str,
        /// Its answer, without anything secret.
        problem: String,
    },
    /// A place that breaks what a store rests on.
    #[error("{path}: cannot hold a store: {problem} (give another --store)")]
    Unfit {
        /// The place.
        path: String,
        /// Which check failed.
        problem: String,
    },
    /// There is nothing.
    #[error(
        "{path} is no store: it has neither dataset.json nor a plan (`convoy run --store {path}` makes one)"
    )]
    NoStore {
        /// The place.
        path: String,
    },
    /// A store of another layout version.
    #[error(
        "{path}: store format {found}, this program reads 1 to {expected} (use the Convoy that made the store, or a fresh store)"
    )]
    Format {
        /// The file that says so.
        path: String,
        /// Version found.
        found: u32,
        /// The newest that this program reads.
        expected: u32,
    },
    /// A text that names no place of storage we know.
    #[error(
        "store `{place}`: {problem}; a store is a folder, by its path or as file:///FOLDER, or s3://BUCKET/FOLDER, az://CONTAINER/FOLDER, gs://BUCKET/FOLDER"
    )]
    Place {
        /// The text.
        place: String,
        /// What is wrong.
        problem: String,
    },
}

/// What a user can do about a failed write.
fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "make room",
        io::ErrorKind::OutOfMemory => "give more memory",
        io::ErrorKind::InvalidFilename => "give a shorter --store, or shorter names",
        io::ErrorKind::FileTooLarge => "raise the limit on the size of files (`ulimit -f`)",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "make the store writable",
        kind if kind == io::ErrorKind::TimedOut || is_away(kind) => "see to the network or the service",
        _ => "see to the disk",
    }
}

/// What a user can do where nobody answered.
const AGAIN: &str =
    " (see to the network or the service, then run the same command again; nothing committed is lost)";

/// Whether a read that failed may succeed later.
fn may_come_back(error: &io::Error) -> bool {
    use io::ErrorKind as Kind;
    // ENFILE, EMFILE: the machine, or the process, has too many files open.
    let has_no_handle = error.raw_os_error().is_some_and(|code| [23, 24].contains(&code));
    let kind = error.kind();
    has_no_handle
        || matches!(kind, Kind::TimedOut | Kind::StaleNetworkFileHandle | Kind::OutOfMemory)
        || is_away(kind)
}

/// Whether who should answer could not be reached.
fn is_away(kind: io::ErrorKind) -> bool {
    use io::ErrorKind as Kind;
    matches!(
        kind,
        Kind::NotConnected
            | Kind::ConnectionRefused
            | Kind::ConnectionReset
            | Kind::ConnectionAborted
            | Kind::HostUnreachable
            | Kind::NetworkUnreachable
            | Kind::NetworkDown
    )
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
    /// A failed write.
    #[must_use]
    pub fn write(path: impl Into<String>, action: &'static str, source: io::Error) -> Self {
        Self::Write { path: path.into(), action, source }
    }

    /// An object that is too large to be what it should be.
    pub(crate) fn too_large(path: String, bytes: u64) -> Self {
        let problem = format!("has {bytes} bytes: no record is so large, nor any table that is read whole");
        Self::Corrupt { path, problem }
    }

    /// A failed read.
    #[must_use]
    pub fn read(path: impl Into<String>, action: &'static str, source: io::Error) -> Self {
        Self::Read { path: path.into(), action, source }
    }

    /// Whether another try may succeed without changing the command, and no scene is to blame.
    #[must_use]
    pub fn is_transient(&self) -> bool {
        match self {
            Self::Write { .. } => !self.is_usage(),
            Self::Contested { .. } | Self::Held { .. } => true,
            Self::Read { source, .. } => may_come_back(source),
            _ => false,
        }
    }

    /// Whether the command asks for something that cannot be had: another place, or another version of the
    /// program.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Format { .. }
            | Self::Place { .. }
            | Self::NoStore { .. }
            | Self::Refused { .. }
            | Self::Unfit { .. } => true,
            // A name or a path that no disk takes.
            Self::Read { source, .. } | Self::Write { source, .. } => {
                source.kind() == io::ErrorKind::InvalidFilename
            }
            _ => false,
        }
    }
}
