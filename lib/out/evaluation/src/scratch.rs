//! Boxes of nuScenes' files on their way into a temporary file of our own form.

use std::fs::File;
use std::sync::Arc;

use arrow_array::{ArrayRef, FixedSizeListArray, Float64Array, RecordBatch, StringArray, UInt32Array};
use arrow_schema::{DataType, Field};
use parquet::arrow::ArrowWriter;
use parquet::errors::ParquetError;

use crate::EvaluationError;
use crate::boxes::SampleId;
use crate::class::BoxClass;
use crate::predictions::PredictionFile;

/// So many rows are in memory at a time.
const BATCH_ROWS: usize = 1 << 14;

/// A box as nuScenes has it.
pub(crate) struct ForeignBox<'a> {
    pub(crate) class: BoxClass,
    pub(crate) score: f64,
    /// Its middle in the global frame, m.
    pub(crate) translation: [f64; 3],
    /// Width, length, height, m.
    pub(crate) size: [f64; 3],
    /// Quaternion w, x, y, z.
    pub(crate) rotation: [f64; 4],
    /// In the plane, m/s; NaN where it is not known.
    pub(crate) velocity: [f64; 2],
    /// Empty where it has none.
    pub(crate) attribute: &'a str,
}

/// Rows on their way into a temporary file of predictions, which has about a tenth of the size of the JSON
/// that they are from.
pub(crate) struct Scratch {
    writer: ArrowWriter<File>,
    file: File,
    columns: Columns,
    /// Why no more is written: no fault of what the boxes are from.
    failed: Option<ParquetError>,
}

/// Columns of predictions.
#[derive(Default)]
struct Columns {
    scenes: Vec<u32>,
    frames: Vec<u32>,
    agents: Vec<String>,
    classes: Vec<Option<&'static str>>,
    scores: Vec<Option<f64>>,
    centers: Vec<f64>,
    sizes: Vec<f64>,
    turns: Vec<f64>,
    velocities: Vec<f64>,
    attributes: Vec<String>,
}

impl Scratch {
    /// An empty one.
    pub(crate) fn new() -> Result<Self, EvaluationError> {
        Self::to(tempfile::tempfile().map_err(|e| unwritten(&e.to_string()))?)
    }

    fn to(file: File) -> Result<Self, EvaluationError> {
        let copy = file.try_clone().map_err(|e| unwritten(&e.to_string()))?;
        let mut columns = Columns::default();
        let batch = columns.take().map_err(|e| unwritten(&e.to_string()))?;
        let writer =
            ArrowWriter::try_new(copy, batch.schema(), None).map_err(|e| unwritten(&e.to_string()))?;
        Ok(Self { writer, file, columns, failed: None })
    }

    /// Adds a box of a sample; none names a sample that has no box. Where it cannot be written
    /// [`Scratch::finish`] says why.
    pub(crate) fn push(
        &mut self,
        sample: SampleId,
        found: Option<&ForeignBox<'_>>,
        global_from_world_m: [f64; 3],
    ) {
        let to = &mut self.columns;
        to.scenes.push(sample.scene);
        to.frames.push(sample.frame);
        to.agents.push(sample.ego.to_string());
        to.classes.push(found.map(|found| found.class.name()));
        to.scores.push(found.map(|found| found.score));
        if let Some(found) = found {
            to.centers.extend([0, 1, 2].map(|axis| found.translation[axis] - global_from_world_m[axis]));
            let [width, length, height] = found.size;
            to.sizes.extend([length, width, height]);
            to.turns.extend(found.rotation);
            let [vx, vy] = found.velocity;
            to.velocities.extend([vx, vy, 0.0]);
            to.attributes.push(found.attribute.to_owned());
        } else {
            to.centers.extend([f64::NAN; 3]);
            to.sizes.extend([f64::NAN; 3]);
            to.turns.extend([f64::NAN; 4]);
            to.velocities.extend([f64::NAN; 3]);
            to.attributes.push(String::new());
        }
        if to.scenes.len() == BATCH_ROWS {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let batch = self.columns.take();
        if self.failed.is_none() {
            self.failed = batch.and_then(|batch| self.writer.write(&batch)).err();
        }
    }

    /// The file; `name` is what messages call it.
    pub(crate) fn finish(mut self, name: String) -> Result<PredictionFile, EvaluationError> {
        self.flush();
        let closed = self.failed.map_or_else(|| self.writer.close().map(drop), Err);
        closed.map_err(|e| unwritten(&e.to_string()))?;
        PredictionFile::of(self.file, name)
    }
}

/// The temporary file cannot be written.
fn unwritten(problem: &str) -> EvaluationError {
    let path = std::env::temp_dir().display().to_string();
    EvaluationError::Write { path, problem: problem.to_owned() }
}

impl Columns {
    /// What is there, as a batch.
    fn take(&mut self) -> Result<RecordBatch, ParquetError> {
        let lists = |values: &mut Vec<f64>, length: i32| -> Result<ArrayRef, arrow_schema::ArrowError> {
            let item = Arc::new(Field::new("item", DataType::Float64, false));
            let values = Arc::new(Float64Array::from(std::mem::take(values)));
            Ok(Arc::new(FixedSizeListArray::try_new(item, length, values, None)?))
        };
        let columns = [
            ("scene", Arc::new(UInt32Array::from(std::mem::take(&mut self.scenes))) as ArrayRef),
            ("frame", Arc::new(UInt32Array::from(std::mem::take(&mut self.frames)))),
            ("agent", Arc::new(StringArray::from(std::mem::take(&mut self.agents)))),
            ("class", Arc::new(StringArray::from(std::mem::take(&mut self.classes)))),
            ("score", Arc::new(Float64Array::from(std::mem::take(&mut self.scores)))),
            ("center_m", lists(&mut self.centers, 3)?),
            ("size_m", lists(&mut self.sizes, 3)?),
            ("quaternion", lists(&mut self.turns, 4)?),
            ("velocity_mps", lists(&mut self.velocities, 3)?),
            ("attribute", Arc::new(StringArray::from(std::mem::take(&mut self.attributes)))),
        ];
        let may_be_null = |name: &str| matches!(name, "class" | "score");
        let columns = columns.map(|(name, values)| (name, values, may_be_null(name)));
        Ok(RecordBatch::try_from_iter_with_nullable(columns)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_no_fault_of_what_is_read() {
        let full = File::options().write(true).open("/dev/full").expect("Linux has one");
        let rows = Scratch::to(full).and_then(|mut rows| {
            let sample = SampleId { scene: 0, frame: 0, ego: "vehicle_0".parse().expect("is an agent") };
            (0..2 * BATCH_ROWS).for_each(|_| rows.push(sample, None, [0.0; 3]));
            rows.finish("results.json".into()).map(drop)
        });
        assert!(matches!(rows, Err(EvaluationError::Write { .. })), "{rows:?}");
    }
}
