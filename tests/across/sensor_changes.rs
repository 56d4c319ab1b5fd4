//! A changed sensor is rendered again, and no other: what is written, what stays, and that all of it has the
//! bytes of a store that was made from nothing.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::time::{Duration, Instant};

use convoy_tests::{Bench, SMALL};

/// A vehicle with two cameras, two lidars and a semantic one, and a radar; an RSU whose camera tells nothing
/// of objects.
const RIGS: &str = r#"
[weather.initial]
sun_altitude_deg = 30

[vehicle]
cameras = [
    { name = "CAM_FRONT", xyz_m = [0.4, 0.0, 1.6], rpy_deg = [0, 0, 0], width = 64, height = 36 },
    { name = "CAM_BACK", xyz_m = [-0.4, 0.0, 1.6], rpy_deg = [0, 0, 180], width = 66, height = 36 },
]
camera = { depth = true }
lidar = { channels = 8, columns = 64, semantic = true }
lidars = [{ name = "ROOF", columns = 64, channels = 8 }]
radars = [{ name = "RAD_FRONT", xyz_m = [2.4, 0.0, 0.6], rpy_deg = [0, 0, 0] }]
radar = { rays = 64 }
occupancy = { voxel_m = 1 }

[rsu]
cameras = [{ name = "CAM_FRONT", xyz_m = [0.0, 0.0, 3.0], rpy_deg = [0, 0, 0] }]
camera = { width = 68, height = 36, instance = false }
lidar = { channels = 8, columns = 64 }
radar = { rays = 65 }
occupancy = { voxel_m = 1 }
"#;

/// What is changed, the tables of agents that this alters, and whether boxes are judged by any of them.
const CHANGES: [(&str, &str, &str, &[&str], bool); 5] = [
    ("the second lidar", "channels = 8 }]", "channels = 16 }]", &["vehicle_0/ROOF"], true),
    (
        "a camera's size",
        "width = 66",
        "width = 80",
        &["vehicle_0/DPT-CAM_BACK", "vehicle_0/IST-CAM_BACK", "vehicle_0/RGB-CAM_BACK", "vehicle_0/visible"],
        true,
    ),
    (
        "flow",
        "{ depth = true }",
        "{ depth = true, flow = true }",
        &["vehicle_0/FLW-CAM_BACK", "vehicle_0/FLW-CAM_FRONT"],
        false,
    ),
    ("a slower radar", "{ rays = 65 }", "{ rays = 65, every_n_frames = 4 }", &["rsu_0/RAD_FRONT"], true),
    ("a camera that no box is judged by", "width = 68", "width = 70", &["rsu_0/RGB-CAM_FRONT"], false),
];

fn config() -> String {
    format!("{SMALL}{RIGS}")
}

/// The configuration with a change.
fn with(config: &str, old: &str, new: &str) -> String {
    assert_eq!(config.matches(old).count(), 1, "{old}");
    config.replace(old, new)
}

/// With all changes.
fn changed() -> String {
    CHANGES.iter().fold(config(), |config, (_, old, new, ..)| with(&config, old, new))
}

fn run(bench: &Bench) -> String {
    let outcome = bench.run("convoy", &["run", "--threads", "2", "--progress", "none"]);
    outcome.expect_done();
    outcome.stderr
}

/// Every file of the scene, with its number on the disk: a file that is written again has another one.
fn files(bench: &Bench) -> BTreeMap<String, u64> {
    let scene = bench.store().join("scenes/0000");
    let files = walkdir::WalkDir::new(&scene).into_iter().map(|file| file.expect("is listed"));
    files
        .filter(|file| file.file_type().is_file())
        .map(|file| {
            let name = file.path().strip_prefix(&scene).expect("is below").to_string_lossy().into_owned();
            (name, file.metadata().expect("is there").ino())
        })
        .collect()
}

