//! `check` finds nothing in a store as it was made, and finds each fault that is planted in a copy of it.

mod arrays;
mod tables;
mod tools;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use codecs::NpzReader;
use convoy_tests::{Bench, Outcome, TINY, program};
use parquet::arrow::arrow_reader::ArrowReaderMetadata;
use rayon::prelude::*;

use arrays::OF_ARRAYS;
use tables::{OF_SELDOM, OF_SENSORS, OF_SUMS, OF_TABLES};
use tools::{Plant, copied, sensor, table};

/// Runs the check on a store.
fn checked(store: &Path, every: &str) -> Outcome {
    let mut command = Command::new(program("check"));
    command.arg("--store").arg(store).args(["--every", every, "--threads", "1"]);
    Outcome::of(&command.output().expect("the program starts"))
}

/// How much of a check is off, by the report's table.
fn off(report: &str, rule: &str) -> u64 {
    let line = report.lines().find(|line| {
        line.strip_prefix(rule).is_some_and(|rest| {
            rest.starts_with("  ") && rest.trim_start().starts_with(|c: char| c.is_ascii_digit())
        })
    });
    let mut numbers = line.unwrap_or_default()[line.map_or(0, |_| rule.len())..].split_whitespace();
    numbers.nth(1).map_or(0, |number| number.parse().expect("a number"))
}

