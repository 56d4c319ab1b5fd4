//! Files that commands write, and how commands fail.

use std::path::{Path, PathBuf};

use indicatif::DecimalBytes;
use runner::{EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, OutputFile, StageError, report, say};

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    /// Something that the user can correct.
    #[error("{0}")]
    Usage(String),
    /// A file that was named cannot be read.
    #[error("{}: cannot read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// A file cannot be written: as with a store's, another try may succeed once there is room.
    #[error("{}: cannot write: {source}", path.display())]
    Write { path: PathBuf, source: std::io::Error },
    /// What a store or a file holds cannot be used; as stages say it.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// A town cannot be built.
    #[error("{name}: {source}")]
    Town { name: String, source: town::TownError },
}

impl Fault {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Town { .. } => EXIT_USAGE,
            Self::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound => EXIT_USAGE,
            Self::Read { .. } => EXIT_SOME_FAILED,
            Self::Write { .. } => EXIT_TRY_AGAIN,
            Self::Stage(error) => error.exit_code(),
        }
    }
}

/// Says what went wrong; the exit code.
pub(crate) fn exit_code(result: Result<(), Fault>) -> u8 {
    match result {
        Ok(()) => EXIT_DONE,
        Err(fault) => {
            tracing::error!("{}", report(&fault));
            fault.exit_code()
        }
    }
}

/// Writes a file and says so.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    save(path, bytes)?;
    say(&format!("{} ({})", path.display(), DecimalBytes(bytes.len() as u64)));
    Ok(())
}

/// Writes a file whole or not at all, making its folder where needed.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    OutputFile::save(path, bytes).map_err(|source| Fault::Write { path: path.to_owned(), source })
}
