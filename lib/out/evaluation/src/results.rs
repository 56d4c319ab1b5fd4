//! nuScenes' files of results, put into the form of our own predictions.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, FixedSizeListArray, Float64Array, RecordBatch, StringArray, UInt32Array};
use arrow_schema::{DataType, Field};
use parquet::arrow::ArrowWriter;
use schema::AgentId;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::EvaluationError;
use crate::attribute::number_of_attribute;
use crate::class::BoxClass;
use crate::predictions::PredictionFile;

/// So many rows are in memory at a time.
const BATCH_ROWS: usize = 1 << 14;

/// A sample: its scene, frame and ego.
type Sample = (u32, u32, AgentId);

/// What the samples of a nuScenes export are called, and where its global frames lie.
#[derive(Clone, Debug, Default)]
pub struct ExportedSamples {
    samples: BTreeMap<String, Sample>,
    /// By scene.
    global_from_world_m: BTreeMap<u32, [f64; 3]>,
}

/// A row of `cooperation.json`.
#[derive(Deserialize)]
struct Moment {
    scene: String,
    frame: u32,
    samples: BTreeMap<String, String>,
}

/// A row of `map.json`.
#[derive(Deserialize)]
struct Map {
    location: String,
    global_from_world_m: [f64; 3],
}

impl ExportedSamples {
    /// Reads `cooperation.json` and `map.json` of an export's versions: of the folder itself, or of those in
    /// it. `map_of` names the map of a scene.
    ///
    /// # Errors
    /// It is no export of ours, or a table cannot be read.
    pub fn read(folder: &Path, map_of: impl Fn(u32) -> Option<String>) -> Result<Self, EvaluationError> {
        let fault = |path: &Path, problem: String| EvaluationError::Predictions {
            path: path.display().to_string(),
            problem,
        };
        let mut versions = Vec::new();
        if folder.join("cooperation.json").is_file() {
            versions.push(folder.to_owned());
        } else {
            let entries =
                std::fs::read_dir(folder).map_err(|e| fault(folder, format!("cannot be read: {e}")))?;
            let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
            versions.extend(paths.filter(|path| path.join("cooperation.json").is_file()));
            versions.sort();
        }
        if versions.is_empty() {
            let problem =
                "has no VERSION/cooperation.json: it is no export to nuScenes (convoy export nuscenes)";
            return Err(fault(folder, problem.into()));
        }
        let mut all = Self::default();
        for version in versions {
            let path = version.join("map.json");
            let maps: Vec<Map> = table(&path)?;
            let path = version.join("cooperation.json");
            for Moment { scene, frame, samples } in table(&path)? {
                let number: u32 =
                    scene.parse().map_err(|_| fault(&path, format!("scene `{scene}` is no number")))?;
                for (agent, token) in samples {
                    let agent = agent.parse().map_err(|e| fault(&path, format!("{e}")))?;
                    all.samples.insert(token, (number, frame, agent));
                }
                if let Entry::Vacant(shift) = all.global_from_world_m.entry(number) {
                    let name = map_of(number).ok_or_else(|| {
                        let problem = "which the store has not finished: it is of another store";
                        fault(&path, format!("has scene {number}, {problem}"))
                    })?;
                    let map = maps.iter().find(|map| map.location == name);
                    let map = map.ok_or_else(|| {
                        fault(&path, format!("map.json has no map {name}, of scene {number}"))
                    })?;
                    shift.insert(map.global_from_world_m);
                }
            }
        }
        Ok(all)
    }
}

/// A table of an export.
fn table<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Vec<T>, EvaluationError> {
    let fault = |problem: String| EvaluationError::Predictions { path: path.display().to_string(), problem };
    let file = File::open(path).map_err(|e| fault(format!("cannot be read: {e}")))?;
    serde_json::from_reader(BufReader::new(file)).map_err(|e| fault(e.to_string()))
}

/// Reads a file of nuScenes' results (`meta`, `results` by sample token), box by box, into predictions of our
/// own form, which lie in a temporary file of about a tenth of its size.
///
/// # Errors
/// The file cannot be read, or a box or a sample in it is none; the temporary file cannot be written.
pub fn read_results(path: &Path, exported: &ExportedSamples) -> Result<PredictionFile, EvaluationError> {
    let name = path.display().to_string();
    let fault = |problem: String| EvaluationError::Predictions { path: name.clone(), problem };
    let file = File::open(path).map_err(|e| fault(format!("cannot be read: {e}")))?;
    let scratch = tempfile::tempfile().map_err(|e| EvaluationError::Write {
        path: std::env::temp_dir().display().to_string(),
        problem: e.to_string(),
    })?;
    let copy = scratch.try_clone().map_err(|e| fault(e.to_string()))?;
    let mut rows = Rows::new(copy).map_err(|e| fault(e.to_string()))?;
    let mut json = serde_json::Deserializer::from_reader(BufReader::with_capacity(1 << 20, file));
    let whole = Whole { exported, rows: &mut rows };
    whole.deserialize(&mut json).and_then(|()| json.end()).map_err(|e| {
        let hint =
            if e.is_syntax() { " (NaN is no JSON: write null for a velocity that is not known)" } else { "" };
        fault(format!("is no file of nuScenes' results: {e}{hint}"))
    })?;
    rows.finish().map_err(|e| fault(e.to_string()))?;
    PredictionFile::of(scratch, name)
}

/// The whole file.
struct Whole<'a> {
    exported: &'a ExportedSamples,
    rows: &'a mut Rows,
}

