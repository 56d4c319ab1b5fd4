//! Agents that carry different sensors, and sensors that are added to a finished scene.

use convoy_tests::{Bench, workspace};
use schema::AgentId;
use schema::tables::LidarRow;
use store::{Scope, Store};

/// Two vehicles for half a second, the second one with sensors of its own.
const TWO: &str = r#"
name = "rigs"
seed = 12

[scenes.train]
"convoy/demo" = 1

[agents]
min_vehicles = 2
max_vehicles = 2
min_rsus = 0
max_rsus = 0

[timing]
warmup_s = 0.5
min_duration_s = 1
max_duration_s = 1

[traffic]
vehicles = 6

[walkers]
count = 4

[world]
radius_m = 120

[vehicle]
cameras = [{ name = "CAM_FRONT", xyz_m = [0.4, 0.0, 1.6], rpy_deg = [0, 0, 0] }]
radars = []
camera = { width = 64, height = 36 }
lidar = { channels = 16, columns = 128 }
occupancy = { voxel_m = 1 }

[[rigs]]
agents = ["vehicle_1"]
cameras = [{ name = "CAM_REAR", xyz_m = [-0.4, 0.0, 1.6], rpy_deg = [0, 0, 180] }]
radars = []
camera = { width = 96, height = 54, instance = false }
lidar = { channels = 4, columns = 256 }
occupancy = { voxel_m = 2 }
"#;

fn run_all(bench: &Bench) {
    bench.run("convoy", &["run", "--threads", "2", "--progress", "none"]).expect_done();
}

/// Names of the sensor tables of a vehicle, of all the store's files.
fn tables(bench: &Bench, vehicle: u16) -> Vec<String> {
    let folder = format!("scenes/0000/sensors/vehicle_{vehicle}/");
    let files = bench.digests();
    files.keys().filter_map(|f| Some(f.strip_prefix(&folder)?.strip_suffix(".parquet")?.to_owned())).collect()
}

/// Beams that some ray came back on, and the most points of a sweep.
fn sweeps(bench: &Bench, vehicle: u16) -> (u16, usize) {
    let store = Store::open(bench.store()).expect("is a folder");
    let manifest = store.manifest(Scope::Scene(0), "render-sensors").expect("reads").expect("is there");
    let key = store::keys::sensor(0, AgentId::vehicle(vehicle), "LIDAR");
    let rows: Vec<LidarRow> = store.read_rows(&manifest, &key).expect("sweeps");
    assert_eq!(rows.len(), 20);
    let last = rows.iter().flat_map(|r| &r.ring).max().copied().expect("points");
    (last + 1, rows.iter().map(|r| r.ring.len()).max().unwrap_or(0))
}

#[test]
fn each_agent_carries_its_own_sensors_and_more_can_be_added() {
    let bench = Bench::new(TWO);
    run_all(&bench);
    assert_eq!(tables(&bench, 0), ["GNSS", "IMU", "IST-CAM_FRONT", "LIDAR", "RGB-CAM_FRONT", "visible"]);
    assert_eq!(tables(&bench, 1), ["GNSS", "IMU", "LIDAR", "RGB-CAM_REAR"]);
    let (beams, points) = sweeps(&bench, 0);
    assert!(beams <= 16 && beams > 4 && points <= 16 * 128, "{beams} {points}");
    let (beams, points) = sweeps(&bench, 1);
    assert!(beams <= 4 && points <= 4 * 256, "{beams} {points}");

    // Adding sensors changes no byte of what is there but the manifests of the stages that ran again.
    let before = bench.digests();
    bench.configure(
        &TWO.replace("height = 36", "height = 36, depth = true")
            .replace("width = 96", "semantic = true, width = 96"),
    );
    run_all(&bench);
    let after = bench.digests();
    let new: Vec<&str> = after.keys().filter(|k| !before.contains_key(*k)).map(String::as_str).collect();
    assert_eq!(
        new,
        [
            "scenes/0000/sensors/vehicle_0/DPT-CAM_FRONT.parquet",
            "scenes/0000/sensors/vehicle_1/SEG-CAM_REAR.parquet"
        ]
    );
    let changed = before.iter().filter(|(k, digest)| after.get(*k) != Some(digest)).map(|(k, _)| k.as_str());
    let manifests = ["render-sensors", "postprocess-valid", "merge-tracks"]
        .map(|s| format!("scenes/0000/_manifests/{s}.json"));
    let allowed = |k: &str| {
        // The plan's manifest names dataset.json, which goes with it and holds the whole configuration.
        // The card names the sensors.
        ["dataset.json", "plan/_manifest.json", "README.md"].contains(&k)
            || k.starts_with("stats/")
            || k.starts_with("scenes/0000/stats/render-sensors.")
            || manifests.iter().any(|m| m == k)
    };
    let wrong: Vec<&str> = changed.filter(|k| !allowed(k)).collect();
    assert_eq!(wrong, [""; 0]);
}

/// One frame of each rig that comes with the programs: a row of each of its sensors.
#[test]
fn shipped_rigs_render_a_frame() {
    let rigs = workspace().join("configs/rigs");
    for (kind, other, rig, cameras, others) in [
        ("vehicle", "rsu", "simbev2x-vehicle", 6, 7),
        ("rsu", "vehicle", "simbev2x-rsu", 3, 2),
        ("vehicle", "rsu", "opv2v", 4, 3),
        ("rsu", "vehicle", "opv2v-rsu", 4, 1),
        ("vehicle", "rsu", "nuscenes", 6, 8),
    ] {
        let path = rigs.join(format!("{rig}.toml"));
        // The frames after the first are nobody's; encoding is what takes time, so colour alone.
        let seldom = "every_n_frames = 1000";
        let text = format!(
            "{}\n[{kind}]\nrig = '{}'\ncamera = {{ {seldom}, rgb = true, instance = false }}\nlidar = {{ {seldom} }}\n\
             radar = {{ {seldom} }}\ngnss = {{ {seldom} }}\nimu = {{ {seldom} }}\n[{other}]\ncameras = []\nradars = []\nlidar = {{ enabled = false }}\n",
            convoy_tests::SMALL,
            path.display()
        );
        let bench = Bench::new(&text);
        for stage in ["spawn-planner", "simulate-and-log", "render-sensors"] {
            bench.run(stage, &[]).expect_done();
        }
        let store = Store::open(bench.store()).expect("is a folder");
        let manifest = store.manifest(Scope::Scene(0), "render-sensors").expect("reads").expect("is there");
        let of_agent = format!("/{kind}_0/");
        let outputs: Vec<_> = manifest
            .outputs
            .iter()
            .filter(|o| o.key.contains(&of_agent) && o.key.contains("/sensors/"))
            .collect();
        assert!(outputs.iter().all(|o| o.rows == 1), "{rig}: {outputs:?}");
        let pictures = outputs.iter().filter(|o| o.key.contains("RGB-")).count();
        assert_eq!((pictures, outputs.len() - pictures), (cameras, others), "{rig}: {outputs:?}");
    }
}
