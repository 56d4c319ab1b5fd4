//! A store of format 1, without the columns that tables have had since: every program reads of it what it
//! reads of a store of today.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{
    Array as _, ArrayRef, FixedSizeListArray, Float64Array, RecordBatch, StringArray, StructArray,
};
use arrow_schema::{DataType, Field, Schema};
use convoy_tests::{Bench, LEAN, Outcome, check_in_python, digests, program};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::properties::WriterProperties;
use schema::table::Row;
use schema::tables::{ActorRow, BoxRow, PlanSceneRow, TILE_STAGE, TrackFrameRow, ValidBoxRow};
use schema::tile::TileIndex;
use store::{Manifest, Scope, Store, keys};

use crate::evaluate::{perfect, write};

/// A column of today as tables of format 1 have it; none where they lack it. `renamed`: digests of
/// manifests, as they are and as they become.
fn older(table: &str, name: &str, array: &ArrayRef, renamed: &BTreeMap<String, String>) -> Option<ArrayRef> {
    if table.ends_with("log/tiles.parquet") && name == "digest" {
        let digests = array.as_string::<i32>().iter().flatten();
        return Some(Arc::new(StringArray::from_iter_values(digests.map(|digest| &renamed[digest]))));
    }
    if name == "scene" && table.starts_with("scenes/") || name == "is_ego" {
        return None;
    }
    let Some(fields) = array.as_struct_opt() else { return Some(Arc::clone(array)) };
    Some(if name == "attributes" { json(fields) } else { numbers(fields) })
}

/// Facts as JSON objects of strings.
fn json(facts: &StructArray) -> ArrayRef {
    let text = |row: usize| {
        let mut said = serde_json::Map::new();
        for (field, values) in facts.fields().iter().zip(facts.columns()) {
            if values.is_null(row) {
                continue;
            }
            let value = match field.data_type() {
                DataType::Utf8 => values.as_string::<i32>().value(row).to_owned(),
                DataType::Boolean => values.as_boolean().value(row).to_string(),
                DataType::Int32 => {
                    values.as_primitive::<arrow_array::types::Int32Type>().value(row).to_string()
                }
                _ => values.as_primitive::<Float64Type>().value(row).to_string(),
            };
            said.insert(field.name().clone(), value.into());
        }
        serde_json::Value::Object(said).to_string()
    };
    Arc::new(StringArray::from_iter_values((0..facts.len()).map(text)))
}

/// Weather as a list of numbers.
fn numbers(weather: &StructArray) -> ArrayRef {
    let columns: Vec<_> = weather.columns().iter().map(|c| c.as_primitive::<Float64Type>()).collect();
    let flat = (0..weather.len()).flat_map(|row| columns.iter().map(move |column| column.value(row)));
    let flat: Float64Array = flat.collect::<Vec<f64>>().into();
    let item = Arc::new(Field::new("item", DataType::Float64, false));
    Arc::new(FixedSizeListArray::new(item, columns.len() as i32, Arc::new(flat), None))
}

/// Rewrites a table as format 1 has it, row group by row group.
fn rewrite(key: &str, path: &Path, renamed: &BTreeMap<String, String>) {
    let open =
        || ParquetRecordBatchReaderBuilder::try_new(File::open(path).expect("opens")).expect("a table");
    let about = open();
    let mut notes = about.metadata().file_metadata().key_value_metadata().cloned().unwrap_or_default();
    notes.retain(|note| note.key != "ARROW:schema");
    let properties = WriterProperties::builder().set_key_value_metadata(Some(notes)).build();
    let aged = |batch: &RecordBatch| {
        let schema = batch.schema();
        let columns = schema.fields().iter().zip(batch.columns());
        let columns = columns.filter_map(|(field, array)| {
            let array = older(key, field.name(), array, renamed)?;
            Some((Field::new(field.name(), array.data_type().clone(), field.is_nullable()), array))
        });
        let (fields, arrays): (Vec<_>, Vec<_>) = columns.unzip();
        RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).expect("fits")
    };
    let mut bytes = Vec::new();
    let empty = aged(&RecordBatch::new_empty(Arc::clone(about.schema())));
    let mut writer = ArrowWriter::try_new(&mut bytes, empty.schema(), Some(properties)).expect("opens");
    for group in 0..about.metadata().num_row_groups() {
        for batch in open().with_row_groups(vec![group]).with_batch_size(1 << 20).build().expect("opens") {
            writer.write(&aged(&batch.expect("reads"))).expect("writes");
        }
        writer.flush().expect("writes");
    }
    writer.close().expect("ends");
    fs::write(path, bytes).expect("writes");
}

