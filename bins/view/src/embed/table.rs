//! Tables cut to some rows, columns and points.

use std::sync::Arc;

use arrow_array::builder::BooleanBuilder;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float32Type, Float64Type, Int32Type, UInt32Type};
use arrow_array::{Array, ArrayRef, Float32Array, ListArray, RecordBatch, UInt32Array, UInt64Array};
use arrow_buffer::OffsetBuffer;
use arrow_schema::{DataType, Schema};
use arrow_select::filter::filter_record_batch;
use arrow_select::take::take;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReaderBuilder, RowSelection, RowSelector};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::schema::types::ColumnPath;

use schema::ZERO_COLUMNS;
use schema::calibration::METADATA_KEY;

use crate::error::{Unreadable, ViewError, of_place};
use crate::object::Object;

/// Positions are multiples of this part of a metre.
const STEPS_PER_M: f32 = 128.0;
/// Intensities are multiples of this part of the greatest.
const INTENSITY_STEPS: f32 = 255.0;
/// Small files count more than time here.
const ZSTD_LEVEL: i32 = 15;

/// Which columns: those of these names that are there.
pub(super) type Columns = &'static [&'static str];

/// Which rows of a table.
#[derive(Debug)]
pub(super) struct Rows {
    /// The first frame and the one after the last; frames are counted from the first one then.
    pub(super) frames: Option<(u32, u32)>,
    /// Columns of text, and the words that may stand there.
    pub(super) words: Vec<(&'static str, Vec<String>)>,
}

/// Which points of a reading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    /// The first of so many stays, in the order of the table: beam by beam, by azimuth.
    pub(super) keep_one_in: usize,
}

type Reader = ParquetRecordBatchReaderBuilder<Object>;

fn open(object: &Object, columns: Columns) -> Result<Reader, ViewError> {
    let reader = Reader::try_new(object.clone()).map_err(of_place(&object.place))?;
    let fields = reader.schema().fields().iter().enumerate();
    let roots: Vec<usize> =
        fields.filter(|(_, f)| columns.contains(&f.name().as_str())).map(|(i, _)| i).collect();
    let mask = ProjectionMask::roots(reader.parquet_schema(), roots);
    Ok(reader.with_projection(mask))
}

/// At every how many frames a sensor's table has a row.
pub(super) fn every_n_frames(object: &Object) -> Result<u64, ViewError> {
    let reader = open(object, &[])?;
    let said = notes(&reader).into_iter().find(|note| note.key == METADATA_KEY).and_then(|note| note.value);
    let about = said.and_then(|said| serde_json::from_str::<serde_json::Value>(&said).ok());
    Ok(about.and_then(|a| a["every_n_frames"].as_u64()).filter(|&n| n > 0).unwrap_or(1))
}

/// What a table says of its sensor, and of columns that are no readings.
fn notes(reader: &Reader) -> Vec<KeyValue> {
    let notes = reader.metadata().file_metadata().key_value_metadata();
    let kept = |note: &&KeyValue| [METADATA_KEY, ZERO_COLUMNS].contains(&note.key.as_str());
    notes.into_iter().flatten().filter(kept).cloned().collect()
}

/// Some rows of a table as a table.
pub(super) fn rows(object: &Object, columns: Columns, rows: &Rows) -> Result<Vec<u8>, ViewError> {
    cut(object, columns, |batch| select(batch, rows))
}

/// Rows whose points (`x_m`, `y_m`) come near to some places, as a table.
pub(super) fn near(
    object: &Object,
    columns: Columns,
    places: &[[f64; 2]],
    radius_m: f64,
) -> Result<Vec<u8>, ViewError> {
    cut(object, columns, |batch| {
        let list = |name: &str| batch.column_by_name(name).and_then(|c| c.as_list_opt::<i32>().cloned());
        let (Some(x), Some(y)) = (list("x_m"), list("y_m")) else {
            return Err(Unreadable::Lacks("x_m and y_m"));
        };
        let mut kept = BooleanBuilder::new();
        for row in 0..batch.num_rows() {
            let (x, y) = (x.value(row), y.value(row));
            let (x, y) = (x.as_primitive::<Float64Type>().values(), y.as_primitive::<Float64Type>().values());
            let mut points = x.iter().zip(y);
            kept.append_value(points.any(|(x, y)| {
                places.iter().any(|place| {
                    let (dx, dy) = (x - place[0], y - place[1]);
                    dx * dx + dy * dy < radius_m * radius_m
                })
            }));
        }
        Ok(filter_record_batch(&batch, &kept.finish())?)
    })
}

