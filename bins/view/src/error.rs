//! Why something cannot be shown.

use std::io;
use std::path::PathBuf;

use arrow_schema::ArrowError;
use parquet::errors::ParquetError;

/// Why a store, a part of it or an excerpt cannot be shown.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ViewError {
    #[error("{0} is no store: it has no dataset.json (`convoy run --store {0}` makes one)")]
    NoDataset(PathBuf),
    #[error("port {0}: {1}")]
    Port(u16, io::Error),
    #[error(transparent)]
    Store(#[from] store::StoreError),
    #[error(transparent)]
    Scene(#[from] scene::SceneError),
    #[error(transparent)]
    Predictions(#[from] evaluation::EvaluationError),
    #[error("{file}: it has predictions for scene {scenes}, and none of these is in the store")]
    OtherScenes { file: PathBuf, scenes: String },
    #[error("{0}: results of nuScenes are not shown: predictions are one Parquet file (docs/evaluation.md)")]
    Results(PathBuf),
    #[error("no predictions are shown: start with --predictions FILE")]
    NoPredictions,
    #[error("{0}: {1}")]
    File(String, Unreadable),
    #[error("there is nothing here")]
    NoPage,
    #[error("there is no such scene")]
    NoScene,
    #[error("scene {0} has no log yet: make stage STAGE=simulate-and-log")]
    NoLog(String),
    #[error("the store has no such file")]
    NoFile,
    #[error("scene {scene} has no {what}")]
    NotInScene { scene: String, what: String },
    #[error("scene {scene} has no {agent}, but {}", known.join(", "))]
    NoAgent { scene: u32, agent: String, known: Vec<String> },
    #[error("scene {scene} has the frames 0..{frames}")]
    NoFrames { scene: u32, frames: u32 },
    #[error("none of {} has pictures of {camera}", agents.join(", "))]
    NoCamera { agents: Vec<String>, camera: String },
    #[error("{what} has every {rate}th frame only: let the excerpt begin at a multiple of {rate}")]
    Between { what: String, rate: u64 },
    #[error("the page would have {0:.1} MB without any point, and 15 MB are the limit: choose fewer {1}")]
    TooLarge(f64, &'static str),
    #[error("of lidar points less than one in {0} would fit: choose fewer frames, agents or cameras")]
    TooThin(usize),
}

/// Why a file's content is of no use.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unreadable {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Table(#[from] ParquetError),
    #[error(transparent)]
    Columns(#[from] ArrowError),
    #[error(transparent)]
    Archive(#[from] rawzip::Error),
    #[error("it has no {0}")]
    Lacks(&'static str),
    #[error("{0} has values of another type")]
    Type(&'static str),
}

/// For `map_err`: says which file or object it was.
pub(crate) fn of_place<E: Into<Unreadable>>(place: &str) -> impl Fn(E) -> ViewError + Copy {
    move |why| ViewError::File(place.to_owned(), why.into())
}
