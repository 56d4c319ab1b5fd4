//! `evaluate` on a tiny dataset: its own boxes as predictions, and predictions that cannot be.

mod masks;
mod results;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, StringArray, UInt32Array};
use convoy_tests::{Bench, Outcome, TINY, program};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;

/// The boxes of a scene as predictions of all of them, surer the earlier they stand.
pub(crate) fn perfect(bench: &Bench) -> Vec<(&'static str, ArrayRef)> {
    let file = File::open(bench.store().join("scenes/0000/boxes.parquet")).expect("is there");
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("is Parquet").with_batch_size(1 << 20);
    let batches: Vec<RecordBatch> =
        reader.build().expect("opens").map(|batch| batch.expect("reads")).collect();
    let [boxes] = &batches[..] else { panic!("{} batches", batches.len()) };
    let column = |name: &str| boxes.column_by_name(name).expect("is a column").clone();
    let rpy = column("rpy_rad");
    let angles = rpy.as_fixed_size_list().values().clone();
    let angles = angles.as_primitive::<arrow_array::types::Float64Type>();
    let rows = boxes.num_rows();
    let turns: Float64Array = (0..rows)
        .flat_map(|i| {
            let (s, c) = frames::math::sin_cos(angles.value(3 * i + 2) / 2.0);
            [c, 0.0, 0.0, s]
        })
        .collect();
    let item = Arc::new(arrow_schema::Field::new("item", arrow_schema::DataType::Float64, false));
    let turns = arrow_array::FixedSizeListArray::try_new(item, 4, Arc::new(turns), None).expect("is a list");
    let scores: Float64Array = (0..rows).map(|i| 1.0 - i as f64 / rows as f64).collect();
    vec![
        ("scene", Arc::new(UInt32Array::from(vec![0; rows])) as ArrayRef),
        ("frame", column("frame")),
        ("agent", column("agent")),
        ("class", column("class")),
        ("score", Arc::new(scores)),
        ("center_m", column("center_m")),
        ("size_m", column("size_m")),
        ("quaternion", Arc::new(turns)),
        ("velocity_mps", column("velocity_mps")),
    ]
}

pub(crate) fn write(folder: &Path, name: &str, columns: Vec<(&'static str, ArrayRef)>) -> PathBuf {
    let path = folder.join(name);
    let batch = RecordBatch::try_from_iter(columns).expect("is a table");
    let file = File::create(&path).expect("is created");
    let as_pyarrow_does = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(as_pyarrow_does)).expect("is a schema");
    writer.write(&batch).expect("is written");
    writer.close().expect("is closed");
    path
}

fn evaluate(bench: &Bench, predictions: &Path, args: &[&str]) -> Outcome {
    let mut command = Command::new(program("convoy"));
    command
        .arg("evaluate")
        .arg("--predictions")
        .arg(predictions)
        .arg("--store")
        .arg(bench.store())
        .args(args);
    Outcome::of(&command.output().expect("the program starts"))
}

/// The value of a measure over all classes.
fn value(file: &Path, metrics: &str, measure: &str) -> f64 {
    let rows: serde_json::Value =
        serde_json::from_slice(&std::fs::read(file).expect("is written")).expect("is JSON");
    let is_it = |row: &&serde_json::Value| {
        row["metrics"] == metrics
            && row["measure"] == measure
            && row["class"] == "all"
            && row["level"] == "all"
    };
    let row = rows.as_array().and_then(|rows| rows.iter().find(is_it));
    row.and_then(|row| row["value"].as_f64()).expect("has a value")
}

