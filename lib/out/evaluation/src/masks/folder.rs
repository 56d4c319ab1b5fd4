//! The folder of predicted masks.

use std::fs::File;
use std::path::{Path, PathBuf};

use codecs::{Array, DType, NpzError, NpzReader, Scalar, frame_member};
use half::f16;
use schema::AgentId;

use super::tally::passed;
use crate::EvaluationError;
use crate::mode::Mode;

/// The types that scores may have, in words.
pub const SCORE_TYPES: &str = "float16, float32, float64 (0 to 1), uint8 (0 to 255) or bool";
/// The member that says how large cells are, m; the store's, where there is none.
const CELL: &str = "cell_m.npy";

/// A folder of archives `SCENE/AGENT.npz` (`0007/vehicle_0.npz`), or of one such folder for each mode of
/// cooperation (`x2x/0007/vehicle_0.npz`).
#[derive(Clone, Debug)]
pub struct MaskFolder {
    path: PathBuf,
    modes: Vec<Mode>,
}

impl MaskFolder {
    /// Looks which modes a folder has.
    ///
    /// # Errors
    /// It is no folder.
    pub fn open(path: &Path) -> Result<Self, EvaluationError> {
        if !path.is_dir() {
            return Err(EvaluationError::Predictions {
                path: path.display().to_string(),
                problem: "is no folder of masks (SCENE/AGENT.npz, such as 0007/vehicle_0.npz)".into(),
            });
        }
        let has = |mode: &Mode| path.join(mode.name()).is_dir();
        let mut modes: Vec<Mode> = Mode::ALL.into_iter().skip(1).filter(has).collect();
        if modes.is_empty() {
            modes.push(Mode::Unsaid);
        }
        Ok(Self { path: path.to_owned(), modes })
    }

    /// The modes that it has masks of.
    #[must_use]
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Opens the archive of an ego; its masks have `classes` channels of at most `cells` cells a side.
    pub(crate) fn archive(
        &self,
        mode: Mode,
        (scene, agent): (u32, AgentId),
        (classes, cells): (usize, usize),
    ) -> Result<MaskArchive, EvaluationError> {
        let folder = if mode == Mode::Unsaid { self.path.clone() } else { self.path.join(mode.name()) };
        let path = folder.join(format!("{scene:04}")).join(format!("{agent}.npz"));
        let name = path.display().to_string();
        let fault = |problem: String| EvaluationError::Predictions { path: name.clone(), problem };
        let file = File::open(&path).map_err(|e| {
            fault(format!(
                "cannot be read: {e} (every ego that is evaluated needs its masks: choose with --scenes, --split, --agents)"
            ))
        })?;
        let archive = NpzReader::new(file).map_err(|e| fault(e.to_string()))?;
        // The widest type, and the longest header.
        let most = (classes * cells * cells * 8 + (1 << 16)) as u64;
        let mut opened =
            MaskArchive { path: name.clone(), archive: archive.with_max_bytes(most), cell_m: None };
        opened.cell_m = opened.read_cell_m()?;
        Ok(opened)
    }
}

/// The masks of an ego.
pub(crate) struct MaskArchive {
    path: String,
    archive: NpzReader<File>,
    /// How large its cells are, m, where it is said.
    pub(crate) cell_m: Option<f64>,
}

impl MaskArchive {
    /// What is wrong with the archive.
    pub(crate) fn fault(&self, problem: String) -> EvaluationError {
        EvaluationError::Predictions { path: self.path.clone(), problem }
    }

    fn read_cell_m(&mut self) -> Result<Option<f64>, EvaluationError> {
        if !self.archive.members().any(|name| name == CELL) {
            return Ok(None);
        }
        let array = self.archive.read(CELL).map_err(|e| self.fault(e.to_string()))?;
        let value = (array.shape.iter().product::<usize>() == 1).then(|| scores(&array)?.first().copied());
        match value.flatten().filter(|value| value.is_finite() && *value > 0.0) {
            Some(value) => Ok(Some(value)),
            None => Err(self.fault(format!("{CELL}: must be one float above 0: the side of a cell, m"))),
        }
    }

    /// How many thresholds the scores of a frame reach, `[classes, cells, cells]`, and how many cells a side
    /// has.
    pub(crate) fn passed(&mut self, frame: u32, classes: usize) -> Result<(Vec<u8>, usize), EvaluationError> {
        let member = frame_member(frame);
        let array = self.archive.read(&member).map_err(|e| match e {
            NpzError::NoMember { .. } => self.fault(format!(
                "has no {member}: frame {frame} is evaluated (choose fewer with --every, --agents, --scenes)"
            )),
            other => self.fault(other.to_string()),
        })?;
        let [channels, rows, columns] = array.shape[..] else {
            return Err(
                self.fault(format!("{member}: has shape {:?}, expected ({classes}, n, n)", array.shape))
            );
        };
        if channels != classes || rows != columns {
            let shape = &array.shape;
            return Err(self.fault(format!(
                "{member}: has shape {shape:?}, expected ({classes}, n, n): the store's classes"
            )));
        }
        let counts = match array.dtype {
            DType::Scalar(Scalar::Bool) => {
                Some(array.bytes.iter().map(|set| u8::from(*set != 0) * 9).collect())
            }
            DType::Scalar(Scalar::U8) => {
                let by_value: Vec<u8> =
                    (0..=255_u8).map(|v| passed(f32::from(v) / 255.0).unwrap_or_default()).collect();
                Some(array.bytes.iter().map(|v| by_value[usize::from(*v)]).collect())
            }
            _ => match scores(&array) {
                None => {
                    let found = array.dtype;
                    return Err(self.fault(format!("{member}: is of type {found:?}, expected {SCORE_TYPES}")));
                }
                Some(scores) => {
                    let all: Option<Vec<u8>> = scores.iter().map(|score| passed(*score as f32)).collect();
                    if all.is_none()
                        && let Some(at) = scores.iter().position(|score| passed(*score as f32).is_none())
                    {
                        let (class, row, column) = (at / (rows * columns), at / columns % rows, at % columns);
                        return Err(self.fault(format!(
                            "{member}: [{class}, {row}, {column}] is {}, expected a score from 0 to 1 (a sigmoid gives such)",
                            scores[at]
                        )));
                    }
                    all
                }
            },
        };
        Ok((counts.unwrap_or_default(), rows))
    }
}

/// Floats of any width; none where the array has others.
fn scores(array: &Array) -> Option<Vec<f64>> {
    fn all<const N: usize>(bytes: &[u8], of: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
        Some(bytes.as_chunks::<N>().0.iter().map(|chunk| of(*chunk)).collect())
    }
    match array.dtype {
        DType::Scalar(Scalar::F16) => all(&array.bytes, |b| f16::from_le_bytes(b).to_f64()),
        DType::Scalar(Scalar::F32) => all(&array.bytes, |b| f64::from(f32::from_le_bytes(b))),
        DType::Scalar(Scalar::F64) => all(&array.bytes, f64::from_le_bytes),
        _ => None,
    }
}
