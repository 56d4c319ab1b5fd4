//! What can be wrong with a scene of a store.

use std::error::Error;

use store::StoreError;

/// A scene cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The store failed, or a shard is not as its manifest says.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// A stage has not made its part, or its manifest was not handed over.
    #[error("scene {scene}: {stage} is missing (run {stage} for this scene)")]
    NotMade {
        /// The scene.
        scene: u32,
        /// The stage.
        stage: &'static str,
    },
    /// An agent's name is none.
    #[error("{path}: {source}")]
    Agent {
        /// The file.
        path: String,
        /// What is wrong.
        source: schema::ParseAgentError,
    },
    /// A table has not one row for each agent and frame.
    #[error("{path}: has {found} rows, expected {agents} agents times {frames} frames")]
    Rows {
        /// The file.
        path: String,
        /// Rows found.
        found: usize,
        /// Agents of the scene.
        agents: usize,
        /// Frames of the scene.
        frames: u32,
    },
    /// A table that should be sorted by frame is not.
    #[error(
        "{path}: row {row} is of frame {frame}, after rows of later frames (run the stage again with --force)"
    )]
    Order {
        /// The file.
        path: String,
        /// Number of the row, from 0.
        row: usize,
        /// Its frame.
        frame: i64,
    },
    /// Two tables of boxes do not go together row by row.
    #[error("{path}: at frame {frame} its rows are not those of `boxes` (run the stage again with --force)")]
    Unlike {
        /// The file.
        path: String,
        /// The frame.
        frame: i64,
    },
    /// A sensor's table goes on with another frame, or ends.
    #[error("{path}: {}", match found {
        Some(found) => format!("has frame {found} where {expected} was expected"),
        None => format!("ends before frame {expected}"),
    })]
    Frame {
        /// The file.
        path: String,
        /// The frame that was wanted.
        expected: u32,
        /// The frame that stands there.
        found: Option<i64>,
    },
    /// A tile of the static world is not the one that the scene was simulated with.
    #[error("{path}: {problem} (run simulate-and-log for scene {scene} again with --force)")]
    Tile {
        /// The file.
        path: String,
        /// The scene.
        scene: u32,
        /// What is wrong.
        problem: &'static str,
    },
    /// An archive of arrays is broken.
    #[error("{path}: {}{source} (run {stage} for scene {scene} again with --force)", frame.map_or(String::new(), |f| format!("frame {f}: ")))]
    Array {
        /// The file.
        path: String,
        /// The scene.
        scene: u32,
        /// The frame, if one was being read.
        frame: Option<u32>,
        /// The stage that made it.
        stage: &'static str,
        /// What is wrong. Of any type: a program that reads no arrays is built without their format.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A sensor's table says nothing of the sensor.
    #[error("{path}: says nothing of the sensor's pose (run the stage again with --force)")]
    NoCalibration {
        /// The file.
        path: String,
    },
    /// What a sensor's table says of the sensor cannot be understood.
    #[error("{path}: what it says of the sensor cannot be understood: {source}")]
    Calibration {
        /// The file.
        path: String,
        /// Why.
        source: serde_json::Error,
    },
}
