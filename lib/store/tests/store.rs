//! Commit, resume, staleness of leftovers, broken shards.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use schema::tables::{GnssRow, LidarRow};
use store::{
    Attempt, Backend, Disk, Identity, Manifest, Problem, Scope, Shard, Sink, Store, StoreError, TableOptions,
    keys, verify,
};

const STAGE: &str = "render-sensors";

fn identity(config: &str) -> Identity {
    Identity {
        stage: STAGE.into(),
        scope: Scope::Scene(7),
        code_version: "test".into(),
        config_hash: config.into(),
        inputs: BTreeMap::from([("simulate-and-log".to_owned(), "abc".to_owned())]),
    }
}

fn gnss(frames: u32) -> Vec<GnssRow> {
    (0..frames)
        .map(|frame| GnssRow {
            frame,
            time_s: f64::from(frame) * 0.05,
            latitude_deg: 1.0,
            ..GnssRow::default()
        })
        .collect()
}

fn key(unit: &str) -> String {
    keys::scene(7, &format!("sensors/{unit}/GNSS.parquet"))
}

/// Runs a stage of two units; stops before the second when told so.
fn run(store: &Store, config: &str, force: bool, units: &[&str]) -> Result<Manifest, StoreError> {
    let mut attempt = Attempt::start(store, identity(config), force)?;
    for name in units {
        if let Some(mut unit) = attempt.unit(name)? {
            unit.rows(&key(name), &gnss(40))?;
            unit.finish()?;
        }
    }
    attempt.commit()
}

fn tree(root: &Path) -> BTreeMap<String, Vec<u8>> {
    walkdir::WalkDir::new(root)
        .into_iter()
        .map(|e| e.expect("listing"))
        .filter(|e| e.file_type().is_file())
        .map(|e| {
            let name = e.path().strip_prefix(root).expect("below root").to_string_lossy().into_owned();
            (name, fs::read(e.path()).expect("reading"))
        })
        .collect()
}

#[test]
fn rows_come_back_and_checksums_hold() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let manifest = run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    assert_eq!(manifest.outputs.len(), 2);
    let rows: Vec<GnssRow> = store.read_rows(&manifest, &key("vehicle_1")).expect("reads");
    assert_eq!(rows, gnss(40));
    let checked = verify(&store, |_| {}).expect("verifies");
    assert_eq!((checked.manifests, checked.shards, checked.findings.len()), (1, 2, 0));
    assert!(tree(dir.path()).keys().all(|k| !k.contains(".tmp") && !k.contains(".parts")));
}

#[test]
fn lists_keep_one_frame_per_group() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let sweep = |frame: u32| LidarRow {
        frame,
        x: vec![1.5; 1000 + frame as usize],
        ring: vec![3; 1000 + frame as usize],
        tag: vec![9; 1000 + frame as usize],
        ..LidarRow::default()
    };
    let rows: Vec<LidarRow> = (0..5).map(sweep).collect();
    let mut attempt = Attempt::start(&store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    let mut table = unit.table("scenes/0007/x.parquet", TableOptions::frames(Vec::new())).expect("opens");
    table.push(&rows).expect("writes");
    unit.add(table.finish().expect("finishes"));
    unit.finish().expect("commits");
    let manifest = attempt.commit().expect("commits");
    let groups: Vec<Vec<LidarRow>> = store
        .row_groups(&manifest, "scenes/0007/x.parquet")
        .expect("opens")
        .map(|g| g.expect("reads"))
        .collect();
    assert_eq!(groups.iter().map(Vec::len).collect::<Vec<_>>(), [1; 5]);
    assert_eq!(groups.concat(), rows);
}

