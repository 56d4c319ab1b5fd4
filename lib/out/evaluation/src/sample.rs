//! The predictions of a scene, sample by sample.

use std::ops::Range;

use scene::SceneReader;
use schema::AgentId;

use crate::EvaluationError;
use crate::mode::Mode;
use crate::predictions::{PredictionFile, PredictionRow};

/// The rows that a file has of a scene, each of a frame and an agent that the scene has.
pub(crate) struct SceneRows {
    /// Number of the scene.
    pub(crate) number: u32,
    /// How many frames it has.
    pub(crate) frames: u32,
    /// It has boxes at frames 0, n, 2 n, ...
    pub(crate) labelled: u32,
    /// Its agents.
    pub(crate) agents: Vec<AgentId>,
    /// By agent, frame and mode; those of one sample and mode in the file's order.
    pub(crate) rows: Vec<PredictionRow>,
}

impl SceneRows {
    /// Reads them.
    pub(crate) fn read(scene: &SceneReader, file: &PredictionFile) -> Result<Self, EvaluationError> {
        let (info, agents, number) = (scene.info()?, scene.agents()?, scene.scene());
        let labelled = info.label_every_n_frames.max(1);
        let mut rows = file.rows(number)?;
        for row in &rows {
            let fault = |problem: String| Err(file.fault(row.row, &problem));
            if !agents.contains(&row.agent) {
                let there = agents.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
                return fault(format!("scene {number} has no agent `{}`; it has {there}", row.agent));
            }
            if row.frame >= info.frames {
                let last = info.frames.saturating_sub(1);
                return fault(format!(
                    "scene {number} has no frame {}; it has frames 0 to {last}",
                    row.frame
                ));
            }
            if !schema::rate::is_due(row.frame, labelled) {
                return fault(format!(
                    "scene {number} has no boxes at frame {}, only at every {labelled}th",
                    row.frame
                ));
            }
        }
        rows.sort_by_key(|row| (row.agent, row.frame, row.mode));
        Ok(Self { number, frames: info.frames, labelled, agents, rows })
    }
}

/// Rows of a sample and mode.
pub(crate) fn range_of(rows: &[PredictionRow], ego: AgentId, frame: u32, mode: Mode) -> Range<usize> {
    let key = (ego, frame, mode);
    let start = rows.partition_point(|row| (row.agent, row.frame, row.mode) < key);
    let length = rows[start..].iter().take_while(|row| (row.agent, row.frame, row.mode) == key).count();
    start..start + length
}
