//! Stores of other versions. `tests/data/format-1` is a store as the first version wrote it: it stays as it
//! is, and every later program of that format reads it.

use std::path::Path;

use schema::tables::GnssRow;
use store::{Attempt, Failure, Redo, Scope, Store, StoreError, verify};

use crate::common::{Bench, SCOPE, STAGE, gnss, identity, key, on_every_backend, run};

on_every_backend!(a_store_of_another_format_is_refused, a_record_of_another_format_is_not_called_damaged);

fn fixture() -> Store {
    Store::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/format-1")).expect("is a folder")
}

/// The scene whose try was stopped half-way.
const STOPPED: Scope = Scope::Scene(8);

#[test]
fn a_store_of_the_first_format_is_read() {
    let store = fixture();
    let manifest = store.manifest(SCOPE, STAGE).expect("reads").expect("is there");
    assert_eq!((manifest.format_version, manifest.generation), (1, 1));
    assert_eq!((manifest.stage.as_str(), manifest.code_version.as_str()), (STAGE, "test"));
    assert_eq!((manifest.config_hash.as_str(), manifest.inputs["simulate-and-log"].as_str()), ("c", "abc"));
    let rows: Vec<GnssRow> = store.read_rows(&manifest, &key("vehicle_0")).expect("reads");
    assert_eq!(rows, gnss(5));
    // The plan names a digest for each of its scenes; a stage's manifest has no such part at all.
    let plan = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is there");
    assert_eq!(plan.sections["scene/0007"], "digest of scene 7");
    assert!(manifest.sections.is_empty());
    let text = store.read(&SCOPE.manifest(STAGE)).expect("reads").expect("is there");
    assert!(!String::from_utf8_lossy(&text).contains("sections"));
    // What depends on a manifest remembers its digest: it must come out as ever.
    assert_eq!(manifest.digest(), store::hash_bytes(&text));

    let redo: Redo = store.read_json(&STOPPED.redo(STAGE)).expect("reads").expect("is there");
    assert_eq!((redo.generation, redo.replaces), (3, vec!["scenes/0008/old.parquet".to_owned()]));
    let failure: Failure = store.read_json(&STOPPED.failure("bev-gt")).expect("reads").expect("is there");
    assert_eq!(failure.reason, "frame 3: no light");
    let checked =
        verify(&store, &[(SCOPE, STAGE), (Scope::Plan, "spawn-planner")], |_| {}).expect("verifies");
    assert_eq!((checked.findings, checked.manifests), (vec![], 2));
    assert_eq!(checked.in_hand.len(), 3, "{:?}", checked.in_hand);
}

/// A unit that an older program finished is taken up, not done again.
#[test]
fn a_try_of_the_first_format_is_taken_up() {
    let (old, bench) = (fixture(), Bench::in_memory());
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
    bench.put(&SCOPE.manifest(STAGE), br#"{"format_version": 2, "outputs": "a table instead"}"#);
    assert!(matches!(bench.store.manifest(SCOPE, STAGE), Err(StoreError::Format { found: 2, .. })));
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
