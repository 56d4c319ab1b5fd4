//! Why predictions could not be evaluated.

use scene::SceneError;
use store::StoreError;

/// Predictions cannot be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// The store has not what is wanted of it, or it is damaged.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The store has not what is wanted of it, or it is damaged.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The file of predictions cannot be read, or says what cannot be.
    #[error("{path}: {problem}")]
    Predictions {
        /// The file.
        path: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// What a table of the store says cannot be.
    #[error(
        "scene {scene}, frame {frame}, {agent}: {problem} (run postprocess-valid for this scene again with --force)"
    )]
    Labels {
        /// The scene.
        scene: u32,
        /// The frame.
        frame: u32,
        /// The agent.
        agent: String,
        /// What is wrong.
        problem: String,
    },
    /// BEV masks of the store are not as they should be.
    #[error(
        "scene {scene}, frame {frame}, {agent}: {problem} (run bev-gt for this scene again with --force)"
    )]
    Masks {
        /// The scene.
        scene: u32,
        /// The frame.
        frame: u32,
        /// The agent.
        agent: String,
        /// What is wrong.
        problem: String,
    },
    /// What is asked for cannot be had.
    #[error("{0}")]
    Refused(String),
    /// A result cannot be written.
    #[error("{path}: cannot be written: {problem}")]
    Write {
        /// The file.
        path: String,
        /// The cause.
        problem: String,
    },
}