impl<'de> DeserializeSeed<'de> for Whole<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Whole<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with `meta` and `results`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut has_results = false;
        while let Some(key) = map.next_key::<String>()? {
            if key == "results" && !has_results {
                has_results = true;
                map.next_value_seed(Results { exported: self.exported, rows: self.rows })?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        if has_results { Ok(()) } else { Err(A::Error::missing_field("results")) }
    }
}

/// Boxes by sample.
struct Results<'a> {
    exported: &'a ExportedSamples,
    rows: &'a mut Rows,
}

impl<'de> DeserializeSeed<'de> for Results<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Results<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of lists of boxes by sample token")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut known = BTreeSet::new();
        while let Some(token) = map.next_key::<String>()? {
            let Some((&(scene, frame, agent), shift)) = self
                .exported
                .samples
                .get(&token)
                .and_then(|sample| Some((sample, self.exported.global_from_world_m.get(&sample.0)?)))
            else {
                return Err(A::Error::custom(format!("sample `{token}` is none of the export's")));
            };
            if !known.insert((scene, frame, agent)) {
                return Err(A::Error::custom(format!("sample `{token}` comes twice")));
            }
            let rows = &mut *self.rows;
            map.next_value_seed(Boxes { token: &token, sample: (scene, frame, agent), shift, rows })?;
        }
        Ok(())
    }
}

/// The boxes of a sample.
struct Boxes<'a> {
    token: &'a str,
    sample: Sample,
    shift: &'a [f64; 3],
    rows: &'a mut Rows,
}

impl<'de> DeserializeSeed<'de> for Boxes<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Boxes<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of boxes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let mut number = 0_usize;
        while let Some(found) = list.next_element::<ResultBox>()? {
            let fault = |problem: String| {
                A::Error::custom(format!("sample `{}`, box {number}: {problem}", self.token))
            };
            if found.sample_token.as_ref().is_some_and(|token| token != self.token) {
                return Err(fault("its `sample_token` is another".into()));
            }
            if let Some(problem) = found.fault() {
                return Err(fault(problem));
            }
            let class = BoxClass::from_name(&found.detection_name).ok_or_else(|| {
                fault(format!("`detection_name` is `{}`, which is no class", found.detection_name))
            })?;
            let pushed = self.rows.push(self.sample, Some((class, &found)), self.shift);
            pushed.map_err(|e| fault(e.to_string()))?;
            number += 1;
        }
        if number == 0 {
            let named = self.rows.push(self.sample, None, self.shift);
            named.map_err(|e| A::Error::custom(format!("sample `{}`: {e}", self.token)))?;
        }
        Ok(())
    }
}

/// A box as the devkit's `DetectionBox` has it.
#[derive(Deserialize)]
struct ResultBox {
    sample_token: Option<String>,
    translation: [f64; 3],
    /// Width, length, height.
    size: [f64; 3],
    rotation: [f64; 4],
    #[serde(default)]
    velocity: [Option<f64>; 2],
    detection_name: String,
    detection_score: f64,
    #[serde(default)]
    attribute_name: String,
}

impl ResultBox {
    /// What of it cannot be.
    fn fault(&self) -> Option<String> {
        if !self.size.iter().all(|side| *side > 0.0) {
            return Some(format!("`size` is {:?}, expected lengths above 0", self.size));
        }
        if !self.attribute_name.is_empty() && number_of_attribute(&self.attribute_name).is_none() {
            return Some(format!("`attribute_name` is `{}`, which is no attribute", self.attribute_name));
        }
        let norm: f64 = self.rotation.iter().map(|part| part * part).sum();
        (norm < 1e-12).then(|| format!("`rotation` is {:?}, which is no rotation", self.rotation))
    }
}

/// Rows on their way into a file of predictions.
struct Rows {
    writer: ArrowWriter<File>,
    columns: Columns,
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

impl Rows {
    fn new(file: File) -> Result<Self, parquet::errors::ParquetError> {
        let mut columns = Columns::default();
        let writer = ArrowWriter::try_new(file, columns.take()?.schema(), None)?;
        Ok(Self { writer, columns })
    }

    /// Adds a box of a sample; none names a sample in which nothing was found.
    fn push(
        &mut self,
        (scene, frame, agent): Sample,
        found: Option<(BoxClass, &ResultBox)>,
        global_from_world_m: &[f64; 3],
    ) -> Result<(), parquet::errors::ParquetError> {
        let to = &mut self.columns;
        to.scenes.push(scene);
        to.frames.push(frame);
        to.agents.push(agent.to_string());
        to.classes.push(found.map(|(class, _)| class.name()));
        to.scores.push(found.map(|(_, found)| found.detection_score));
        if let Some((_, found)) = found {
            to.centers.extend([0, 1, 2].map(|axis| found.translation[axis] - global_from_world_m[axis]));
            let [width, length, height] = found.size;
            to.sizes.extend([length, width, height]);
            to.turns.extend(found.rotation);
            let [vx, vy] = found.velocity.map(|v| v.unwrap_or(f64::NAN));
            to.velocities.extend([vx, vy, 0.0]);
            to.attributes.push(found.attribute_name.clone());
        } else {
            to.centers.extend([f64::NAN; 3]);
            to.sizes.extend([f64::NAN; 3]);
            to.turns.extend([f64::NAN; 4]);
            to.velocities.extend([f64::NAN; 3]);
            to.attributes.push(String::new());
        }
        if to.scenes.len() == BATCH_ROWS { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), parquet::errors::ParquetError> {
        let batch = self.columns.take()?;
        self.writer.write(&batch)
    }

    fn finish(mut self) -> Result<(), parquet::errors::ParquetError> {
        self.flush()?;
        self.writer.close().map(drop)
    }
}

impl Columns {
    /// What is there, as a batch.
    fn take(&mut self) -> Result<RecordBatch, parquet::errors::ParquetError> {
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
