//! Files of predictions: good ones in the types that others write, and bad ones.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::types::Float32Type;
use arrow_array::{
    Array, ArrayRef, FixedSizeListArray, Float32Array, Float64Array, Int64Array, ListArray, RecordBatch,
    StringArray, UInt32Array,
};
use arrow_schema::{DataType, Field};
use evaluation::{BoxClass, Mode, PredictionFile};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use schema::AgentId;

/// Lists of as many numbers as each of some rows has.
fn lists<const N: usize>(rows: &[[f64; N]]) -> ArrayRef {
    let values: Float64Array = rows.iter().flatten().copied().collect();
    let item = Arc::new(Field::new("item", DataType::Float64, true));
    Arc::new(FixedSizeListArray::try_new(item, N as i32, Arc::new(values), None).expect("is a list"))
}

/// Three predictions, of scenes 4, 2 and 4.
fn good() -> Vec<(&'static str, ArrayRef)> {
    vec![
        ("scene", Arc::new(UInt32Array::from(vec![4, 2, 4])) as ArrayRef),
        ("frame", Arc::new(Int64Array::from(vec![10, 20, 30]))),
        ("agent", Arc::new(StringArray::from(vec!["vehicle_0", "rsu_1", "vehicle_0"]))),
        ("class", Arc::new(StringArray::from(vec!["car", "bus", "car"]))),
        ("score", Arc::new(Float32Array::from(vec![0.5, 0.25, 1.0]))),
        ("center_m", lists(&[[1.0, 2.0, 3.0]; 3])),
        ("size_m", lists(&[[4.0, 2.0, 1.5]; 3])),
        ("quaternion", lists(&[[1.0, 0.0, 0.0, 0.0]; 3])),
        ("velocity_mps", lists(&[[1.0, f64::NAN, 0.0]; 3])),
        ("something else", Arc::new(StringArray::from(vec!["a", "b", "c"]))),
    ]
}

fn write(folder: &Path, columns: Vec<(&'static str, ArrayRef)>, compression: Compression) -> PathBuf {
    let path = folder.join("predictions.parquet");
    let batch = RecordBatch::try_from_iter_with_nullable(
        columns.into_iter().map(|(name, values)| (name, values, true)),
    );
    let batch = batch.expect("is a table");
    // A row group for every two rows.
    let properties =
        WriterProperties::builder().set_compression(compression).set_max_row_group_row_count(Some(2)).build();
    let file = File::create(&path).expect("is created");
    let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(properties)).expect("is a schema");
    writer.write(&batch).expect("is written");
    writer.close().expect("is closed");
    path
}

#[test]
fn rows_are_found_scene_by_scene() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write(folder.path(), good(), Compression::ZSTD(Default::default()));
    let file = PredictionFile::open(&path).expect("is good");
    assert_eq!(file.scenes().collect::<Vec<_>>(), [2, 4]);
    assert_eq!(file.modes().collect::<Vec<_>>(), [Mode::Unsaid]);
    let rows = file.rows(4).expect("are good");
    let car = BoxClass::from_name("car").expect("is a class");
    let facts = |i: usize| {
        let found = rows[i].found.expect("has a box");
        ((rows[i].row, rows[i].frame, rows[i].agent), found.class, found.score)
    };
    assert_eq!(facts(0), ((0, 10, AgentId::vehicle(0)), car, 0.5));
    assert_eq!(facts(1), ((2, 30, AgentId::vehicle(0)), car, 1.0));
    assert!(rows.len() == 2 && rows[0].found.is_some_and(|found| found.solid.velocity_mps[1].is_nan()));
    let other = file.rows(2).expect("are good");
    assert_eq!((other.len(), other[0].row, other[0].agent), (1, 1, AgentId::rsu(1)));
    assert_eq!(file.rows(3).expect("there are none"), []);
}