/// Those of the rows that are wanted.
fn some(columns: &[(&'static str, ArrayRef)], wanted: &[bool]) -> Vec<(&'static str, ArrayRef)> {
    let wanted = arrow_array::BooleanArray::from(wanted.to_vec());
    let of = |array: &ArrayRef| arrow_select::filter::filter(array, &wanted).expect("is filtered");
    columns.iter().map(|(name, array)| (*name, of(array))).collect()
}

/// A file says which samples it is of; ranges cut targets and predictions alike.
fn named_samples(bench: &Bench, good: &[(&'static str, ArrayRef)]) {
    let folder = bench.folder.path();
    let numbers = |name: &str| {
        let column = &good.iter().find(|(found, _)| *found == name).expect("is there").1;
        column.as_primitive::<arrow_array::types::UInt32Type>().values().to_vec()
    };
    let frames = numbers("frame");
    let at = |kept: &[u32]| some(good, &frames.iter().map(|frame| kept.contains(frame)).collect::<Vec<_>>());
    let scores = |file: &Path, args: &[&str]| -> (Outcome, PathBuf) {
        let out = folder.join("named.json");
        let outcome = evaluate(bench, file, &[args, &["--out", &out.display().to_string()]].concat());
        outcome.expect_done();
        (outcome, out)
    };
    // Frames 0, 5 and 10 of the one vehicle; the RSU is no ego.
    let three = write(folder, "three.parquet", at(&[0, 5, 10]));
    let (outcome, out) = scores(&three, &["--seen", "nobody"]);
    assert!(outcome.stdout.starts_with("3 samples, "), "{}", outcome.stdout);
    assert!(!outcome.stderr.contains("WARN"), "{}", outcome.stderr);
    assert!((value(&out, "simbev2x", "mAP") - 1.0).abs() < 1e-9);
    assert!(value(&out, "nuscenes", "NDS without AAE") > 0.0);
    // The same frames with one in which nothing is said, and one that is left out.
    let (_, out) = scores(&three, &["--seen", "nobody", "--every", "5"]);
    let with_a_gap = value(&out, "simbev2x", "mAP");
    assert!(with_a_gap < 0.9, "{with_a_gap}");
    let gap = write(folder, "gap.parquet", at(&[0, 5, 15]));
    let (outcome, _) = scores(&gap, &["--seen", "nobody"]);
    assert!(outcome.stdout.starts_with("3 samples, "), "{}", outcome.stdout);
    assert!(outcome.stderr.contains("1 samples lie between those that the file names"), "{}", outcome.stderr);
    // Attributes by speed give AAE.
    let (_, out) = scores(&three, &["--seen", "nobody", "--attributes-by-speed"]);
    assert!(value(&out, "nuscenes", "mAAE") < 1.0 && value(&out, "nuscenes", "NDS") > 0.0);
    // Within 20 m ahead there are fewer targets, all of which are found.
    let targets = |out: &Path| -> f64 {
        let rows: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out).expect("is written")).expect("is JSON");
        let is_it = |row: &&serde_json::Value| {
            row["metrics"] == "simbev2x" && row["measure"] == "targets" && row["level"] == "all"
        };
        rows.as_array().expect("is a list").iter().filter(is_it).filter_map(|row| row["value"].as_f64()).sum()
    };
    let (_, out) = scores(&three, &["--seen", "nobody", "--by", "map"]);
    let all = targets(&out) / 2.0;
    let (_, out) = scores(&three, &["--seen", "nobody", "--range-m=0,-20,20,20"]);
    assert!(targets(&out) > 0.0 && targets(&out) < all, "{} of {all}", targets(&out));
    assert!((value(&out, "simbev2x", "mAP") - 1.0).abs() < 1e-9);
    // Where no box lies nothing is found, and the file is as good as before.
    let (outcome, _) = scores(&three, &["--seen", "nobody", "--range-m", "9000,9000,9001,9001"]);
    assert!(outcome.stdout.starts_with("3 samples, 0 predictions"), "{}", outcome.stdout);
    for (args, want) in [
        (
            &["--range-m", "20,-20,0,20"][..],
            "--range-m is [20.0, -20.0, 0.0, 20.0], expected the least x and y",
        ),
        (&["--bootstrap", "100"], "--bootstrap draws scenes, and there is but one"),
    ] {
        let refused = evaluate(bench, &three, args);
        assert!(refused.code == 2 && refused.stderr.contains(want), "{}", refused.stderr);
    }
}

#[test]
fn own_boxes_are_perfect_and_faults_are_named() {
    let bench = Bench::new(TINY);
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let folder = bench.folder.path();
    let good = perfect(&bench);
    let file = write(folder, "perfect.parquet", good.clone());
    let results: Vec<Vec<u8>> = ["1", "2"]
        .map(|threads| {
            let out = folder.join(format!("scores-{threads}.json"));
            let table = folder.join(format!("scores-{threads}.parquet"));
            for out in [&out, &table] {
                let args = ["--threads", threads, "--seen", "nobody", "--metrics", "simbev2x", "--out"];
                let outcome = evaluate(&bench, &file, &[&args[..], &[&out.display().to_string()]].concat());
                outcome.expect_done();
                assert!(outcome.stdout.contains("SDS"), "{}", outcome.stdout);
            }
            assert!((value(&out, "simbev2x", "mATE")).abs() < 1e-9);
            assert!((value(&out, "simbev2x", "mAOE")).abs() < 1e-6);
            [std::fs::read(out).expect("is written"), std::fs::read(table).expect("is written")].concat()
        })
        .into();
    assert_eq!(results[0], results[1]);
    let outcome = evaluate(&bench, &file, &["--every", "5", "--agents", "vehicle_0"]);
    outcome.expect_done();
    assert!(
        outcome.stdout.starts_with("4 samples, ") && outcome.stdout.contains("NDS"),
        "{}",
        outcome.stdout
    );

    let rows = good[0].1.len();
    let texts = |text: &str| Arc::new(StringArray::from(vec![text; rows])) as ArrayRef;
    let numbers = |n: u32| Arc::new(UInt32Array::from(vec![n; rows])) as ArrayRef;
    let cases = [
        ("scene", numbers(7), "scene 7, which is not in the plan"),
        ("frame", numbers(20), "row 0: scene 0 has no frame 20; it has frames 0 to 19"),
        ("agent", texts("vehicle_5"), "row 0: scene 0 has no agent `vehicle_5`; it has vehicle_0, rsu_0"),
        ("class", texts("cat"), "row 0: `class` is `cat`, which is no detection class"),
    ];
    for (column, values, want) in cases {
        let columns =
            good.iter().map(|(name, old)| (*name, if *name == column { &values } else { old }.clone()));
        let bad = write(folder, "bad.parquet", columns.collect());
        let outcome = evaluate(&bench, &bad, &[]);
        assert!(outcome.code == 2 && outcome.stderr.contains(want), "{column}: {}", outcome.stderr);
        assert_eq!(outcome.stderr.matches("ERROR").count(), 1, "{}", outcome.stderr);
    }
    let refused = evaluate(&bench, &file, &["--agents", "vehicle_7"]);
    assert!(refused.code == 2 && refused.stderr.contains("none of its rows"), "{}", refused.stderr);

    named_samples(&bench, &good);
    masks::check(&bench);
    results::check(&bench, &good, &file);
}