/// Where agents are: x and y of the chosen rows.
pub(super) fn places(object: &Object, rows: &Rows) -> Result<Vec<[f64; 2]>, ViewError> {
    let mut places = Vec::new();
    let reader = open(object, &["frame", "agent", "xyz_m"])?.build().map_err(of_place(&object.place))?;
    for batch in reader {
        let batch = select(batch.map_err(of_place(&object.place))?, rows).map_err(of_place(&object.place))?;
        let xyz = batch.column_by_name("xyz_m").and_then(|c| c.as_fixed_size_list_opt().cloned());
        let xyz = xyz.ok_or_else(|| of_place(&object.place)(Unreadable::Lacks("xyz_m")))?;
        for row in 0..batch.num_rows() {
            let value = xyz.value(row);
            let values = value
                .as_primitive_opt::<Float64Type>()
                .ok_or_else(|| of_place(&object.place)(Unreadable::Type("xyz_m")))?;
            places.push([values.value(0), values.value(1)]);
        }
    }
    Ok(places)
}

fn cut(
    object: &Object,
    columns: Columns,
    choose: impl Fn(RecordBatch) -> Result<RecordBatch, Unreadable>,
) -> Result<Vec<u8>, ViewError> {
    let reader = open(object, columns)?.build().map_err(of_place(&object.place))?;
    let mut writer: Option<ArrowWriter<Vec<u8>>> = None;
    for batch in reader {
        let batch = choose(batch.map_err(of_place(&object.place))?).map_err(of_place(&object.place))?;
        let writer = match &mut writer {
            Some(writer) => writer,
            None => writer.insert(start(&batch.schema(), Vec::new()).map_err(of_place(&object.place))?),
        };
        writer.write(&batch).map_err(of_place(&object.place))?;
    }
    let writer = writer.ok_or_else(|| of_place(&object.place)(Unreadable::Lacks("rows")))?;
    writer.into_inner().map_err(of_place(&object.place))
}

fn select(batch: RecordBatch, rows: &Rows) -> Result<RecordBatch, Unreadable> {
    let mut kept = vec![true; batch.num_rows()];
    let mut columns: Vec<ArrayRef> = batch.columns().to_vec();
    if let (Some((first, last)), Ok(at)) = (rows.frames, batch.schema().index_of("frame")) {
        let frames = numbers(&columns[at])?;
        for (keep, frame) in kept.iter_mut().zip(&frames) {
            *keep &= (i64::from(first)..i64::from(last)).contains(frame);
        }
        let renumbered = frames.iter().map(|f| u32::try_from(f - i64::from(first)).unwrap_or(0));
        columns[at] = Arc::new(UInt32Array::from_iter_values(renumbered));
    }
    for (name, words) in &rows.words {
        let Some(column) = batch.column_by_name(name) else { continue };
        let column = column.as_string_opt::<i32>().ok_or(Unreadable::Type(name))?;
        for (row, keep) in kept.iter_mut().enumerate() {
            *keep &= words.iter().any(|word| word == column.value(row));
        }
    }
    let schema = batch.schema();
    let fields: Vec<_> = schema
        .fields()
        .iter()
        .zip(&columns)
        .map(|(field, column)| field.as_ref().clone().with_data_type(column.data_type().clone()))
        .collect();
    let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), columns)?;
    Ok(filter_record_batch(&batch, &kept.into())?)
}