/// Makes a store one of format 1: tables, manifests, and the digests by which these name one another.
fn age(folder: &Path) {
    let store = Store::open(folder).expect("opens");
    let tiles = store.backend().keys("tiles").expect("lists");
    let mut scopes: Vec<(Scope, String)> = vec![(Scope::Plan, "spawn-planner".to_owned())];
    for key in tiles.iter().filter(|key| key.ends_with("_manifest.json")) {
        let [_, set, place, _] = key.split('/').collect::<Vec<_>>()[..] else { panic!("{key}") };
        let set = u64::from_str_radix(set, 16).expect("is a number");
        let (x, y) = place.split_once('_').expect("is a place");
        let index = TileIndex { x: x.parse().expect("a number"), y: y.parse().expect("a number") };
        scopes.push((Scope::Tile { set, index }, TILE_STAGE.to_owned()));
    }
    let of_scene = |stage: &&str| store.manifest(Scope::Scene(0), stage).expect("reads").is_some();
    let stages =
        ["simulate-and-log", "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];
    scopes.extend(stages.iter().filter(|s| of_scene(s)).map(|stage| (Scope::Scene(0), (*stage).to_owned())));
    scopes.push((Scope::Stats, "stats".to_owned()));
    let mut renamed: BTreeMap<String, String> = BTreeMap::new();
    for (scope, stage) in scopes {
        let read = store.manifest(scope, &stage).expect("reads").expect("is there");
        let mut aged = Manifest { format_version: 1, ..read.clone() };
        for output in &mut aged.outputs {
            let path = folder.join(&output.key);
            if output.key.ends_with(".parquet") {
                rewrite(&output.key, &path, &renamed);
            } else if output.key == keys::DATASET {
                let text = fs::read_to_string(&path).expect("reads");
                fs::write(&path, text.replace("\"format_version\": 2", "\"format_version\": 1"))
                    .expect("writes");
            }
            let bytes = fs::read(&path).expect("reads");
            (output.bytes, output.blake3) = (bytes.len() as u64, store::hash_bytes(&bytes));
        }
        for digest in aged.inputs.values_mut() {
            if let Some(now) = renamed.get(digest) {
                digest.clone_from(now);
            }
        }
        renamed.insert(read.digest(), aged.digest());
        store.replace_manifest(scope, &read, &aged).expect("writes");
    }
}

/// A table of scene 0 by its rows.
fn rows<R: Row>(store: &Store) -> Vec<R> {
    let manifest = store.manifest(Scope::Scene(0), R::STAGE).expect("reads").expect("is there");
    store.read_rows(&manifest, &keys::table::<R>(0)).expect("reads")
}

fn convoy(args: &[&str], places: &[&Path]) -> Outcome {
    let output = Command::new(program("convoy")).args(args).args(places).output();
    let outcome = Outcome::of(&output.expect("the program starts"));
    outcome.expect_done();
    outcome
}

#[test]
fn a_store_of_format_1_is_read_as_one_of_today() {
    let new = Bench::new(LEAN);
    new.run("convoy", &["run", "--progress", "none"]).expect_done();
    let old = Bench::new(LEAN);
    for entry in walkdir::WalkDir::new(new.store()).into_iter().filter_map(Result::ok) {
        let place = old.store().join(entry.path().strip_prefix(new.store()).expect("is below"));
        if entry.file_type().is_dir() {
            fs::create_dir_all(place).expect("a folder");
        } else {
            fs::copy(entry.path(), place).expect("a copy");
        }
    }
    age(&old.store());
    let dataset = fs::read_to_string(old.store().join(keys::DATASET)).expect("reads");
    assert!(dataset.contains("\"format_version\": 1"), "{dataset}");

    // Rows are the same.
    let [one, two] = [&old, &new].map(|bench| Store::open(bench.store()).expect("opens"));
    let columns = |store: &Store| {
        let manifest = store.manifest(Scope::Scene(0), BoxRow::STAGE).expect("reads").expect("is there");
        store.table_columns(&manifest, &keys::table::<BoxRow>(0)).expect("reads")
    };
    assert!(!columns(&one).iter().any(|name| name == "scene" || name == "is_ego"));
    assert!(["scene", "is_ego"].iter().all(|name| columns(&two).iter().any(|column| column == name)));
    assert_eq!(rows::<ActorRow>(&one), rows::<ActorRow>(&two));
    let boxes = rows::<BoxRow>(&two);
    assert!(boxes.iter().any(|row| row.is_ego) && !boxes.iter().all(|row| row.is_ego));
    assert_eq!(rows::<BoxRow>(&one), boxes);
    assert_eq!(rows::<ValidBoxRow>(&one), rows::<ValidBoxRow>(&two));
    assert_eq!(rows::<TrackFrameRow>(&one), rows::<TrackFrameRow>(&two));
    let plan = |store: &Store| -> Vec<PlanSceneRow> {
        let manifest = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is there");
        store.read_rows(&manifest, keys::PLAN_SCENES).expect("reads")
    };
    assert_eq!(plan(&one), plan(&two));

    // It is whole and clean, and exports, excerpts and a merged store are made of it.
    old.run("convoy", &["verify"]).expect_done();
    let clean = convoy(&["check", "--store"], &[&old.store()]);
    let checks = |said: &str| said.lines().filter(|line| line.contains("violation")).count();
    assert_eq!(checks(&clean.stdout), checks(&convoy(&["check", "--store"], &[&new.store()]).stdout));
    let exported = |bench: &Bench, layout: &str| {
        let dest = bench.folder.path().join(layout);
        convoy(
            &["export", layout, "--progress", "none", "--store"],
            &[&bench.store(), Path::new("--dest"), &dest],
        );
        let mut files = digests(&dest);
        // What an export says of itself names the manifests that it was made from.
        files.retain(|name, _| !name.starts_with(".convoy-export"));
        files
    };
    for layout in ["opv2v", "mcap"] {
        assert_eq!(exported(&old, layout), exported(&new, layout), "{layout}");
    }
    let own = write(new.folder.path(), "own.parquet", perfect(&new));
    let scored = |bench: &Bench| {
        convoy(&["evaluate", "--predictions"], &[&own, Path::new("--store"), &bench.store()]).stdout
    };
    let scores = scored(&old);
    assert!(scores.contains("nuScenes, ") && scores.contains("OPV2V, "), "{scores}");
    assert_eq!(scores, scored(&new));
    let merged = Bench::new(LEAN);
    let from = old.store().display().to_string();
    merged.run("convoy", &["merge", &from]).expect_done();
    assert_eq!(rows::<BoxRow>(&Store::open(merged.store()).expect("opens")), boxes);
    check_in_python("older.py", &["numpy", "pyarrow"], &[&old.store(), &new.store()]);

    // Nothing is stale, and what is made anew from its tables is what is made from those of today.
    old.run("convoy", &["run", "--progress", "none"]).expect_done();
    assert_eq!(rows::<BoxRow>(&one), boxes);
    assert!(!columns(&one).iter().any(|name| name == "scene"), "the log was made again");
    for stage in ["postprocess-valid", "merge-tracks", "stats"] {
        old.run(stage, &["--force"]).expect_done();
    }
    let made = |bench: &Bench| {
        let mut files = bench.digests();
        let of_stages = |name: &str| {
            name.contains("tracks")
                || name.contains("boxes_valid")
                || name.starts_with("stats/") && name.ends_with("parquet")
        };
        files.retain(|name, _| of_stages(name) && name.ends_with(".parquet"));
        files
    };
    assert!(made(&new).len() > 8);
    assert_eq!(made(&old), made(&new));
    old.run("convoy", &["verify"]).expect_done();
    convoy(&["check", "--store"], &[&old.store()]);
}
