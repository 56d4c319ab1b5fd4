#![doc = include_str!("../README.md")]

mod boxes;
mod details;
mod error;
mod interpolation;
mod level;
mod masks;
mod matching;
mod measures;
mod mode;
mod nuscenes;
mod opv2v;
mod overlap;
mod pairs;
mod positioned;
mod predictions;
mod protocol;
mod results;
mod ring;
mod run;
mod sample;
mod simbev2x;
mod targets;
mod values;
mod write;

pub use boxes::{Prediction, SampleId, Sighting, Solid, Target};
pub use details::{ClassDetails, Details, Found};
pub use error::EvaluationError;
pub use level::{LEVELS, Level};
pub use masks::{
    Grid, GridError, MASK_THRESHOLDS, MaskClass, MaskEvaluation, MaskFolder, MaskMode, MaskScores, MaskTally,
    Misfit, SCORE_TYPES, evaluate_masks, passed,
};
pub use measures::Measure;
pub use mode::{Mode, SeenBy};
pub use nuscenes::{NuScenesClass, NuScenesScores, NuScenesTally, nuscenes_class};
pub use opv2v::{Opv2vScores, Opv2vTally, THRESHOLDS_IOU, is_opv2v_vehicle};
pub use overlap::bev_iou;
pub use pairs::{Paired, Sample, ScenePairs};
pub use predictions::{COLUMNS, ColumnDoc, PredictionFile, PredictionRow};
pub use protocol::{Protocol, THRESHOLDS_M};
pub use results::{ExportedSamples, read_results};
pub use ring::Ring;
pub use run::{Evaluation, ModeScores, Plan, evaluate};
pub use simbev2x::{SimBev2xClass, SimBev2xScores, SimBev2xTally};
pub use write::write_measures;