/// Keeps all files of a scene, so that no number is given twice.
fn hold(bench: &Bench, number: usize) {
    let scene = bench.store().join("scenes/0000");
    for (place, file) in files(bench).keys().enumerate() {
        let link = bench.folder.path().join(format!("held-{number}-{place}"));
        fs::hard_link(scene.join(file), link).expect("is linked");
    }
}

#[test]
fn a_changed_sensor_is_rendered_again_and_no_other() {
    let bench = Bench::new(&config());
    run(&bench);
    let original = bench.digests();
    let mut config = config();
    for (number, (what, old, new, tables, is_judged)) in CHANGES.into_iter().enumerate() {
        let (before, digests) = (files(&bench), bench.digests());
        hold(&bench, number);
        config = with(&config, old, new);
        bench.configure(&config);
        let said = run(&bench);
        let after = files(&bench);
        let written: Vec<&str> = after
            .iter()
            .filter(|(name, file)| before.get(*name) != Some(*file))
            .map(|(name, _)| name.as_str())
            .filter(|name| name.starts_with("sensors/") || name.starts_with("stats/render-sensors"))
            .collect();
        let agent = tables[0].split('/').next().expect("is an agent");
        let mut expected: Vec<String> =
            tables.iter().map(|table| format!("sensors/{table}.parquet")).collect();
        expected.push(format!("stats/render-sensors.{agent}.parquet"));
        assert_eq!(written, expected, "{what}: {said}");
        // The others were not touched, and nothing went.
        let now = bench.digests();
        let stays = |name: &&String| name.contains("/sensors/") && !tables.iter().any(|t| name.contains(t));
        assert!(digests.keys().filter(stays).all(|name| digests[name] == now[name]), "{what}");
        let judged = "_manifests/postprocess-valid.json";
        assert_eq!(before[judged] != after[judged], is_judged, "{what}: {said}");
        bench.run("convoy", &["verify"]).expect_done();
    }
    let fresh = Bench::new(&config);
    run(&fresh);
    assert_eq!(bench.digests(), fresh.digests(), "as from nothing");
    // All of it taken back at once; what is no longer asked for goes.
    bench.configure(&self::config());
    run(&bench);
    assert_eq!(bench.digests(), original);
}

/// Runs the sensors and kills them as soon as something is the case, or after some time.
fn kill_when(bench: &Bench, patience: Duration, is_so: impl Fn() -> bool) {
    let mut child = bench.start("render-sensors", &["--threads", "2"]);
    let start = Instant::now();
    while child.try_wait().expect("can be asked").is_none() && start.elapsed() < patience && !is_so() {
        std::thread::sleep(Duration::from_millis(1));
    }
    // It may have ended by itself.
    let _ = child.kill();
    child.wait().expect("is reaped");
}

#[test]
fn a_change_that_is_killed_again_and_again_ends_with_the_same_bytes() {
    let fresh = Bench::new(&changed());
    run(&fresh);
    let expected = fresh.digests();

    let bench = Bench::new(&config());
    run(&bench);
    let manifests = bench.store().join("scenes/0000/_manifests");
    let (record, unit) =
        (manifests.join("render-sensors.redo.json"), manifests.join("render-sensors.parts/vehicle_0.json"));
    let long = Duration::from_secs(60);
    // The old manifest is aside, and not all shards are replaced; then a unit is whole.
    bench.configure(&changed());
    bench.run("spawn-planner", &[]).expect_done();
    kill_when(&bench, long, || record.exists());
    kill_when(&bench, long, || unit.exists());
    // Something else is wanted, and what it makes is killed, too.
    bench.configure(&with(&config(), "{ depth = true }", "{ depth = true, flow = true, semantic = true }"));
    kill_when(&bench, long, || unit.exists() && fs::read_to_string(&unit).is_ok_and(|u| u.contains("SEG-C")));
    bench.configure(&changed());
    let mut patience = Duration::from_millis(50);
    for _ in 0..8 {
        kill_when(&bench, patience, || false);
        patience = patience * 8 / 5;
    }
    run(&bench);
    assert_eq!(bench.digests(), expected);
    bench.run("convoy", &["verify"]).expect_done();
}
