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
lidar = { channels = 8, columns = 128 }
occupancy = { enabled = false }
"#;

/// Sensors' tables with the digests of their bytes. (A manifest counts how often a stage was made again.)
fn tables(bench: &Bench) -> BTreeMap<String, String> {
    bench.digests().into_iter().filter(|(file, _)| file.starts_with("scenes/0000/sensors/")).collect()
}

#[test]
fn a_scene_seen_by_a_device_has_the_bytes_of_the_cpu() {
    let Some(number) = gpu::adapters().iter().position(|adapter| gpu::eyes(adapter).is_ok()) else {
        skip(
            Need::Vulkan,
            "there is no usable Vulkan adapter (Debian's mesa-vulkan-drivers has one in software)",
        );
        return;
    };
    let bench = Bench::new(NIGHT);
    for stage in ["spawn-planner", "simulate-and-log", "render-sensors"] {
        bench.run(stage, &["--device", "cpu"]).expect_done();
    }
    let by_cpu = tables(&bench);
    assert!(by_cpu.keys().any(|table| table.contains("RGB-CAM_FRONT")), "{by_cpu:?}");
    let again = bench.run("render-sensors", &["--device", &number.to_string(), "--force"]);
    again.expect_done();
    let told = again.stderr.lines().find(|line| line.contains("views seen by the GPU")).unwrap_or_default();
    assert!(told.contains("views seen by the GPU, 0 by the CPU"), "{}", again.stderr);
    assert!(!told.contains(": 0 views"), "{told}");
    assert_eq!(by_cpu, tables(&bench));
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
}
