//! The file of predictions.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::ops::Range;
use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::{Array, RecordBatch};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder, RowSelection,
};
use parquet::basic::Compression;
use schema::AgentId;

use crate::EvaluationError;
use crate::attribute::number_of_attribute;
use crate::boxes::{Solid, yaw_of};
use crate::class::BoxClass;
use crate::mode::Mode;
use crate::positioned::Positioned;
use crate::values::{Kind, floats, integers, lists};

/// A column of predictions, for `docs/schema.md`.
#[derive(Clone, Copy, Debug)]
pub struct ColumnDoc {
    /// Its name.
    pub name: &'static str,
    /// What it says, with its unit and frame.
    pub doc: &'static str,
    /// Whether it may be left out.
    pub optional: bool,
    kind: Kind,
}

impl ColumnDoc {
    /// Its type in words.
    #[must_use]
    pub fn type_name(&self) -> String {
        self.kind.name()
    }
}

macro_rules! column {
    ($name:literal, $kind:expr, $doc:literal) => {
        ColumnDoc { name: $name, doc: $doc, optional: false, kind: $kind }
    };
    ($name:literal, $kind:expr, $doc:literal, optional) => {
        ColumnDoc { optional: true, ..column!($name, $kind, $doc) }
    };
}

/// The columns of predictions: one row per box that was found.
pub const COLUMNS: [ColumnDoc; 11] = [
    column!("scene", Kind::Integer, "Number of the scene."),
    column!("frame", Kind::Integer, "Frame number."),
    column!("agent", Kind::Text, "The ego: for whom it was found, `vehicle_0`, `rsu_1`, ..."),
    column!(
        "mode",
        Kind::Text,
        "With whom the model worked together: `none`, `x2v`, `x2i` or `x2x`; each is scored by itself. Without this column all rows are of one model.",
        optional
    ),
    column!(
        "class",
        Kind::Text,
        "Detection class, as in `boxes`, or `trailer`; null in a row that only names a sample in which nothing was found: its score and box are null, too."
    ),
    column!("score", Kind::Float, "How sure it is: any finite number, the higher the surer."),
    column!("center_m", Kind::Floats(3), "Centre of the box in the world, m."),
    column!("size_m", Kind::Floats(3), "Length, width, height, m."),
    column!(
        "quaternion",
        Kind::Floats(4),
        "Orientation in the world: quaternion w, x, y, z, of any length but 0."
    ),
    column!(
        "velocity_mps",
        Kind::Floats(3),
        "Velocity in the world, m/s; null or NaN where it is not known.",
        optional
    ),
    column!(
        "attribute",
        Kind::Text,
        "nuScenes' attribute (`vehicle.moving`, `cycle.with_rider`, `pedestrian.standing`, ...); null or empty where it is not known.",
        optional
    ),
];

/// A row of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictionRow {
    /// Its number.
    pub row: usize,
    /// Frame number.
    pub frame: u32,
    /// The ego.
    pub agent: AgentId,
    /// With whom the model worked together.
    pub mode: Mode,
    /// What was found; none where the row only names a sample.
    pub found: Option<FoundBox>,
}

/// A box that was found, as the file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundBox {
    /// Its class.
    pub class: BoxClass,
    /// How sure it is.
    pub score: f64,
    /// The box.
    pub solid: Solid,
    /// Its attribute, where it is said: a number of [`schema::NUSCENES_ATTRIBUTES`].
    pub attribute: Option<u8>,
}

/// A Parquet file of predictions. Its rows are read scene by scene, so that memory holds those of a few
/// scenes.
#[derive(Debug)]
pub struct PredictionFile {
    path: String,
    file: Positioned,
    about: ArrowReaderMetadata,
    /// First row of each row group, and the end.
    groups: Vec<usize>,
    /// Rows of each scene.
    scenes: BTreeMap<u32, Vec<Range<usize>>>,
    modes: BTreeSet<Mode>,
}

impl PredictionFile {
    /// Opens a file and looks for where the rows of each scene are.
    ///
    /// # Errors
    /// It cannot be read, is no Parquet, has no rows, or a column is missing or has another type.
    pub fn open(path: &Path) -> Result<Self, EvaluationError> {
        let name = path.display().to_string();
        let fault = |problem: String| EvaluationError::Predictions { path: name.clone(), problem };
        let file = File::open(path).map_err(|e| fault(format!("cannot be read: {e}")))?;
        Self::of(file, name)
    }

