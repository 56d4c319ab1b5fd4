//! Trajectories from outside: a Parquet file of poses at 20 Hz.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder,
};
use parquet::basic::Compression;
use plan::{Track, TrackFiles, TrackPose};
use runner::StageError;
use schema::FRAME_PERIOD_S;
use settings::stages::PlanSettings;

use crate::error::TrajectoryError;

/// Times lie this near to that of a frame, seconds.
const EXACT_S: f64 = 1e-3;
/// Most rows of a file: some 5 GB of memory.
const MAX_ROWS: i64 = 20_000_000;
/// Frames are numbered within this.
const MAX_FRAME: i64 = 1_000_000;

/// Digests of the files, as far as they are found.
pub(crate) fn digests(settings: &PlanSettings, folder: Option<&Path>) -> BTreeMap<String, String> {
    let of = |written: &str| {
        let bytes = std::fs::read(find(written, folder)?).ok()?;
        Some((format!("trajectories/{written}"), store::hash_bytes(&bytes)))
    };
    written(settings).filter_map(of).collect()
}

/// The files of all groups and editions.
fn written(settings: &PlanSettings) -> impl Iterator<Item = &str> {
    settings.all().into_iter().filter_map(|settings| settings.agents.trajectories.as_deref())
}

/// A file below the folder of maps, or from where the program runs.
fn find(written: &str, folder: Option<&Path>) -> Option<PathBuf> {
    let below = folder.map(|folder| folder.join(written));
    below.into_iter().chain([PathBuf::from(written)]).find(|path| path.is_file())
}

/// The tracks of all files.
///
/// # Errors
/// A file is missing, or is no table of poses.
pub(crate) fn read(settings: &PlanSettings, folder: Option<&Path>) -> Result<TrackFiles, StageError> {
    let mut files = TrackFiles::new();
    for written in written(settings) {
        if !files.contains_key(written) {
            let path = find(written, folder).ok_or_else(|| {
                StageError::usage(TrajectoryError::NotFound { written: written.to_owned() })
            })?;
            let fault = |problem: String| {
                StageError::usage(TrajectoryError::Bad { path: path.display().to_string(), problem })
            };
            let tracks = read_file(&path).map_err(fault)?;
            let moving: usize = tracks.iter().map(|track| track.poses.len()).sum();
            tracing::info!("{written}: {} actors, {moving} poses", tracks.len());
            files.insert(written.to_owned(), tracks);
        }
    }
    Ok(files)
}

/// Columns of a file, row by row.
#[derive(Default)]
struct Columns {
    scene: Option<Vec<i64>>,
    actor: Vec<String>,
    model: Option<Vec<Option<String>>>,
    frame: Vec<i64>,
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    z_m: Option<Vec<f64>>,
    yaw_rad: Vec<f64>,
    roll_rad: Option<Vec<f64>>,
    pitch_rad: Option<Vec<f64>>,
}

/// All columns that there may be.
const NAMES: &str =
    "actor, frame (or time_s), x_m, y_m, yaw_rad, and optionally scene, model, z_m, roll_rad, pitch_rad";

fn read_file(path: &Path) -> Result<Vec<Track>, String> {
    let file = File::open(path).map_err(|e| format!("cannot be read: {e}"))?;
    // What writers add to say of which of their own types a column is; dictionaries are read as their values.
    let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
    let about =
        ArrowReaderMetadata::load(&file, options).map_err(|e| format!("is no readable Parquet file: {e}"))?;
    let rows = about.metadata().file_metadata().num_rows();
    if rows > MAX_ROWS {
        return Err(format!("has {rows} rows, more than {MAX_ROWS}: split it by groups of scenes"));
    }
    for packed in
        about.metadata().row_groups().iter().flat_map(|group| group.columns()).map(|c| c.compression())
    {
        if !matches!(packed, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_)) {
            return Err(format!(
                "is compressed by {packed}: write it with compression=\"zstd\", \"snappy\" or none"
            ));
        }
    }
    let has = |name: &str| about.schema().column_with_name(name).is_some();
    for name in ["actor", "x_m", "y_m", "yaw_rad"] {
        if !has(name) {
            return Err(format!("has no column `{name}` (columns: {NAMES})"));
        }
    }
    if has("frame") == has("time_s") {
        let problem = if has("frame") {
            "both `frame` and `time_s`: leave one out"
        } else {
            "neither `frame` nor `time_s`"
        };
        return Err(format!("has {problem} (columns: {NAMES})"));
    }
    let reader = ParquetRecordBatchReaderBuilder::new_with_metadata(file, about.clone())
        .build()
        .map_err(|e| format!("is damaged: {e}"))?;
    let mut all = Columns::default();
    for batch in reader {
        let batch = batch.map_err(|e| format!("is damaged: {e}"))?;
        all.add(&batch)?;
    }
    all.tracks()
}

