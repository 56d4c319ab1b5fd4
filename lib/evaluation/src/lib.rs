#![doc = include_str!("../README.md")]

mod boxes;
mod error;
mod interpolation;
mod matching;
mod measures;
mod mode;
mod nuscenes;
mod predictions;
mod protocol;
mod run;
mod simbev2x;
mod targets;
mod values;
mod write;

pub use boxes::{Prediction, Solid, Target};
pub use error::EvaluationError;
pub use measures::Measure;
pub use mode::{Mode, Seen};
pub use nuscenes::{NuScenesClass, NuScenesScores, NuScenesTally, nuscenes_class};
pub use predictions::{COLUMNS, ColumnDoc, PredictionFile, PredictionRow};
pub use protocol::{Protocol, THRESHOLDS_M};
pub use run::{Evaluation, ModeScores, Plan, evaluate};
pub use simbev2x::{SimBev2xClass, SimBev2xScores, SimBev2xTally};
pub use write::write_measures;