#[test]
fn lists_of_any_kind_and_modes_are_read() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut columns = good();
    let sizes = (0..3).map(|_| Some([4.0_f32, 2.0, 1.5].map(Some)));
    columns[6].1 = Arc::new(ListArray::from_iter_primitive::<Float32Type, _, _>(sizes));
    columns[8] = ("mode", Arc::new(StringArray::from(vec!["x2x", "none", "x2x"])));
    let path = write(folder.path(), columns, Compression::UNCOMPRESSED);
    let file = PredictionFile::open(&path).expect("is good");
    assert_eq!(file.modes().collect::<Vec<_>>(), [Mode::None, Mode::X2x]);
    let rows = file.rows(4).expect("are good");
    let solid = rows[0].found.expect("has a box").solid;
    assert!(rows[1].mode == Mode::X2x && solid.size_m == [4.0, 2.0, 1.5]);
    assert!(solid.velocity_mps.iter().all(|v| v.is_nan()));
}

#[test]
fn attributes_may_be_unknown_but_not_unheard_of() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let attributes = |values: Vec<Option<&str>>| {
        let mut columns = good();
        columns.push(("attribute", Arc::new(StringArray::from(values))));
        columns
    };
    let known = attributes(vec![Some("vehicle.stopped"), None, Some("")]);
    let path = write(folder.path(), known, Compression::UNCOMPRESSED);
    let file = PredictionFile::open(&path).expect("is good");
    let of =
        |scene| file.rows(scene).expect("are good").into_iter().filter_map(|row| Some(row.found?.attribute));
    assert!(of(4).chain(of(2)).eq([Some(1), None, None]));
    let other = attributes(vec![Some("vehicle.flying"), None, None]);
    let path = write(folder.path(), other, Compression::UNCOMPRESSED);
    let fault = PredictionFile::open(&path).expect("opens").rows(4).expect_err("is refused").to_string();
    assert!(fault.contains("row 0: `attribute` is `vehicle.flying`, which is no attribute"), "{fault}");
}

#[test]
fn a_row_without_a_class_names_a_sample() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let without_class = |scores: Vec<Option<f64>>| {
        let mut columns = good();
        columns[3].1 = Arc::new(StringArray::from(vec![Some("trailer"), Some("bus"), None]));
        columns[4].1 = Arc::new(Float64Array::from(scores));
        columns
    };
    let path =
        write(folder.path(), without_class(vec![Some(0.5), Some(0.5), None]), Compression::UNCOMPRESSED);
    let rows = PredictionFile::open(&path).and_then(|file| file.rows(4)).expect("is good");
    assert_eq!(rows[0].found.map(|found| found.class), Some(BoxClass::Trailer));
    assert_eq!((rows[1].frame, rows[1].found), (30, None));
    // A score says that something was found.
    let text = fault(without_class(vec![Some(0.5); 3]));
    assert!(text.starts_with("row 2: `class` is null, expected a detection class"), "{text}");
}

#[test]
fn scenes_are_read_by_several_threads_at_once() {
    const ROWS: usize = 40_000;
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Of ten scenes, in one row group.
    let at = |i: usize| [i as f64, (i * 7919 % ROWS) as f64, 0.5];
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("scene", Arc::new((0..ROWS).map(|i| Some((i * 10 / ROWS) as u32)).collect::<UInt32Array>())),
        ("frame", Arc::new(UInt32Array::from(vec![0; ROWS]))),
        ("agent", Arc::new(StringArray::from(vec!["vehicle_0"; ROWS]))),
        ("class", Arc::new(StringArray::from(vec!["car"; ROWS]))),
        ("score", Arc::new(Float64Array::from(vec![0.5; ROWS]))),
        ("center_m", lists(&(0..ROWS).map(at).collect::<Vec<_>>())),
        ("size_m", lists(&vec![[4.0, 2.0, 1.5]; ROWS])),
        ("quaternion", lists(&vec![[1.0, 0.0, 0.0, 0.0]; ROWS])),
    ];
    let path = folder.path().join("many.parquet");
    let batch = RecordBatch::try_from_iter(columns).expect("is a table");
    let mut writer = ArrowWriter::try_new(File::create(&path).expect("is created"), batch.schema(), None);
    let writer = writer.as_mut().expect("is a schema");
    writer.write(&batch).expect("is written");
    writer.finish().expect("is closed");
    let file = PredictionFile::open(&path).expect("is good");
    std::thread::scope(|scope| {
        let read = |scene: u32| {
            let rows = file.rows(scene).expect("are good");
            assert_eq!(rows.len(), ROWS / 10);
            assert!(
                rows.iter().all(|row| row.found.is_some_and(|found| found.solid.center_m == at(row.row))),
                "scene {scene}"
            );
        };
        for _ in 0..4 {
            scope.spawn(move || (0..10).for_each(read));
        }
    });
}

