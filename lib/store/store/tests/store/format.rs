//! Stores of other versions. `tests/data/format-1` is a store as the first version wrote it: it stays as it
//! is, and every later program reads it. So does `format-2`.

use std::path::Path;

use schema::table::{Column, Row};
use schema::tables::{BoxRow, GnssRow, PlanSceneRow, Weather};
use schema::{Attribute, Attributes};
use store::{Attempt, Failure, Redo, Scope, Store, StoreError, verify};

use crate::common::{Bench, SCOPE, STAGE, gnss, identity, key, on_every_backend, run};

on_every_backend!(a_store_of_another_format_is_refused, a_record_of_another_format_is_not_called_damaged);

fn fixture(version: u32) -> Store {
    let folder = format!("tests/data/format-{version}");
    Store::open(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect("is a folder")
}

/// The scene whose try was stopped half-way.
const STOPPED: Scope = Scope::Scene(8);

#[test]
fn stores_of_all_formats_are_read() {
    (1..=schema::FORMAT_VERSION).for_each(is_read);
}

fn is_read(version: u32) {
    let store = fixture(version);
    let manifest = store.manifest(SCOPE, STAGE).expect("reads").expect("is there");
    assert_eq!((manifest.format_version, manifest.generation), (version, 1));
    assert_eq!((manifest.stage.as_str(), manifest.code_version.as_str()), (STAGE, "test"));
    assert_eq!((manifest.config_hash.as_str(), manifest.inputs["simulate-and-log"].as_str()), ("c", "abc"));
    let rows: Vec<GnssRow> = store.read_rows(&manifest, &key("vehicle_0")).expect("reads");
    assert_eq!(rows, gnss(5));
    // The plan names a digest for each of its scenes; a stage's manifest has no such part at all.
    let plan = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is there");
    assert_eq!(plan.sections["scene/0007"], "digest of scene 7");
    assert!(manifest.sections.is_empty());
    let text = store.read(&SCOPE.manifest(STAGE)).expect("reads").expect("is there");
    let text = String::from_utf8(text.to_vec()).expect("is a text");
    assert!(!text.contains("sections"));
    // What depends on a manifest remembers its digest: it must come out as ever, without the text's own
    // checksum, which manifests end with since this fixture of format 1.
    let unsealed = text.split(",\n  \"record_blake3\"").next().unwrap_or_default();
    let unsealed = if unsealed == text { text.clone() } else { format!("{unsealed}\n}}\n") };
    assert_eq!(manifest.digest(), store::hash_bytes(unsealed.as_bytes()));

    let redo: Redo = store.read_json(&STOPPED.redo(STAGE)).expect("reads").expect("is there");
    assert_eq!((redo.generation, redo.replaces), (3, vec!["scenes/0008/old.parquet".to_owned()]));
    let failure: Failure = store.read_json(&STOPPED.failure("bev-gt")).expect("reads").expect("is there");
    assert_eq!(failure.reason, "frame 3: no light");
    let checked =
        verify(&store, &[(SCOPE, STAGE), (Scope::Plan, "spawn-planner")], |_| {}).expect("verifies");
    assert_eq!((checked.findings, checked.manifests), (vec![], 2));
    assert_eq!(checked.in_hand.len(), 3, "{:?}", checked.in_hand);
}

schema::columns! {
    /// Whose rows they are.
    Numbered of GnssRow { scene: u32, frame: u32 }
}

#[test]
fn tables_of_a_scene_name_it_since_format_2() {
    let columns = |version| {
        let store = fixture(version);
        let manifest = store.manifest(SCOPE, STAGE).expect("reads").expect("is there");
        let columns = store.table_columns(&manifest, &key("vehicle_0")).expect("reads");
        (store, manifest, columns)
    };
    let ((.., old), (store, manifest, new)) = (columns(1), columns(2));
    assert_eq!((old[0].as_str(), new[0].as_str()), ("frame", "scene"));
    assert_eq!(new[1..], old);
    let rows: Vec<Numbered> = store.read_rows(&manifest, &key("vehicle_0")).expect("reads");
    let frames: Vec<(u32, u32)> = gnss(5).iter().map(|row| (7, row.frame)).collect();
    assert_eq!(rows.iter().map(|row| (row.scene, row.frame)).collect::<Vec<_>>(), frames);
    // What lies in no scene's folder is of none.
    let bench = Bench::in_memory();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("all").expect("asks").expect("is new");
    unit.rows("plan/fixes.parquet", &gnss(1)).expect("writes");
    unit.finish().expect("finishes");
    let manifest = attempt.commit().expect("commits");
    assert_eq!(bench.store.table_columns(&manifest, "plan/fixes.parquet").expect("reads"), old);
}

/// Rows as a table of format 1 has them: `change` gives a column of today as it was, or none where it was not
/// there.
fn read_as_of_format_1<R: Row>(rows: &[R], change: impl Fn(&str, Column) -> Option<Column>) -> Vec<R> {
    let bench = Bench::in_memory();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("all").expect("asks").expect("is new");
    let columns = R::fields().into_iter().zip(R::to_columns(rows));
    let columns = columns.filter_map(|(field, column)| Some((field.name, change(field.name, column)?)));
    unit.columns("old.parquet", columns.collect()).expect("writes");
    unit.finish().expect("finishes");
    let manifest = attempt.commit().expect("commits");
    bench.store.read_rows(&manifest, "old.parquet").expect("reads")
}

#[test]
fn tables_of_format_1_keep_their_meaning() {
    let facts = Attributes::new().with(Attribute::Speed, 1.25).with(Attribute::UseWheelchair, false);
    let one = |id, angle_rad: Option<f64>| BoxRow {
        id,
        angle_rad,
        is_ego: angle_rad.is_none(),
        attributes: facts.clone(),
        ..BoxRow::default()
    };
    let boxes = [one(1, None), one(2, Some(0.0)), one(3, Some(-2.0))];
    let read = read_as_of_format_1(&boxes, |name, column| match name {
        "is_ego" => None,
        "attributes" => Some(Column::Str(vec![facts.to_string(); 3])),
        _ => Some(column),
    });
    assert_eq!(read, boxes);
    let weather = Weather { cloudiness: 12.0, dust_storm: 3.0, ..Weather::default() };
    let scenes = [PlanSceneRow { initial_weather: weather, ..PlanSceneRow::default() }];
    let read = read_as_of_format_1(&scenes, |name, column| match name {
        "initial_weather" => Some(Column::FixedF64(14, weather.to_array().to_vec())),
        "final_weather" => Some(Column::FixedF64(14, Weather::default().to_array().to_vec())),
        _ => Some(column),
    });
    assert_eq!(read, scenes);
}

/// A unit that an older program finished is taken up, not done again.
#[test]
fn a_try_of_the_first_format_is_taken_up() {
    let (old, bench) = (fixture(1), Bench::in_memory());
    for key in old.backend().keys("").expect("lists") {
        bench.put(&key, &old.read(&key).expect("reads").expect("is there"));
    }
    let identity = store::Identity { scope: STOPPED, ..identity("c") };
    let attempt = Attempt::start(&bench.store, identity, false).expect("starts");
    assert!(attempt.unit("vehicle_0").expect("asks").is_none(), "is kept");
    let manifest = attempt.commit().expect("commits");
    assert_eq!((manifest.generation, manifest.outputs.len()), (3, 1));
}

fn a_store_of_another_format_is_refused(bench: &Bench) {
    let mut manifest = run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    manifest.format_version = 99;
    bench.store.write_json(&SCOPE.manifest(STAGE), STAGE, &manifest).expect("writes");
    let error = bench.store.manifest(SCOPE, STAGE).expect_err("is newer");
    assert!(error.to_string().contains("store format 99") && error.is_usage(), "{error}");
    let before = bench.tree();
    assert!(matches!(run(&bench.store, "d", true, &["vehicle_0"]), Err(StoreError::Format { .. })));
    assert_eq!(before, bench.tree(), "it is not ours to change");
}

fn a_record_of_another_format_is_not_called_damaged(bench: &Bench) {
    bench.put(&SCOPE.manifest(STAGE), br#"{"format_version": 3, "outputs": "a table instead"}"#);
    assert!(matches!(bench.store.manifest(SCOPE, STAGE), Err(StoreError::Format { found: 3, .. })));
}

/// Writes a fixture of the present format.
#[test]
#[ignore = "a fixture is made once for each format"]
fn write_the_fixture() {
    let folder = format!("tests/data/format-{}", schema::FORMAT_VERSION);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    assert!(!folder.exists(), "{} is never changed", folder.display());
    let store = Store::open(folder).expect("is a folder");
    let attempt = Attempt::start(&store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows(&key("vehicle_0"), &gnss(5)).expect("writes");
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");
    let attempt = Attempt::start(&store, identity("c"), true).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is forced");
    unit.rows(&key("vehicle_0"), &gnss(5)).expect("writes");
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");

    let plan = store::Identity { stage: "spawn-planner".into(), scope: Scope::Plan, ..identity("c") };
    let mut attempt = Attempt::start(&store, plan, false).expect("starts");
    attempt.section("scene/0007", "digest of scene 7".into());
    attempt.commit().expect("commits");

    let redo = Redo { generation: 3, replaces: vec!["scenes/0008/old.parquet".into()], old: None };
    store.write_json(&STOPPED.redo(STAGE), STAGE, &redo).expect("writes");
    let stopped = store::Identity { scope: STOPPED, ..identity("c") };
    let attempt = Attempt::start(&store, stopped, false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows("scenes/0008/sensors/vehicle_0/GNSS.parquet", &gnss(5)).expect("writes");
    unit.finish().expect("finishes");
    let failure = Failure { code_version: "test".into(), reason: "frame 3: no light".into() };
    store.write_json(&STOPPED.failure("bev-gt"), "bev-gt", &failure).expect("writes");
}