    /// Looks likewise into a file that is open; `name` is what messages call it.
    pub(crate) fn of(file: File, name: String) -> Result<Self, EvaluationError> {
        let fault = |problem: String| EvaluationError::Predictions { path: name.clone(), problem };
        // What pyarrow, polars and others add to say of which of their own types a column is: all are read as
        // one.
        let file = Positioned::new(file).map_err(|e| fault(format!("cannot be read: {e}")))?;
        let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
        let about = ArrowReaderMetadata::load(&file, options)
            .map_err(|e| fault(format!("is no readable Parquet file: {e}")))?;
        for column in COLUMNS {
            match about.schema().field_with_name(column.name) {
                Err(_) if column.optional => {}
                Err(_) => {
                    let columns = COLUMNS.map(|c| c.name).join(", ");
                    let problem = format!("has no column `{}` (predictions have {columns})", column.name);
                    return Err(fault(problem));
                }
                Ok(found) if column.kind.is(found.data_type()) => {}
                Ok(found) => {
                    let (want, found) = (column.kind.name(), found.data_type());
                    return Err(fault(format!(
                        "column `{}` is of type {found}, expected {want}",
                        column.name
                    )));
                }
            }
        }
        let mut groups = vec![0];
        for group in about.metadata().row_groups() {
            groups.push(groups[groups.len() - 1] + group.num_rows() as usize);
            let packed = group.columns().iter().map(|c| c.compression());
            let is_read = |c: &Compression| {
                matches!(c, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_))
            };
            if let Some(other) = { packed }.find(|c| !is_read(c)) {
                let problem =
                    format!("is compressed by {other}: write it with compression=\"zstd\" or none at all");
                return Err(fault(problem));
            }
        }
        let (scenes, modes) = (BTreeMap::new(), BTreeSet::new());
        let mut opened = Self { path: name.clone(), file, about, groups, scenes, modes };
        opened.find_scenes()?;
        if opened.scenes.is_empty() {
            return Err(fault("has no rows: there is nothing to evaluate".into()));
        }
        Ok(opened)
    }

    /// The scenes that it has rows of.
    pub fn scenes(&self) -> impl Iterator<Item = u32> {
        self.scenes.keys().copied()
    }

    /// The modes that it has rows of.
    pub fn modes(&self) -> impl Iterator<Item = Mode> {
        self.modes.iter().copied()
    }

    /// Whether it says attributes.
    #[must_use]
    pub fn has_attributes(&self) -> bool {
        self.about.schema().field_with_name("attribute").is_ok()
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The rows of a scene, in the file's order; none of a scene that it has no rows of.
    ///
    /// # Errors
    /// It cannot be read, or a value cannot be.
    pub fn rows(&self, scene: u32) -> Result<Vec<PredictionRow>, EvaluationError> {
        let Some(ranges) = self.scenes.get(&scene) else { return Ok(Vec::new()) };
        let mut numbers = ranges.iter().cloned().flatten();
        let mut rows = Vec::with_capacity(ranges.iter().map(ExactSizeIterator::len).sum());
        for batch in self.batches(&COLUMNS.map(|c| c.name), ranges)? {
            let numbers: Vec<usize> = numbers.by_ref().take(batch.num_rows()).collect();
            self.rows_of(&batch, &numbers, &mut rows)?;
        }
        Ok(rows)
    }

    /// What is wrong with a row.
    pub(crate) fn fault(&self, row: usize, problem: &str) -> EvaluationError {
        EvaluationError::Predictions { path: self.path.clone(), problem: format!("row {row}: {problem}") }
    }

    fn find_scenes(&mut self) -> Result<(), EvaluationError> {
        let rows = self.groups[self.groups.len() - 1];
        let (mut row, mut scenes) = (0, BTreeMap::<u32, Vec<Range<usize>>>::new());
        for batch in self.batches(&["scene", "mode"], std::slice::from_ref(&(0..rows)))? {
            let numbers: Vec<usize> = (row..row + batch.num_rows()).collect();
            self.modes.extend(self.modes_of(&batch, &numbers)?);
            for scene in self.whole_numbers(&batch, "scene", &numbers)? {
                let ranges = scenes.entry(scene).or_default();
                match ranges.last_mut() {
                    Some(last) if last.end == row => last.end += 1,
                    _ => ranges.push(row..row + 1),
                }
                row += 1;
            }
        }
        self.scenes = scenes;
        Ok(())
    }

    /// Some columns of some rows; only the row groups that have one of them are opened.
    fn batches(&self, columns: &[&str], rows: &[Range<usize>]) -> Result<Vec<RecordBatch>, EvaluationError> {
        let fault = |e: String| EvaluationError::Predictions {
            path: self.path.clone(),
            problem: format!("is damaged: {e}"),
        };
        let mut groups = Vec::new();
        let mut wanted: Vec<Range<usize>> = Vec::new();
        let (mut skipped, mut next) = (0, 0);
        for (group, bounds) in self.groups.windows(2).enumerate() {
            while next < rows.len() && rows[next].end <= bounds[0] {
                next += 1;
            }
            let inside: Vec<_> = rows[next..]
                .iter()
                .take_while(|range| range.start < bounds[1])
                .map(|range| range.start.max(bounds[0]) - skipped..range.end.min(bounds[1]) - skipped)
                .collect();
            if inside.is_empty() {
                skipped += bounds[1] - bounds[0];
                continue;
            }
            groups.push(group);
            wanted.extend(inside);
        }
        let total = self.groups[self.groups.len() - 1] - skipped;
        let roots = self.about.parquet_schema().root_schema().get_fields();
        let own = (0..roots.len()).filter(|i| columns.contains(&roots[*i].name()));
        let mask = ProjectionMask::roots(self.about.parquet_schema(), own);
        let reader =
            ParquetRecordBatchReaderBuilder::new_with_metadata(self.file.clone(), self.about.clone())
                .with_row_groups(groups)
                .with_row_selection(RowSelection::from_consecutive_ranges(wanted.into_iter(), total))
                .with_projection(mask)
                .with_batch_size(1 << 14)
                .build()
                .map_err(|e| fault(e.to_string()))?;
        reader.collect::<Result<_, _>>().map_err(|e| fault(e.to_string()))
    }

    fn whole_numbers(
        &self,
        batch: &RecordBatch,
        name: &str,
        numbers: &[usize],
    ) -> Result<Vec<u32>, EvaluationError> {
        let array = self.column(batch, name)?;
        let values = integers(array).ok_or_else(|| self.other_type(name))?;
        let value = |(i, value): (usize, Option<u32>)| {
            let value = value.filter(|_| !array.is_null(i));
            value.ok_or_else(|| self.fault(numbers[i], &format!("`{name}` is no number of one")))
        };
        values.into_iter().enumerate().map(value).collect()
    }

    fn column<'a>(
        &self,
        batch: &'a RecordBatch,
        name: &str,
    ) -> Result<&'a arrow_array::ArrayRef, EvaluationError> {
        batch.column_by_name(name).ok_or_else(|| self.other_type(name))
    }

    fn other_type(&self, name: &str) -> EvaluationError {
        EvaluationError::Predictions {
            path: self.path.clone(),
            problem: format!("column `{name}` changes its type"),
        }
    }

    fn lists<const N: usize>(
        &self,
        batch: &RecordBatch,
        name: &str,
        numbers: &[usize],
    ) -> Result<Vec<[f64; N]>, EvaluationError> {
        let lists = lists::<N>(self.column(batch, name)?).ok_or_else(|| self.other_type(name))?;
        lists.map_err(|i| self.fault(numbers[i], &format!("`{name}` has not {N} numbers")))
    }

    fn rows_of(
        &self,
        batch: &RecordBatch,
        numbers: &[usize],
        rows: &mut Vec<PredictionRow>,
    ) -> Result<(), EvaluationError> {
        let frames = self.whole_numbers(batch, "frame", numbers)?;
        let scores = floats(self.column(batch, "score")?.as_ref()).ok_or_else(|| self.other_type("score"))?;
        let centers = self.lists::<3>(batch, "center_m", numbers)?;
        let sizes = self.lists::<3>(batch, "size_m", numbers)?;
        let turns = self.lists::<4>(batch, "quaternion", numbers)?;
        let velocities = match batch.column_by_name("velocity_mps") {
            Some(_) => Some(self.lists::<3>(batch, "velocity_mps", numbers)?),
            None => None,
        };
        let agents = self.texts(batch, "agent", numbers, "agent", |text| text?.parse().ok())?;
        let classes = self.texts(batch, "class", numbers, "detection class", |text| match text {
            None => Some(None),
            Some(text) => BoxClass::from_name(text).map(Some),
        })?;
        let modes = self.modes_of(batch, numbers)?;
        let attributes = self.attributes_of(batch, numbers)?;
        for (i, &row) in numbers.iter().enumerate() {
            let fault = |problem: &str| Err(self.fault(row, problem));
            let (frame, agent, mode) = (frames[i], agents[i], modes[i]);
            let Some(class) = classes[i] else {
                if !scores[i].is_nan() {
                    return fault(
                        "`class` is null, expected a detection class (or a null `score`, too, where nothing was found)",
                    );
                }
                rows.push(PredictionRow { row, frame, agent, mode, found: None });
                continue;
            };
            if !scores[i].is_finite() {
                return fault(&format!("`score` is {}, expected a finite number", scores[i]));
            }
            if !centers[i].iter().all(|v| v.is_finite()) {
                return fault(&format!("`center_m` is {:?}, expected finite numbers", centers[i]));
            }
            if !sizes[i].iter().all(|v| v.is_finite() && *v > 0.0) {
                return fault(&format!("`size_m` is {:?}, expected lengths above 0", sizes[i]));
            }
            let Some(yaw_rad) = yaw_of(turns[i]) else {
                return fault(&format!("`quaternion` is {:?}, which is no rotation", turns[i]));
            };
            let [vx, vy, _] = velocities.as_ref().map_or([f64::NAN; 3], |all| all[i]);
            if vx.is_infinite() || vy.is_infinite() {
                return fault("`velocity_mps` is infinite, expected numbers, or null where it is not known");
            }
            let solid = Solid { center_m: centers[i], size_m: sizes[i], yaw_rad, velocity_mps: [vx, vy] };
            let found = FoundBox { class, score: scores[i], solid, attribute: attributes[i] };
            rows.push(PredictionRow { row, frame, agent, mode, found: Some(found) });
        }
        Ok(())
    }

    fn modes_of(&self, batch: &RecordBatch, numbers: &[usize]) -> Result<Vec<Mode>, EvaluationError> {
        match batch.column_by_name("mode") {
            Some(_) => {
                self.texts(batch, "mode", numbers, "mode of cooperation", |text| Mode::from_name(text?))
            }
            None => Ok(vec![Mode::Unsaid; numbers.len()]),
        }
    }

    fn attributes_of(
        &self,
        batch: &RecordBatch,
        numbers: &[usize],
    ) -> Result<Vec<Option<u8>>, EvaluationError> {
        if batch.column_by_name("attribute").is_none() {
            return Ok(vec![None; numbers.len()]);
        }
        self.texts(batch, "attribute", numbers, "attribute of nuScenes", |text| match text {
            None | Some("") => Some(None),
            Some(text) => number_of_attribute(text).map(Some),
        })
    }

    /// Texts that stand for something; mostly the same one comes again and again.
    fn texts<T: Copy>(
        &self,
        batch: &RecordBatch,
        name: &str,
        numbers: &[usize],
        what: &str,
        read: impl Fn(Option<&str>) -> Option<T>,
    ) -> Result<Vec<T>, EvaluationError> {
        let texts = self.column(batch, name)?;
        let texts = texts.as_string_opt::<i32>().ok_or_else(|| self.other_type(name))?;
        let mut last: Option<(Option<&str>, T)> = None;
        let mut values = Vec::with_capacity(texts.len());
        for (i, text) in texts.iter().enumerate() {
            let value = match last {
                Some((known, value)) if known == text => value,
                _ => read(text).ok_or_else(|| {
                    let problem = match text {
                        Some(text) => format!("`{name}` is `{text}`, which is no {what}"),
                        None => format!("`{name}` is null, expected a {what}"),
                    };
                    self.fault(numbers[i], &problem)
                })?,
            };
            last = Some((text, value));
            values.push(value);
        }
        Ok(values)
    }
}
