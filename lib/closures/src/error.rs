//! What can be wrong with the sources.

use std::path::PathBuf;

/// The closures cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum ClosureError {
    /// A file cannot be read.
    #[error("{}: cannot read", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// A manifest or the lock file is no TOML.
    #[error("{}: is no TOML", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// Where and why.
        #[source]
        source: Box<toml::de::Error>,
    },
    /// A manifest says something that is not known here.
    #[error("{}: {problem}", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What.
        problem: String,
    },
    /// A dependency of a crate is not in the lock file.
    #[error("Cargo.lock: has no {dependency}, which {user} depends on")]
    Unlocked {
        /// The package.
        user: String,
        /// What it depends on.
        dependency: String,
    },
    /// A file imports all that a crate counted by file has: which of its files it uses cannot be told.
    #[error(
        "{file}: imports {path}, a whole vocabulary: name what it uses, so that changes of the rest leave stages done"
    )]
    Glob {
        /// The file.
        file: String,
        /// The import.
        path: String,
    },
}
