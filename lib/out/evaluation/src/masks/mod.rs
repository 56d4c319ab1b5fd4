//! Predicted BEV masks against a store's: IoU by class, threshold and ring.

mod folder;
mod run;
mod tally;

pub use folder::{MaskFolder, SCORE_TYPES};
pub use run::{MaskEvaluation, MaskPlan, evaluate_masks};
pub use tally::{
    Grid, GridError, MASK_THRESHOLDS, MaskClass, MaskMode, MaskScores, MaskTally, Misfit, passed,
};
