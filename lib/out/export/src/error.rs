//! Why an export ended early.

use std::io;
use std::path::PathBuf;

use scene::SceneError;
use store::StoreError;

/// An export cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The store has not what is wanted of it, or it is damaged.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The store has not what is wanted of it, or it is damaged.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// What is asked for cannot be had, or not in this layout.
    #[error("{0}")]
    Refused(String),
    /// Something in the store cannot be put into the layout.
    #[error("scene {scene}{}{}: {problem}", frame.map_or(String::new(), |f| format!(" frame {f}")), agent.as_ref().map_or(String::new(), |a| format!(" {a}")))]
    Content {
        /// The scene.
        scene: u32,
        /// The frame, if it is one's.
        frame: Option<u32>,
        /// The agent, if it is one's.
        agent: Option<String>,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The destination cannot be written.
    #[error("{}: cannot {action}: {source} (see to that, then run the same command again: what is finished is kept)", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// The destination cannot be read.
    #[error("{}: cannot {action}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// A signal came.
    #[error("stopped by a signal (run the same command again: what is finished is kept)")]
    Stopped,
}
