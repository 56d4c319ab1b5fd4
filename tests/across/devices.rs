//! Devices: a scene that a GPU looked at has the CPU's bytes, and a device that is not there is said at once.

use std::collections::BTreeMap;

use convoy_tests::Bench;
use testkit::{Need, skip};

/// A vehicle for a second, at night in rain; its camera looks at one frame: devices in software are slow.
const NIGHT: &str = r#"
name = "devices"
seed = 5

[scenes.train]
"convoy/demo" = 1

[agents]
min_vehicles = 1
max_vehicles = 1
min_rsus = 0
max_rsus = 0

[timing]
warmup_s = 0.5
min_duration_s = 1
max_duration_s = 1

[traffic]
vehicles = 20

[walkers]
count = 20

[world]
radius_m = 120

[weather]
dynamic = false

[weather.initial]
sun_altitude_deg = -20
precipitation = 60
fog_density = 0

[vehicle]
cameras = [{ name = "CAM_FRONT", xyz_m = [0.4, 0.0, 1.6], rpy_deg = [0, 0, 0] }]
radars = []
camera = { width = 160, height = 90, every_n_frames = 20, boxes_2d = true }
lidar = { channels = 16, columns = 256 }
occupancy = { enabled = false }
"#;

/// Sensors' tables with the digests of their bytes. (A manifest counts how often a stage was made again.)
fn tables(bench: &Bench) -> BTreeMap<String, String> {
    bench.digests().into_iter().filter(|(file, _)| file.starts_with("scenes/0000/sensors/")).collect()
}

/// Renders a scene by the CPU and by a usable adapter, which has to see all of it.
fn is_the_same_by_both(config: &str, maps: &[&str]) {
    let Some(number) = gpu::adapters().iter().position(|adapter| gpu::eyes(adapter, None).is_ok()) else {
        skip(
            Need::Vulkan,
            "there is no usable Vulkan adapter (Debian's mesa-vulkan-drivers has one in software)",
        );
        return;
    };
    let bench = Bench::new(config);
    for stage in ["spawn-planner", "simulate-and-log", "render-sensors"] {
        bench.run(stage, &[&["--device", "cpu"], maps].concat()).expect_done();
    }
    let by_cpu = tables(&bench);
    assert!(by_cpu.keys().any(|table| table.contains("RGB-CAM_FRONT")), "{by_cpu:?}");
    let number = number.to_string();
    let again = bench.run("render-sensors", &[&["--device", &number, "--force"], maps].concat());
    again.expect_done();
    let told = again.stderr.lines().find(|line| line.contains("rays by the GPU")).unwrap_or_default();
    assert!(told.contains("rays by the GPU, 0 and 0 by the CPU;"), "{}", again.stderr);
    assert!(!told.contains(": 0 views") && !told.contains("and 0 rays"), "{told}");
    assert_eq!(by_cpu, tables(&bench));
    // Who looked is a remark of the manifest.
    let manifest = std::fs::read_to_string(bench.store().join("scenes/0000/_manifests/render-sensors.json"));
    let (manifest, adapters) = (manifest.expect("is made"), gpu::adapters());
    let adapter = number.parse::<usize>().ok().and_then(|number| adapters.get(number)).expect("is there");
    assert!(manifest.contains(adapter.name()), "{adapter}");
}

#[test]
fn a_night_in_rain_seen_by_a_device_has_the_bytes_of_the_cpu() {
    is_the_same_by_both(NIGHT, &[]);
}

#[test]
fn a_real_town_seen_by_a_device_has_the_bytes_of_the_cpu() {
    let Some(folder) = testkit::maps_folder() else { return };
    let day =
        NIGHT.replace("convoy/demo", "Town10HD").replace("sun_altitude_deg = -20", "sun_altitude_deg = 30");
    is_the_same_by_both(&day, &["--maps", &folder.join("carla").display().to_string()]);
}

#[test]
fn a_device_that_is_not_there_is_said_before_anything_is_made() {
    let bench = Bench::new(NIGHT);
    for stage in ["spawn-planner", "simulate-and-log"] {
        bench.run(stage, &[]).expect_done();
    }
    let before = bench.digests();
    let refused = bench.run("render-sensors", &["--device", "Voodoo 2"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("--device Voodoo 2: there is no such adapter; "), "{}", refused.stderr);
    assert_eq!(before, bench.digests());
    // Stages that look at nothing take the name, which `convoy run` hands to all.
    bench.run("bev-gt", &["--device", "Voodoo 2"]).expect_done();
    // For all stages together it is said before anything is planned.
    let empty = Bench::new(NIGHT);
    let refused = empty.run("convoy", &["run", "--device", "Voodoo 2"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("--device Voodoo 2: there is no such adapter; "), "{}", refused.stderr);
    assert!(empty.digests().is_empty(), "{:?}", empty.digests());
}
