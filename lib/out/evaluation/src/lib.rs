#![doc = include_str!("../README.md")]

mod annotations;
mod attribute;
mod boxes;
mod class;
mod details;
mod error;
mod exported;
mod extent;
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
mod resample;
mod result;
mod results;
mod ring;
mod run;
mod sample;
mod samples;
mod scratch;
mod simbev2x;
mod tally;
mod targets;
mod values;
mod write;

pub use annotations::read_annotations;
pub use boxes::{Prediction, SampleId, Sighting, Solid, Target};
pub use class::BoxClass;
pub use details::{ClassDetails, Details, Found};
pub use error::EvaluationError;
pub use exported::ExportedSamples;
pub use extent::Extent;
pub use level::{LEVELS, Level};
pub use masks::{
    Grid, GridError, MASK_THRESHOLDS, MaskClass, MaskEvaluation, MaskFolder, MaskMode, MaskPlan, MaskScores,
    MaskTally, Misfit, SCORE_TYPES, evaluate_masks, passed,
};
pub use measures::Measure;
pub use mode::{Mode, SeenBy};
pub use nuscenes::{NuScenesClass, NuScenesScores, NuScenesTally};
pub use opv2v::{Opv2vScores, Opv2vTally, THRESHOLDS_IOU};
pub use overlap::{bev_iou, volume_iou};
pub use pairs::{Paired, Sample, ScenePairs};
pub use predictions::{COLUMNS, ColumnDoc, FoundBox, PredictionFile, PredictionRow};
pub use protocol::{Protocol, THRESHOLDS_M, THRESHOLDS_VOLUME_IOU};
pub use resample::Spread;
pub use result::{Breakdown, Evaluation, ResultRow};
pub use results::read_results;
pub use ring::Ring;
pub use run::{Plan, evaluate};
pub use simbev2x::{SimBev2xClass, SimBev2xScores, SimBev2xTally};
pub use tally::{Counts, ModeScores};
pub use write::write_measures;