fn numbers(column: &ArrayRef) -> Result<Vec<i64>, Unreadable> {
    if let Some(values) = column.as_primitive_opt::<UInt32Type>() {
        return Ok(values.values().iter().map(|&v| i64::from(v)).collect());
    }
    let values = column.as_primitive_opt::<Int32Type>().ok_or(Unreadable::Type("frame"))?;
    Ok(values.values().iter().map(|&v| i64::from(v)).collect())
}

/// The readings of a sensor at some frames, each in a row group of its own, their points thinned.
pub(super) fn readings(
    object: &Object,
    columns: Columns,
    (first, last): (u32, u32),
    every: u64,
    points: Option<Points>,
) -> Result<Vec<u8>, ViewError> {
    let reader = open(object, columns)?;
    let notes = notes(&reader);
    let total = usize::try_from(reader.metadata().file_metadata().num_rows()).unwrap_or(0);
    let row = |frame: u32| usize::try_from(u64::from(frame).div_ceil(every)).unwrap_or(usize::MAX).min(total);
    let (from, to) = (row(first), row(last));
    let selection = RowSelection::from(vec![RowSelector::skip(from), RowSelector::select(to - from)]);
    let reader =
        reader.with_row_selection(selection).with_batch_size(1).build().map_err(of_place(&object.place))?;
    let mut writer: Option<ArrowWriter<Vec<u8>>> = None;
    for batch in reader {
        let batch = batch.map_err(of_place(&object.place))?;
        let batch = match points {
            Some(points) => thinned(&batch, points),
            None => Ok(batch),
        };
        let rows = Rows { frames: Some((first, last)), words: Vec::new() };
        let batch = batch.and_then(|batch| select(batch, &rows)).map_err(of_place(&object.place))?;
        let writer = match &mut writer {
            Some(writer) => writer,
            None => writer.insert(start(&batch.schema(), notes.clone()).map_err(of_place(&object.place))?),
        };
        writer.write(&batch).and_then(|()| writer.flush()).map_err(of_place(&object.place))?;
    }
    let writer = writer.ok_or_else(|| of_place(&object.place)(Unreadable::Lacks("such frames")))?;
    writer.into_inner().map_err(of_place(&object.place))
}

/// A reading (one row of lists) with fewer points, and with numbers that pack well.
fn thinned(batch: &RecordBatch, points: Points) -> Result<RecordBatch, Unreadable> {
    let schema = batch.schema();
    let columns = batch.columns().iter().zip(schema.fields()).map(|(column, field)| {
        let (Some(list), DataType::List(item)) = (column.as_list_opt::<i32>(), field.data_type()) else {
            return Ok(Arc::clone(column));
        };
        let values = list.value(0);
        let kept = UInt64Array::from_iter_values((0..values.len() as u64).step_by(points.keep_one_in));
        let values = take(&values, &kept, None)?;
        let steps = if field.name() == "intensity" { INTENSITY_STEPS } else { STEPS_PER_M };
        let values: ArrayRef = match values.as_primitive_opt::<Float32Type>() {
            Some(numbers) => Arc::new(Float32Array::from_iter_values(
                numbers.values().iter().map(|v| (v * steps).round() / steps),
            )),
            None => values,
        };
        let offsets = OffsetBuffer::from_lengths([values.len()]);
        Ok(Arc::new(ListArray::new(Arc::clone(item), offsets, values, None)) as ArrayRef)
    });
    let columns = columns.collect::<Result<Vec<_>, Unreadable>>()?;
    Ok(RecordBatch::try_new(batch.schema(), columns)?)
}