#[test]
fn an_unfinished_store_does_not_pass() {
    let bench = Bench::new(&TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2"));
    bench.run("spawn-planner", &[]).expect_done();
    let of_plan = checked(&bench.store(), "1");
    assert!(of_plan.code == 2 && of_plan.stderr.contains("no scene is begun"), "{of_plan:?}");
    bench.run("simulate-and-log", &["--scenes", "1"]).expect_done();
    let told = checked(&bench.store(), "1");
    assert_eq!(told.code, 3, "{}{}", told.stdout, told.stderr);
    assert!(!told.stdout.contains("Nothing is wrong"), "{}", told.stdout);
    let lines = [
        "  simulate-and-log: not done in 1 of 2 scenes\n  render-sensors: not done in 2 of 2 scenes\n",
        "\nUNFINISHED: what is there is right, but something is not there (2 of 2 scenes, the statistics)",
    ];
    assert!(lines.iter().all(|line| told.stdout.contains(line)), "{}", told.stdout);
}

#[test]
fn each_planted_fault_is_found() {
    let exact = "
[vehicle.gnss]
noise_latitude_deg = 0
noise_longitude_deg = 0
noise_altitude_m = 0

[vehicle.imu]
noise_accel_mps2 = 0
gyro_bias_radps = 0
noise_gyro_radps = 0
";
    let scans = "
[[vehicle.lidars]]
name = \"TURNING\"
channels = 16
columns = 256
semantic = true
rolling = true
rolling_slices = 32
rolling_compensated = false
beam_rays = 7
returns = [\"first\", \"strongest\", \"last\"]
weather = true

[[vehicle.lidars]]
name = \"SMOOTH\"
channels = 16
columns = 256
semantic = true
noise_m = 0
rolling = true
rolling_slices = 32
beam_rays = 7
glass = true
";
    let config = TINY
        .replace("flow = true\n", "flow = true\nboxes_2d = true\n")
        .replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nobserved = true\nids = true\nflow = true\n")
        .replace("[rsu.occupancy]\n", "[rsu.occupancy]\nsparse = true\nids = true\nflow = true\n")
        .replace("sun_altitude_deg = 30\n", "sun_altitude_deg = 30\nfog_density = 100\nprecipitation = 60\n");
    let layers = "\n[bev]\nids = true\nheights = true\npaint = true\n";
    let bench = Bench::new(&format!("{config}{scans}{exact}{layers}"));
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let store = bench.store();
    let whole = checked(&store, "1");
    assert!(whole.stdout.ends_with("\nNothing is wrong.\n"), "{}", whole.stdout);
    let before = checked(&store, "10");
    assert!(before.stdout.contains("voxels: LIDAR: it has noise"), "{}", before.stdout);
    assert!(before.stdout.contains("voxels: SEG-SMOOTH: of what moves"), "{}", before.stdout);
    assert!(before.stdout.contains("gnss: rsu: carries none"), "{}", before.stdout);

    let plants = [OF_TABLES, OF_SENSORS, OF_ARRAYS].concat();
    let plants: Vec<(&Plant, &str, &Outcome)> =
        plants.iter().map(|p| (p, "10", &before)).chain(OF_SUMS.iter().map(|p| (p, "1", &whole))).collect();
    let unfound: Vec<String> = plants
        .par_iter()
        .enumerate()
        .filter_map(|(k, ((rule, words, plant), every, before))| {
            let copy = bench.folder.path().join(format!("copy-{k}"));
            copied(&store, &copy);
            plant(&copy);
            let after = checked(&copy, every);
            fs::remove_dir_all(&copy).expect("goes");
            let (was, is) = (off(&before.stdout, rule), off(&after.stdout, rule));
            let found = after.code == 1 && is > was && (was > 0 || after.stdout.contains(words));
            (!found).then(|| {
                format!("{rule} ({words}): {was} before, {is} after\n{}{}", after.stdout, after.stderr)
            })
        })
        .collect();
    assert!(unfound.is_empty(), "{}", unfound.join("\n"));
    let lines = whole.stdout.lines().skip_while(|line| !line.starts_with("check ")).skip(1);
    let rules =
        lines.take_while(|line| !line.is_empty()).map(|line| line.split("  ").next().unwrap_or_default());
    let faulty: Vec<&str> = rules.filter(|rule| off(&whole.stdout, rule) > 0).collect();
    assert_eq!(faulty, [""; 0], "{}", whole.stdout);
}

/// [`TINY`] with everything at a rate of its own, and cameras with lenses.
fn seldom() -> String {
    let cameras = r#"cameras = [
  { name = "CAM_FRONT", xyz_m = [0.6, 0.0, 1.6], fx = 90, fy = 95, cx = 71.5, cy = 50.25 },
  { name = "CAM_BENT", xyz_m = [0.6, 0.0, 1.6], fx = 120, lens = "brown", distortion = [-0.28, 0.09, 1e-3, -5e-4, -0.01] },
  { name = "CAM_WIDE", xyz_m = [0.0, 0.4, 1.7], rpy_deg = [0, 0, 90], lens = "fisheye", fov_deg = 190, distortion = [-0.02, 0.004, 0, 0] },
  { name = "CAM_SMALL", xyz_m = [-1.0, 0.0, 1.6], rpy_deg = [0, 0, 180], width = 96, height = 64, fov_deg = 60 },
]
"#;
    let with = |text: &str, table: &str, keys: &str| {
        assert_eq!(text.matches(table).count(), 1, "{table}");
        text.replace(table, &format!("{keys}{table}"))
    };
    let text = with(TINY, "[vehicle.camera]\n", &format!("[vehicle]\n{cameras}\n"));
    let text = text.replace(
        "[vehicle.camera]\n",
        "[vehicle.camera]\nevery_n_frames = 2\nboxes_2d = true\nflow_half = true\n",
    );
    let text = text
        .replace("[vehicle.lidar]\n", "[vehicle.lidar]\nevery_n_frames = 2\nsemantic_every_n_frames = 4\n");
    let text =
        text.replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nevery_n_frames = 4\nobserved = true\n");
    let more = "[vehicle.radar]\nevery_n_frames = 3\n[vehicle.gnss]\nevery_n_frames = 5\n[vehicle.imu]\nevery_n_frames = 2\n\
                [annotation]\nevery_n_frames = 2\n[bev]\nevery_n_frames = 4\n";
    format!("{text}\n{more}")
}

#[test]
fn part_rates_lenses_and_half_floats_are_held_to() {
    let bench = Bench::new(&seldom());
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let store = bench.store();
    let whole = checked(&store, "1");
    assert_eq!(whole.code, 0, "{}{}", whole.stdout, whole.stderr);
    let rows = |path: PathBuf| -> i64 {
        let file = File::open(path).expect("opens");
        ArrowReaderMetadata::load(&file, Default::default())
            .expect("is a table")
            .metadata()
            .file_metadata()
            .num_rows()
    };
    // Of 20 frames.
    for (name, want) in [
        ("LIDAR", 10),
        ("SEG-LIDAR", 5),
        ("RAD_FRONT", 7),
        ("GNSS", 4),
        ("IMU", 10),
        ("RGB-CAM_WIDE", 10),
        ("FLW-CAM_BENT", 10),
    ] {
        assert_eq!(rows(sensor(&store, name)), want, "{name}");
    }
    assert_eq!(rows(table(&store, "agents")), 40);
    for (folder, want) in [("bev", 5), ("occupancy", 5), ("occupancy_filled", 5)] {
        let archive = File::open(store.join(format!("scenes/0000/{folder}/vehicle_0.npz"))).expect("opens");
        assert_eq!(NpzReader::new(archive).expect("is one").members().len(), want, "{folder}");
    }
    let unfound: Vec<String> = OF_SELDOM
        .iter()
        .enumerate()
        .filter_map(|(k, (rule, words, plant))| {
            let copy = bench.folder.path().join(format!("seldom-{k}"));
            copied(&store, &copy);
            plant(&copy);
            let after = checked(&copy, "1");
            fs::remove_dir_all(&copy).expect("goes");
            let found = after.code == 1 && off(&after.stdout, rule) > 0 && after.stdout.contains(words);
            (!found).then(|| format!("{rule} ({words}):\n{}{}", after.stdout, after.stderr))
        })
        .collect();
    assert!(unfound.is_empty(), "{}", unfound.join("\n"));
}

#[test]
fn what_is_no_store_is_told_from_a_faulty_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let outcome = checked(folder.path(), "1");
    assert_eq!(outcome.code, 2, "{outcome:?}");
    assert!(outcome.stderr.contains("dataset.json"), "{outcome:?}");
}

#[test]
fn what_options_leave_out_is_said_and_no_fault() {
    let config = TINY
        .replace("[vehicle.occupancy]\n", "[vehicle.occupancy]\nsparse = true\nobserved = true\n")
        .replace("[rsu.occupancy]\n", "[rsu.occupancy]\nfull_sweep = false\n")
        .replace("[rsu.lidar]\n", "[rsu.lidar]\nsemantic = true\n");
    let bench = Bench::new(&format!("{config}\n[bev]\nclasses = [\"car\", \"road\"]\n"));
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let found = checked(&bench.store(), "1");
    for said in ["masks have chosen classes", "filling: vehicle_0: cells are listed", "voxels: sweeps find"] {
        assert!(found.stdout.contains(said), "{said}: {}", found.stdout);
    }
    found.expect_done();
}