impl Columns {
    fn add(&mut self, batch: &RecordBatch) -> Result<(), String> {
        self.actor.extend(required(texts(batch, "actor")?, "actor")?);
        if batch.column_by_name("time_s").is_some() {
            let first_row = self.frame.len();
            for (row, time_s) in required(numbers(batch, "time_s")?, "time_s")?.into_iter().enumerate() {
                let frame = (time_s / FRAME_PERIOD_S).round();
                let off_s = (frame * FRAME_PERIOD_S - time_s).abs();
                if !time_s.is_finite() || off_s >= EXACT_S {
                    let row = first_row + row;
                    return Err(format!(
                        "row {row}: `time_s` is {time_s}, no multiple of {FRAME_PERIOD_S} s: resample to 20 Hz"
                    ));
                }
                self.frame.push(frame as i64);
            }
        } else {
            self.frame.extend(required(whole_numbers(batch, "frame")?, "frame")?);
        }
        // What is missing is found where scene, actor and frame are known.
        let measured =
            |name: &str| Ok::<_, String>(numbers(batch, name)?.into_iter().map(|v| v.unwrap_or(f64::NAN)));
        self.x_m.extend(measured("x_m")?);
        self.y_m.extend(measured("y_m")?);
        self.yaw_rad.extend(measured("yaw_rad")?);
        for (name, column) in
            [("z_m", &mut self.z_m), ("roll_rad", &mut self.roll_rad), ("pitch_rad", &mut self.pitch_rad)]
        {
            if batch.column_by_name(name).is_some() {
                column.get_or_insert_default().extend(measured(name)?);
            }
        }
        if batch.column_by_name("scene").is_some() {
            let scenes = required(whole_numbers(batch, "scene")?, "scene")?;
            self.scene.get_or_insert_default().extend(scenes);
        }
        if batch.column_by_name("model").is_some() {
            self.model.get_or_insert_default().extend(texts(batch, "model")?);
        }
        Ok(())
    }