fn start(schema: &Arc<Schema>, notes: Vec<KeyValue>) -> Result<ArrowWriter<Vec<u8>>, ParquetError> {
    let level = ZstdLevel::try_new(ZSTD_LEVEL)?;
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(level))
        .set_max_row_group_row_count(None);
    for field in schema.fields() {
        let (leaf, nested) = match field.data_type() {
            DataType::List(item) | DataType::FixedSizeList(item, _) => (item.data_type(), Some(item.name())),
            other => (other, None),
        };
        if matches!(leaf, DataType::Binary) {
            // Pictures are packed already, and no two are alike.
            let column = ColumnPath::from(field.name().as_str());
            properties = properties
                .set_column_dictionary_enabled(column.clone(), false)
                .set_column_compression(column, Compression::UNCOMPRESSED);
        }
        if !matches!(leaf, DataType::Float32 | DataType::Float64) {
            continue;
        }
        let mut names = vec![field.name().clone()];
        names.extend(nested.into_iter().flat_map(|item| ["list".to_owned(), item.clone()]));
        let column = ColumnPath::from(names);
        properties = properties
            .set_column_dictionary_enabled(column.clone(), false)
            .set_column_encoding(column, Encoding::BYTE_STREAM_SPLIT);
    }
    if !notes.is_empty() {
        properties = properties.set_key_value_metadata(Some(notes));
    }
    ArrowWriter::try_new(Vec::new(), Arc::clone(schema), Some(properties.build()))
}

#[cfg(test)]
mod tests {
    use arrow_array::StringArray;
    use arrow_array::types::UInt16Type;

    use std::path::Path;

    use super::*;