/// What is said of a file of predictions, wherever it is.
fn fault(columns: Vec<(&'static str, ArrayRef)>) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write(folder.path(), columns, Compression::UNCOMPRESSED);
    let read = PredictionFile::open(&path).and_then(|file| {
        let scenes: Vec<u32> = file.scenes().collect();
        scenes.into_iter().try_for_each(|scene| file.rows(scene).map(drop))
    });
    let text = read.expect_err("is not good").to_string();
    text.strip_prefix(&format!("{}: ", path.display())).expect("names the file").to_owned()
}

fn fault_with(column: &'static str, values: ArrayRef) -> String {
    let mut columns = good();
    columns.retain(|(name, _)| *name != column);
    columns.push((column, values));
    fault(columns)
}

#[test]
fn each_fault_is_one_clear_error() {
    let without = |name: &str| fault(good().into_iter().filter(|(column, _)| *column != name).collect());
    assert_eq!(
        without("score"),
        "has no column `score` (predictions have scene, frame, agent, mode, class, score, center_m, size_m, quaternion, \
         velocity_mps, attribute)"
    );
    let texts = |values: [&'static str; 3]| Arc::new(StringArray::from(values.to_vec())) as ArrayRef;
    let scores = |values: [f64; 3]| Arc::new(Float64Array::from(values.to_vec())) as ArrayRef;
    let cases = [
        ("score", texts(["a", "b", "c"]), "column `score` is of type Utf8, expected float"),
        ("frame", scores([0.0; 3]), "column `frame` is of type Float64, expected integer"),
        ("center_m", scores([0.0; 3]), "column `center_m` is of type Float64, expected list of 3 floats"),
        ("score", scores([0.0, 0.0, f64::NAN]), "row 2: `score` is NaN, expected a finite number"),
        ("class", texts(["car", "cat", "car"]), "row 1: `class` is `cat`, which is no detection class"),
        ("agent", texts(["car", "rsu_1", "rsu_1"]), "row 0: `agent` is `car`, which is no agent"),
        ("mode", texts(["x2x", "x2x", "all"]), "row 2: `mode` is `all`, which is no mode of cooperation"),
        (
            "size_m",
            lists(&[[4.0, 2.0, 0.0]; 3]),
            "row 1: `size_m` is [4.0, 2.0, 0.0], expected lengths above 0",
        ),
        (
            "quaternion",
            lists(&[[0.0; 4]; 3]),
            "row 1: `quaternion` is [0.0, 0.0, 0.0, 0.0], which is no rotation",
        ),
        ("quaternion", lists(&[[1.0; 3]; 3]), "row 1: `quaternion` has not 4 numbers"),
        (
            "velocity_mps",
            lists(&[[f64::INFINITY, 0.0, 0.0]; 3]),
            "row 1: `velocity_mps` is infinite, expected numbers, or null where it is not known",
        ),
    ];
    for (column, values, want) in cases {
        assert_eq!(fault_with(column, values), want, "{column}");
    }
    let negative: ArrayRef = Arc::new(Int64Array::from(vec![0, -1, 2]));
    assert_eq!(fault_with("frame", Arc::clone(&negative)), "row 1: `frame` is no number of one");
    assert_eq!(fault_with("scene", negative), "row 1: `scene` is no number of one");
    let nothing = good().into_iter().map(|(name, values)| (name, values.slice(0, 0))).collect();
    assert_eq!(fault(nothing), "has no rows: there is nothing to evaluate");
}

#[test]
fn what_is_no_parquet_is_said_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("predictions.parquet");
    let missing = PredictionFile::open(&path).expect_err("is not there").to_string();
    assert!(missing.contains("cannot be read"), "{missing}");
    std::fs::write(&path, "scene,frame\n").expect("is written");
    let other = PredictionFile::open(&path).expect_err("is a text").to_string();
    assert!(other.contains("is no readable Parquet file"), "{other}");
}