#[test]
fn a_killed_try_keeps_its_finished_units() {
    let (clean, broken) = (tempfile::tempdir().expect("temp"), tempfile::tempdir().expect("temp"));
    run(&Store::on_disk(clean.path()), "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");

    // The process dies with one unit finished and a shard in hand.
    let store = Store::on_disk(broken.path());
    let mut attempt = Attempt::start(&store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    let unit = attempt.unit("vehicle_1").expect("asks").expect("is new");
    let mut hand = unit.file(&key("vehicle_1")).expect("opens");
    hand.write_all(b"half a shard").expect("writes");
    std::mem::forget(hand);
    assert!(store.manifest(Scope::Scene(7), STAGE).expect("asks").is_none());

    let mut attempt = Attempt::start(&store, identity("c"), false).expect("starts again");
    assert!(attempt.unit("vehicle_0").expect("asks").is_none(), "is kept");
    let mut unit = attempt.unit("vehicle_1").expect("asks").expect("was lost");
    unit.rows(&key("vehicle_1"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");
    assert_eq!(tree(clean.path()), tree(broken.path()));
}

#[test]
fn a_try_killed_after_its_manifest_is_tidied() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    run(&store, "c", false, &["vehicle_0"]).expect("runs");
    let clean = tree(dir.path());
    store.write_json(&Scope::Scene(7).part(STAGE, "vehicle_0"), STAGE, &1).expect("writes");
    store.write_json(&Scope::Scene(7).redo(STAGE), STAGE, &1).expect("writes");
    Attempt::tidy(&store, Scope::Scene(7), STAGE).expect("tidies");
    assert_eq!(clean, tree(dir.path()));
}

#[test]
fn leftovers_of_the_plan_are_found_all_over_the_store() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    for key in [keys::DATASET, "maps/convoy/demo.xodr.zst", keys::PLAN_SCENES] {
        std::mem::forget(store.backend().create(key, "spawn-planner").expect("creates"));
    }
    assert_eq!(tree(dir.path()).len(), 3);
    Attempt::tidy(&store, Scope::Plan, "spawn-planner").expect("tidies");
    assert_eq!(tree(dir.path()).len(), 0);
}

#[test]
fn a_finished_unit_of_another_config_is_not_kept() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let mut attempt = Attempt::start(&store, identity("old"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows(&key("vehicle_0"), &gnss(3)).expect("writes");
    unit.finish().expect("finishes");
    drop(attempt);
    let mut attempt = Attempt::start(&store, identity("new"), false).expect("starts");
    assert!(attempt.unit("vehicle_0").expect("asks").is_some());
}

#[test]
fn forcing_changes_the_digest_once_even_when_killed_between() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let first = run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let again = run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    assert_eq!(first.digest(), again.digest());

    let mut attempt = Attempt::start(&store, identity("c"), true).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("forced");
    assert!(store.manifest(Scope::Scene(7), STAGE).expect("asks").is_some(), "the old one still stands");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    drop(attempt);
    let forced = run(&store, "c", true, &["vehicle_0", "vehicle_1"]).expect("runs");
    assert_eq!(forced.generation, 1);
    assert_ne!(first.digest(), forced.digest());
    assert_eq!(first.outputs, forced.outputs);
}

#[test]
fn what_a_new_try_no_longer_writes_is_removed() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    run(&store, "d", false, &["vehicle_0"]).expect("runs");
    let files = tree(dir.path());
    assert!(files.contains_key("scenes/0007/sensors/vehicle_0/GNSS.parquet"));
    assert!(!files.keys().any(|k| k.contains("vehicle_1")), "{:?}", files.keys());
}

#[test]
fn broken_shards_are_named() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let manifest = run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let path = dir.path().join(key("vehicle_0"));
    let whole = fs::read(&path).expect("reads");

    fs::write(&path, &whole[..whole.len() / 2]).expect("truncates");
    let error = store.read_rows::<GnssRow>(&manifest, &key("vehicle_0")).expect_err("is truncated");
    let text = error.to_string();
    assert!(text.contains("vehicle_0/GNSS.parquet") && text.contains("truncated"), "{text}");
    assert!(!store.outputs_present(&manifest).expect("asks"));

    let mut changed = whole.clone();
    changed[whole.len() / 3] ^= 0x40;
    fs::write(&path, &changed).expect("writes");
    fs::remove_file(dir.path().join(key("vehicle_1"))).expect("removes");
    let findings = verify(&store, |_| {}).expect("verifies").findings;
    let problems: Vec<_> = findings.iter().map(|f| (f.key.as_str(), f.problem.clone())).collect();
    let (first, second) = (key("vehicle_0"), key("vehicle_1"));
    assert_eq!(problems, [(first.as_str(), Problem::Changed), (second.as_str(), Problem::Missing)]);
}