    /// Readings at frames 0, 2, 4: 5 points each, x = 10 frame + point, beside a column that is not asked
    /// for.
    fn lidar(path: &Path) {
        let floats = |values: Vec<Vec<f32>>| {
            ListArray::from_iter_primitive::<Float32Type, _, _>(
                values.into_iter().map(|v| Some(v.into_iter().map(Some))),
            )
        };
        let xs = [0.0, 20.0, 40.0].map(|from: f32| (0..5_u8).map(|i| from + f32::from(i) + 0.001).collect());
        let ids = (0..3).map(|_| Some((7..12_u16).map(Some)));
        let batch = RecordBatch::try_from_iter([
            ("frame", Arc::new(UInt32Array::from(vec![0, 2, 4])) as ArrayRef),
            ("x", Arc::new(floats(xs.into())) as ArrayRef),
            ("intensity", Arc::new(floats(vec![vec![0.1, 0.2, 0.3, 0.4, 0.5]; 3])) as ArrayRef),
            ("id", Arc::new(ListArray::from_iter_primitive::<UInt16Type, _, _>(ids)) as ArrayRef),
            ("ring", Arc::new(floats(vec![vec![0.0; 5]; 3])) as ArrayRef),
        ])
        .expect("is a table");
        let note = |key: &str, said: &str| KeyValue::new(key.to_owned(), said.to_owned());
        let notes = vec![note("sensor", r#"{"every_n_frames": 2}"#), note("zero_columns", r#"["ring"]"#)];
        let mut writer = start(&batch.schema(), notes).expect("starts");
        writer.write(&batch).expect("writes");
        std::fs::write(path, writer.into_inner().expect("ends")).expect("is written");
    }

    fn object(path: &Path) -> Object {
        let store = store::Store::open(path.parent().expect("lies in a folder")).expect("opens");
        let name = path.file_name().expect("has a name").to_str().expect("is UTF-8");
        Object::open(&store, name).expect("is read").expect("is there")
    }

    fn read(bytes: Vec<u8>, path: &Path) -> (RecordBatch, usize, Vec<String>) {
        std::fs::write(path, bytes).expect("is written");
        let reader = Reader::try_new(object(path)).expect("is a table");
        let said = notes(&reader).into_iter().filter_map(|note| note.value).collect();
        let groups = reader.metadata().num_row_groups();
        let batches: Vec<RecordBatch> = reader.build().expect("reads").map(|b| b.expect("reads")).collect();
        (arrow_select::concat::concat_batches(&batches[0].schema(), &batches).expect("joins"), groups, said)
    }

    fn floats(batch: &RecordBatch, name: &str, row: usize) -> Vec<f32> {
        let list = batch.column_by_name(name).expect("is there").as_list::<i32>().value(row);
        list.as_primitive::<Float32Type>().values().to_vec()
    }

    #[test]
    fn readings_are_thinned_and_counted_anew() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("LIDAR.parquet");
        lidar(&path);
        assert_eq!(every_n_frames(&object(&path)).expect("says"), 2);
        let columns: Columns = &["frame", "x", "intensity", "id", "y"];
        let bytes =
            readings(&object(&path), columns, (2, 5), 2, Some(Points { keep_one_in: 2 })).expect("is cut");
        let (batch, groups, said) = read(bytes, &path);
        // Frames 2 and 4 are 0 and 2 of the excerpt, each in a row group of its own.
        assert_eq!((batch.num_rows(), groups), (2, 2));
        assert_eq!(said, [r#"{"every_n_frames": 2}"#, r#"["ring"]"#]);
        assert_eq!(batch.column(0).as_primitive::<UInt32Type>().values(), &[0, 2]);
        assert!(batch.column_by_name("ring").is_none());
        // Points 0, 2, 4; a thousandth is less than half of 1/128 and goes.
        assert_eq!(floats(&batch, "x", 0), [20.0, 22.0, 24.0]);
        assert_eq!(floats(&batch, "x", 1), [40.0, 42.0, 44.0]);
        // 0.1, 0.3, 0.5 are 25.5, 76.5 and 127.5 of 255; halves are rounded away from zero as 32-bit numbers
        // have them.
        for (got, wanted) in floats(&batch, "intensity", 0).iter().zip([0.1, 0.3, 0.5]) {
            assert!(
                (got - wanted).abs() <= 0.5 / 255.0 + 1e-6
                    && (got * 255.0).fract().min(1.0 - (got * 255.0).fract()) < 1e-4,
                "{got}"
            );
        }
        let ids = batch.column_by_name("id").expect("is there").as_list::<i32>().value(1);
        assert_eq!(ids.as_primitive::<UInt16Type>().values(), &[7, 9, 11]);
    }

    #[test]
    fn rows_are_chosen_by_frame_and_word() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("agents.parquet");
        let batch = RecordBatch::try_from_iter([
            ("frame", Arc::new(UInt32Array::from(vec![0, 1, 1, 2])) as ArrayRef),
            ("agent", Arc::new(StringArray::from(vec!["a", "a", "b", "a"])) as ArrayRef),
        ])
        .expect("is a table");
        let mut writer = start(&batch.schema(), Vec::new()).expect("starts");
        writer.write(&batch).expect("writes");
        std::fs::write(&path, writer.into_inner().expect("ends")).expect("is written");
        let chosen = Rows { frames: Some((1, 3)), words: vec![("agent", vec!["a".into()])] };
        let (batch, _, _) = read(
            rows(&object(&path), &["frame", "agent"], &chosen).expect("is cut"),
            &folder.path().join("cut"),
        );
        assert_eq!(batch.column(0).as_primitive::<UInt32Type>().values(), &[0, 1]);
        assert_eq!(batch.column(1).as_string::<i32>().iter().flatten().collect::<Vec<_>>(), ["a", "a"]);
    }

    #[test]
    fn map_elements_near_a_place_stay() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("map.parquet");
        let doubles = |values: [Vec<f64>; 2]| {
            ListArray::from_iter_primitive::<Float64Type, _, _>(values.map(|v| Some(v.into_iter().map(Some))))
        };
        let batch = RecordBatch::try_from_iter([
            ("kind", Arc::new(StringArray::from(vec!["near", "far"])) as ArrayRef),
            ("x_m", Arc::new(doubles([vec![500.0, 103.0], vec![500.0, 104.1]])) as ArrayRef),
            ("y_m", Arc::new(doubles([vec![0.0, 3.9], vec![0.0, 4.0]])) as ArrayRef),
        ])
        .expect("is a table");
        let mut writer = start(&batch.schema(), Vec::new()).expect("starts");
        writer.write(&batch).expect("writes");
        std::fs::write(&path, writer.into_inner().expect("ends")).expect("is written");
        // (3, 3.9) is 4.92 away, (4.1, 4) 5.73.
        let bytes = near(&object(&path), &["kind", "x_m", "y_m"], &[[100.0, 0.0], [-900.0, 0.0]], 5.0)
            .expect("is cut");
        let (batch, _, _) = read(bytes, &folder.path().join("cut"));
        assert_eq!(batch.column(0).as_string::<i32>().iter().flatten().collect::<Vec<_>>(), ["near"]);
    }
}