    /// The rows of each actor by frame, which have to follow one another.
    fn tracks(&self) -> Result<Vec<Track>, String> {
        let scene = |row: usize| self.scene.as_ref().map(|scenes| scenes[row]);
        let mut rows: Vec<usize> = (0..self.actor.len()).collect();
        rows.sort_by_key(|&row| (scene(row), &self.actor[row], self.frame[row]));
        let mut tracks: Vec<Track> = Vec::new();
        for same in rows.chunk_by(|&a, &b| scene(a) == scene(b) && self.actor[a] == self.actor[b]) {
            let first = same[0];
            let actor = self.actor[first].clone();
            let number = |n: i64| u32::try_from(n).map_err(|_| format!("row {first}: `scene` is {n}"));
            let scene = scene(first).map(number).transpose()?;
            let whose =
                format!("actor `{actor}`{}", scene.map_or(String::new(), |s| format!(" of scene {s}")));
            for pair in same.windows(2) {
                let [before, after] = [pair[0], pair[1]].map(|row| self.frame[row]);
                if after == before {
                    return Err(format!("{whose} has frame {after} twice"));
                }
                if after != before + 1 {
                    return Err(format!("{whose} has no frame {}: after {before} comes {after}", before + 1));
                }
            }
            let outside = same
                .iter()
                .map(|&row| self.frame[row])
                .find(|frame| !(-MAX_FRAME..=MAX_FRAME).contains(frame));
            if let Some(frame) = outside {
                return Err(format!("{whose} has a frame {frame}"));
            }
            let mut models = same.iter().filter_map(|&row| self.model.as_ref()?[row].as_ref());
            let model = models.next().cloned();
            if let Some(other) = models.find(|other| model.as_ref() != Some(*other)) {
                return Err(format!("{whose} has two models, `{}` and `{other}`", model.unwrap_or_default()));
            }
            let pose = |&row: &usize| TrackPose {
                xy_m: [self.x_m[row], self.y_m[row]],
                z_m: self.z_m.as_ref().map(|z| z[row]),
                yaw_rad: self.yaw_rad[row],
                roll_rad: self.roll_rad.as_ref().map(|roll| roll[row]),
                pitch_rad: self.pitch_rad.as_ref().map(|pitch| pitch[row]),
            };
            let first_frame = self.frame[first] as i32;
            tracks.push(Track { scene, actor, model, first_frame, poses: same.iter().map(pose).collect() });
        }
        if tracks.is_empty() {
            return Err("has no rows".into());
        }
        Ok(tracks)
    }
}

/// Values that may not be missing.
fn required<T>(values: Vec<Option<T>>, name: &str) -> Result<Vec<T>, String> {
    let values: Option<Vec<T>> = values.into_iter().collect();
    values.ok_or_else(|| format!("column `{name}` has rows without a value"))
}

fn column<'a>(batch: &'a RecordBatch, name: &str) -> Result<&'a dyn Array, String> {
    batch.column_by_name(name).map(AsRef::as_ref).ok_or_else(|| format!("has no column `{name}`"))
}

/// Numbers of any width.
fn numbers(batch: &RecordBatch, name: &str) -> Result<Vec<Option<f64>>, String> {
    let array = column(batch, name)?;
    match array.data_type() {
        DataType::Float64 => Ok(array.as_primitive::<Float64Type>().iter().collect()),
        DataType::Float32 => {
            Ok(array.as_primitive::<Float32Type>().iter().map(|v| v.map(f64::from)).collect())
        }
        _ => Ok(whole_numbers(batch, name)?.into_iter().map(|v| v.map(|v| v as f64)).collect()),
    }
}

/// Whole numbers of any width.
fn whole_numbers(batch: &RecordBatch, name: &str) -> Result<Vec<Option<i64>>, String> {
    let array = column(batch, name)?;
    macro_rules! of {
        ($type:ty) => {
            array.as_primitive::<$type>().iter().map(|v| v.and_then(|v| i64::try_from(v).ok())).collect()
        };
    }
    Ok(match array.data_type() {
        DataType::Int8 => of!(Int8Type),
        DataType::Int16 => of!(Int16Type),
        DataType::Int32 => of!(Int32Type),
        DataType::Int64 => of!(Int64Type),
        DataType::UInt8 => of!(UInt8Type),
        DataType::UInt16 => of!(UInt16Type),
        DataType::UInt32 => of!(UInt32Type),
        DataType::UInt64 => of!(UInt64Type),
        // As some writers have whole numbers of which one was missing once.
        DataType::Float32 | DataType::Float64 => {
            let whole = |v: f64| (v.fract() == 0.0 && v.abs() < 9e15).then_some(v as i64);
            numbers(batch, name)?.into_iter().map(|v| v.and_then(whole)).collect()
        }
        other => return Err(format!("column `{name}` is of type {other}, expected numbers")),
    })
}

/// Texts.
fn texts(batch: &RecordBatch, name: &str) -> Result<Vec<Option<String>>, String> {
    let array = column(batch, name)?;
    match array.data_type() {
        DataType::Utf8 => Ok(array.as_string::<i32>().iter().map(|v| v.map(str::to_owned)).collect()),
        other => Err(format!("column `{name}` is of type {other}, expected texts")),
    }
}
