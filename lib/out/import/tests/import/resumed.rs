//! A dataset as a store, in one go and in many.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};

use import_core::{ImportError, Outcome, ProgressWatch, Selection, Source, import, prospect};
use schema::IMPORTED;
use schema::table::Row;
use schema::tables::{AgentRow, BoxRow, CameraRow, GnssRow, LidarRow, PlanSceneRow};
use store::{Scope, Store, verify};

use crate::dataset::{self, FRAMES};

/// Stops after so many reports.
struct StopAfter(AtomicI64);

impl ProgressWatch for StopAfter {
    fn advance(&self, _: u64) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) <= 0
    }
}

fn run(root: &Path, store: &Store, force: bool, reports: i64) -> Result<Outcome, ImportError> {
    let source = Source::open(root)?;
    let selection = Selection { force, ..Selection::default() };
    let found = prospect(&source, store, &selection)?;
    import(&source, store, found, &selection, "a name", &StopAfter(AtomicI64::new(reports)))
}

/// What a store holds, by key.
fn content(store: &Store) -> BTreeMap<String, Vec<u8>> {
    let keys = store.backend().keys("").expect("lists");
    keys.into_iter().map(|key| (key.clone(), store.read(&key).expect("reads").expect("is there"))).collect()
}

#[test]
fn scenes_become_what_their_stages_would_have_made() {
    let folder = tempfile::tempdir().expect("a folder");
    dataset::write(folder.path());
    let store = Store::open("memory:").expect("opens");
    let outcome = run(folder.path(), &store, false, i64::MAX).expect("imports");
    assert_eq!((outcome.made, outcome.kept, outcome.failed.len()), (2, 0, 0));
    let manifest = |stage| store.manifest(Scope::Scene(1), stage).expect("reads").expect("stands");
    let log = manifest(BoxRow::STAGE);
    assert_eq!(log.code_version, IMPORTED);
    let boxes: Vec<BoxRow> = store.read_rows(&log, "scenes/0001/boxes.parquet").expect("reads");
    assert_eq!(boxes.len(), 2 * FRAMES);
    let second = &boxes[3];
    assert_eq!((second.frame, second.id, second.model.as_str()), (1, 12, "car.sedan"));
    assert_eq!((second.center_m, second.size_m), ([8.0, 0.5, 0.75], [4.0, 2.0, 1.5]));
    let agents: Vec<AgentRow> = store.read_rows(&log, "scenes/0001/agents.parquet").expect("reads");
    assert_eq!(
        (agents[2].id, agents[2].xyz_m, agents[2].velocity_mps),
        (9, [0.0, 1.0, 0.0], [0.0, 10.0, 0.0])
    );
    let sensors = manifest(CameraRow::STAGE);
    let lidar: Vec<LidarRow> =
        store.read_rows(&sensors, "scenes/0001/sensors/vehicle_0/LIDAR.parquet").expect("reads");
    assert_eq!((lidar.len(), lidar[2].x[1], lidar[2].z[9]), (FRAMES, 5.0, 31.0));
    let fixes: Vec<GnssRow> =
        store.read_rows(&sensors, "scenes/0001/sensors/vehicle_0/GNSS.parquet").expect("reads");
    assert_eq!(fixes[4].altitude_m, 4.0);
    let mut stages = vec![(Scope::Plan, PlanSceneRow::STAGE)];
    for stage in [BoxRow::STAGE, CameraRow::STAGE, "bev-gt", "occupancy-gt"] {
        stages.extend([(Scope::Scene(0), stage), (Scope::Scene(1), stage)]);
    }
    let checked = verify(&store, &stages, |_| {}).expect("verifies");
    assert!(checked.findings.is_empty(), "{:?}", checked.findings);
}

#[test]
fn an_import_that_is_stopped_anywhere_ends_up_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    dataset::write(folder.path());
    let whole = Store::open("memory:").expect("opens");
    run(folder.path(), &whole, false, i64::MAX).expect("imports");
    let wanted = content(&whole);
    for reports in 0..12 {
        let store = Store::open("memory:").expect("opens");
        let mut stops = 0;
        loop {
            // Each try gets a report farther.
            match run(folder.path(), &store, false, reports + stops) {
                Ok(outcome) => {
                    assert_eq!(outcome.made + outcome.kept, 2);
                    break;
                }
                Err(ImportError::Stopped) => stops += 1,
                Err(other) => panic!("{other}"),
            }
            let plan = store.manifest(Scope::Plan, PlanSceneRow::STAGE).expect("reads");
            assert!(plan.is_none(), "half an import is taken for a store");
            assert!(stops < 40, "it never ends");
        }
        assert!(content(&store) == wanted, "stopped after {reports} reports, {stops} times");
    }
    // Again it changes nothing, not even by force.
    assert_eq!(run(folder.path(), &whole, false, 0).expect("imports").kept, 2);
    assert!(content(&whole) == wanted);
}

#[test]
fn a_broken_scene_does_not_end_the_others() {
    let folder = tempfile::tempdir().expect("a folder");
    dataset::write(folder.path());
    let infos = folder.path().join("simbev2x/infos/simbev2x_infos_train.json");
    let text = dataset::infos();
    let at = text.rfind("/d/simbev2x/files/GT_DET-3").expect("is there");
    std::fs::write(&infos, [&text[..at], "/d/simbev2x/files/none", &text[at + 26..]].concat())
        .expect("written");
    let store = Store::open("memory:").expect("opens");
    let outcome = run(folder.path(), &store, false, i64::MAX).expect("imports");
    assert_eq!((outcome.made, outcome.failed.len(), outcome.failed[0].0), (1, 1, 1));
    let said = outcome.failed[0].1.to_string();
    assert!(said.contains("files/none: scene 1: vehicle_0 frame 3: "), "{said}");
    assert!(store.manifest(Scope::Scene(1), BoxRow::STAGE).expect("reads").is_none());
    assert!(store.manifest(Scope::Scene(0), BoxRow::STAGE).expect("reads").is_some());
    // Mended, it is another scene than the one that failed: it is imported beside the one that stands.
    std::fs::write(&infos, text).expect("written");
    let outcome = run(folder.path(), &store, false, i64::MAX).expect("imports");
    assert_eq!((outcome.made, outcome.kept), (1, 1));
}

#[test]
fn somebody_elses_store_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    dataset::write(folder.path());
    let store = Store::open("memory:").expect("opens");
    run(folder.path(), &store, false, i64::MAX).expect("imports");
    let before = content(&store);
    let infos = folder.path().join("simbev2x/infos/simbev2x_infos_train.json");
    for (old, new, want) in
        [("Town03", "Town04", "has another scene 0"), ("1.8]", "1.9]", "with other sensors")]
    {
        std::fs::write(&infos, dataset::infos().replace(old, new)).expect("written");
        let refused = run(folder.path(), &store, false, i64::MAX).expect_err("refused");
        assert!(matches!(&refused, ImportError::Refused(why) if why.contains(want)), "{refused}");
    }
    std::fs::write(&infos, dataset::infos()).expect("written");
    let source = Source::open(folder.path()).expect("opens");
    let selection = Selection { scenes: Some(vec![(0, 7)]), ..Selection::default() };
    let refused = prospect(&source, &store, &selection).expect_err("refused").to_string();
    assert!(refused.contains("its infos have no scene 7"), "{refused}");
    assert!(content(&store) == before);
}
