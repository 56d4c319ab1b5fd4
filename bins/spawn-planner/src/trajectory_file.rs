//! A Parquet file of poses at 20 Hz.

use std::fs::File;
use std::path::Path;

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
use plan::{Track, TrackPose};
use schema::FRAME_PERIOD_S;

use crate::error::TrajectoryFault as Fault;

/// Times lie this near to that of a frame, seconds.
const EXACT_S: f64 = 1e-3;
/// Most rows of a file: some 5 GB of memory.
const MAX_ROWS: i64 = 20_000_000;
/// Frames are numbered within this.
const MAX_FRAME: i64 = 1_000_000;

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

/// The tracks of a file.
///
/// # Errors
/// It cannot be read, or is no table of poses.
pub(crate) fn read_file(path: &Path) -> Result<Vec<Track>, Fault> {
    let file = File::open(path).map_err(Fault::Unreadable)?;
    // What writers add to say of which of their own types a column is; dictionaries are read as their values.
    let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
    let about = ArrowReaderMetadata::load(&file, options).map_err(Fault::NoParquet)?;
    let rows = about.metadata().file_metadata().num_rows();
    if rows > MAX_ROWS {
        return Err(Fault::TooLong { rows, most: MAX_ROWS });
    }
    for packed in
        about.metadata().row_groups().iter().flat_map(|group| group.columns()).map(|c| c.compression())
    {
        if !matches!(packed, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_)) {
            return Err(Fault::Packed(packed));
        }
    }
    let has = |name: &str| about.schema().column_with_name(name).is_some();
    for name in ["actor", "x_m", "y_m", "yaw_rad"] {
        if !has(name) {
            return Err(Fault::NoColumn(name));
        }
    }
    match [has("frame"), has("time_s")] {
        [true, true] => return Err(Fault::FramesAndTimes),
        [false, false] => return Err(Fault::NeitherFramesNorTimes),
        _ => {}
    }
    let reader = ParquetRecordBatchReaderBuilder::new_with_metadata(file, about.clone())
        .build()
        .map_err(Fault::Damaged)?;
    let mut all = Columns::default();
    for batch in reader {
        let batch = batch.map_err(|e| Fault::Damaged(e.into()))?;
        all.add(&batch)?;
    }
    all.tracks()
}

impl Columns {
    fn add(&mut self, batch: &RecordBatch) -> Result<(), Fault> {
        self.actor.extend(required(texts(batch, "actor")?, "actor")?);
        if batch.column_by_name("time_s").is_some() {
            let first_row = self.frame.len();
            for (row, time_s) in required(numbers(batch, "time_s")?, "time_s")?.into_iter().enumerate() {
                let frame = (time_s / FRAME_PERIOD_S).round();
                let off_s = (frame * FRAME_PERIOD_S - time_s).abs();
                if !time_s.is_finite() || off_s >= EXACT_S {
                    return Err(Fault::Time { row: first_row + row, time_s });
                }
                self.frame.push(frame as i64);
            }
        } else {
            self.frame.extend(required(whole_numbers(batch, "frame")?, "frame")?);
        }
        // What is missing is found where scene, actor and frame are known.
        let measured = |name: &'static str| {
            Ok::<_, Fault>(numbers(batch, name)?.into_iter().map(|v| v.unwrap_or(f64::NAN)))
        };
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
    fn tracks(&self) -> Result<Vec<Track>, Fault> {
        let scene = |row: usize| self.scene.as_ref().map(|scenes| scenes[row]);
        let mut rows: Vec<usize> = (0..self.actor.len()).collect();
        rows.sort_by_key(|&row| (scene(row), &self.actor[row], self.frame[row]));
        let mut tracks: Vec<Track> = Vec::new();
        for same in rows.chunk_by(|&a, &b| scene(a) == scene(b) && self.actor[a] == self.actor[b]) {
            let first = same[0];
            let actor = self.actor[first].clone();
            let number = |n: i64| u32::try_from(n).map_err(|_| Fault::Scene { row: first, number: n });
            let scene = scene(first).map(number).transpose()?;
            let whose =
                format!("actor `{actor}`{}", scene.map_or(String::new(), |s| format!(" of scene {s}")));
            for pair in same.windows(2) {
                let [before, after] = [pair[0], pair[1]].map(|row| self.frame[row]);
                if after == before {
                    return Err(Fault::Twice { whose, frame: after });
                }
                if after != before + 1 {
                    return Err(Fault::Gap { whose, before, after });
                }
            }
            let outside = same
                .iter()
                .map(|&row| self.frame[row])
                .find(|frame| !(-MAX_FRAME..=MAX_FRAME).contains(frame));
            if let Some(frame) = outside {
                return Err(Fault::Frame { whose, frame });
            }
            let mut models = same.iter().filter_map(|&row| self.model.as_ref()?[row].as_ref());
            let model = models.next().cloned();
            if let Some(other) = models.find(|other| model.as_ref() != Some(*other)) {
                let (first, other) = (model.unwrap_or_default(), other.clone());
                return Err(Fault::TwoModels { whose, first, other });
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
            return Err(Fault::Empty);
        }
        Ok(tracks)
    }
}

/// Values that may not be missing.
fn required<T>(values: Vec<Option<T>>, name: &'static str) -> Result<Vec<T>, Fault> {
    let values: Option<Vec<T>> = values.into_iter().collect();
    values.ok_or(Fault::NoValue(name))
}

fn column<'a>(batch: &'a RecordBatch, name: &'static str) -> Result<&'a dyn Array, Fault> {
    batch.column_by_name(name).map(AsRef::as_ref).ok_or(Fault::NoColumn(name))
}

/// Numbers of any width.
fn numbers(batch: &RecordBatch, name: &'static str) -> Result<Vec<Option<f64>>, Fault> {
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
fn whole_numbers(batch: &RecordBatch, name: &'static str) -> Result<Vec<Option<i64>>, Fault> {
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
        other => return Err(Fault::Type { name, found: other.clone(), expected: "numbers" }),
    })
}

/// Texts.
fn texts(batch: &RecordBatch, name: &'static str) -> Result<Vec<Option<String>>, Fault> {
    let array = column(batch, name)?;
    match array.data_type() {
        DataType::Utf8 => Ok(array.as_string::<i32>().iter().map(|v| v.map(str::to_owned)).collect()),
        other => Err(Fault::Type { name, found: other.clone(), expected: "texts" }),
    }
}