#[test]
fn damaged_records_are_done_again() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let whole = tree(dir.path());
    let scope = Scope::Scene(7);
    let manifest = dir.path().join(scope.manifest(STAGE));
    for kept in [0, 40] {
        let bytes = fs::read(&manifest).expect("reads");
        fs::write(&manifest, &bytes[..kept]).expect("truncates");
        assert!(matches!(store.manifest(scope, STAGE), Err(StoreError::Corrupt { .. })));
        run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs again");
        assert_eq!(whole, tree(dir.path()));
    }
    // The same for the records of a try that was killed after its first unit.
    let mut attempt = Attempt::start(&store, identity("d"), true).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    drop(attempt);
    for record in [scope.part(STAGE, "vehicle_0"), scope.redo(STAGE)] {
        fs::write(dir.path().join(record), "{").expect("is there");
    }
    let manifest = run(&store, "d", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    assert_eq!(manifest.outputs.len(), 2);
    assert!(verify(&store, |_| {}).expect("verifies").findings.is_empty());
}

#[test]
fn two_outputs_of_one_name_are_refused() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let mut attempt = Attempt::start(&store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.rows(&key("vehicle_0"), &gnss(20)).expect("writes");
    let error = unit.finish().expect_err("is refused");
    assert!(error.to_string().contains("vehicle_0/GNSS.parquet"), "{error}");
}

#[test]
fn what_a_living_process_writes_is_not_swept() {
    let dir = tempfile::tempdir().expect("temp dir");
    let disk = Disk::new(dir.path());
    let sink = disk.create("a/table.parquet", STAGE).expect("creates");
    let ours = walkdir::WalkDir::new(dir.path()).into_iter().filter_map(Result::ok);
    let ours = ours.map(|e| e.into_path()).find(|p| p.is_file()).expect("is being written");
    // The same leftover, had another process made it.
    let mut other = std::process::Command::new("sleep").arg("600").spawn().expect("sleep runs");
    let name = ours.file_name().expect("has a name").to_string_lossy().into_owned();
    let own_id = format!("~{}~", std::process::id());
    assert!(name.contains(&own_id), "{name}");
    let theirs = ours.with_file_name(name.replace(&own_id, &format!("~{}~", other.id())));
    fs::write(&theirs, "half").expect("writes");
    drop(sink);
    assert_eq!(disk.sweep("", STAGE).expect("sweeps"), 0);
    other.kill().expect("is killed");
    other.wait().expect("is reaped");
    assert_eq!(disk.sweep("", "bev-gt").expect("sweeps"), 0, "not its owner");
    assert_eq!(disk.sweep("", STAGE).expect("sweeps"), 1);
    assert!(!theirs.exists());
}

/// A disk that is full after some bytes.
struct FullDisk {
    disk: Disk,
    room: usize,
}

struct FullSink {
    sink: Box<dyn Sink>,
    room: usize,
}

impl Write for FullSink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.len() > self.room {
            return Err(io::Error::from_raw_os_error(28)); // ENOSPC
        }
        self.room -= bytes.len();
        self.sink.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

impl Sink for FullSink {
    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        self.sink.commit()
    }
}

impl Backend for FullDisk {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        Ok(Box::new(FullSink { sink: self.disk.create(key, owner)?, room: self.room }))
    }
    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.disk.read(key)
    }
    fn open(&self, key: &str) -> Result<Shard, StoreError> {
        self.disk.open(key)
    }
    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        self.disk.size(key)
    }
    fn remove(&self, key: &str) -> Result<(), StoreError> {
        self.disk.remove(key)
    }
    fn list(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        self.disk.list(folder)
    }
    fn sweep(&self, folder: &str, owner: &str) -> Result<usize, StoreError> {
        self.disk.sweep(folder, owner)
    }
    fn location(&self, key: &str) -> String {
        self.disk.location(key)
    }
}

#[test]
fn a_full_disk_loses_nothing_committed() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    run(&store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let before = tree(dir.path());
    let full = Store::new(std::sync::Arc::new(FullDisk { disk: Disk::new(dir.path()), room: 100 }));
    let error = run(&full, "d", false, &["vehicle_0", "vehicle_1"]).expect_err("is full");
    assert!(matches!(error, StoreError::Full { .. }), "{error}");
    assert!(error.is_transient() && error.to_string().contains("vehicle_0/GNSS.parquet"));
    assert_eq!(before, tree(dir.path()));
}

#[test]
fn a_store_of_another_format_is_refused() {
    let dir = tempfile::tempdir().expect("temp dir");
    let store = Store::on_disk(dir.path());
    let mut manifest = run(&store, "c", false, &["vehicle_0"]).expect("runs");
    manifest.format_version = 99;
    store.write_json(&Scope::Scene(7).manifest(STAGE), STAGE, &manifest).expect("writes");
    let error = store.manifest(Scope::Scene(7), STAGE).expect_err("is newer");
    assert!(error.to_string().contains("store format 99"), "{error}");
}
