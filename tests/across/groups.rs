//! A dataset of unlike scenes: each group's scenes follow its settings, and a change of one leaves the
//! others.

use std::collections::BTreeMap;
use std::time::SystemTime;

use convoy_tests::{Bench, LEAN, Outcome, check_in_python};
use schema::tables::PlanSceneRow;
use store::{Scope, Store, keys};

use crate::slips::words;

/// A scene of no group, one in rain, and one without traffic that looks through a camera.
fn config() -> String {
    format!(
        "{LEAN}\n[store]\nask_beyond_s = 0\n[[groups]]\nname = \"rain\"\n[groups.scenes.train]\n\"convoy/demo\" = 1\n\
         [groups.weather.initial]\nprecipitation = 80\n[[groups]]\nname = \"empty\"\n[groups.scenes.val]\n\"convoy/demo\" = 1\n\
         [groups.traffic]\nvehicles = 0\n[groups.vehicle.camera]\nenabled = true\nwidth = 96\nheight = 54\n"
    )
}

fn run(bench: &Bench, args: &[&str]) -> Outcome {
    bench.run("convoy", &[&["run", "--progress", "none"], args].concat())
}

/// When each file of a scene was written.
fn written(bench: &Bench, scene: u32) -> BTreeMap<String, SystemTime> {
    let folder = bench.store().join(format!("scenes/{scene:04}"));
    let files = walkdir::WalkDir::new(&folder).into_iter().map(|entry| entry.expect("is there"));
    let files = files.filter(|entry| entry.file_type().is_file());
    files
        .map(|file| {
            let written = file.metadata().expect("is there").modified().expect("is known");
            (file.path().display().to_string(), written)
        })
        .collect()
}

fn plan(bench: &Bench) -> Vec<PlanSceneRow> {
    let store = Store::open(bench.store()).expect("opens");
    let manifest = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is planned");
    store.read_rows(&manifest, keys::PLAN_SCENES).expect("reads")
}

#[test]
fn groups_differ_and_change_alone() {
    let config = config();
    let bench = Bench::new(&config);
    let forecast = bench.run("spawn-planner", &["--dry-run"]);
    forecast.expect_done();
    for kind in ["no group: 1 scenes, 20 frames", "rain: 1 scenes, 20 frames", "empty: 1 scenes, 20 frames"] {
        assert!(forecast.stdout.contains(kind), "{kind}: {}", forecast.stdout);
    }
    run(&bench, &[]).expect_done();
    let scenes = plan(&bench);
    let vehicles: Vec<Option<i32>> = scenes.iter().map(|scene| scene.background_vehicles).collect();
    assert_eq!(vehicles, [Some(12), Some(12), Some(0)]);
    assert_eq!(scenes[1].initial_weather.precipitation, 80.0);
    assert_ne!(scenes[0].initial_weather.precipitation, 80.0);
    let has_camera = |scene: u32| {
        let path = format!("scenes/{scene:04}/sensors/vehicle_0/RGB-CAM_FRONT.parquet");
        bench.store().join(path).exists()
    };
    assert_eq!([0, 1, 2].map(has_camera), [false, false, true]);
    let status = bench.run("convoy", &["status"]);
    status.expect_done();
    assert!(
        status.stdout.contains("edition and group") && status.stdout.contains("  0 rain"),
        "{}",
        status.stdout
    );
    let by_group =
        std::fs::read_to_string(bench.store().join("stats/scenes_by_group.csv")).expect("is written");
    // Whether there is a light for an RSU follows from where a scene is.
    let counts: Vec<&str> = by_group.lines().filter_map(|line| Some(line.rsplit_once(',')?.0)).collect();
    assert_eq!(counts, ["group,scenes,frames,vehicles", "empty,1,20,1", "no group,1,20,1", "rain,1,20,1"]);
    check_in_python("groups.py", &["pyarrow"], &[&bench.store()]);

    // Other rain: the scenes of the others are not touched, and the question is about that scene alone.
    let before: Vec<_> = [0, 1, 2].map(|scene| written(&bench, scene)).into();
    let digests = bench.digests();
    bench.configure(&config.replace("precipitation = 80", "precipitation = 30"));
    let asked = run(&bench, &[]);
    assert_eq!(asked.code, 2, "{asked:?}");
    insta::assert_snapshot!("run-with-another-group", words(&bench, &asked));
    assert!(bench.digests() == digests, "nothing was touched");
    run(&bench, &["--redo"]).expect_done();
    let after: Vec<_> = [0, 1, 2].map(|scene| written(&bench, scene)).into();
    assert_eq!((&after[0], &after[2]), (&before[0], &before[2]));
    assert!(after[1].values().max() > before[1].values().max());

    // The result is that of a run from nothing.
    let fresh = Bench::new(&config.replace("precipitation = 80", "precipitation = 30"));
    run(&fresh, &[]).expect_done();
    let made = |bench: &Bench| -> BTreeMap<String, String> {
        let is_data = |name: &String| !name.contains("_manifests") && !name.ends_with("_manifest.json");
        bench.digests().into_iter().filter(|(name, _)| is_data(name) && name.starts_with("scenes/")).collect()
    };
    assert_eq!(made(&bench), made(&fresh));

    // A group that is gone, with scenes that are made: they are named, and nothing is touched.
    let digests = bench.digests();
    bench.configure(&config.replace("name = \"rain\"", "name = \"snow\""));
    let lost = run(&bench, &["--redo"]);
    assert_eq!(lost.code, 2, "{lost:?}");
    insta::assert_snapshot!("run-without-a-group", words(&bench, &lost));
    assert!(bench.digests() == digests, "nothing was touched");
}
