//! The layout `nuscenes`.

use std::path::Path;

use convoy_tests::{Bench, check_in_devkit, check_in_python, digests, program};

use super::export;

pub(super) fn check(bench: &Bench) {
    let (dest, outcome) = export(bench, "nuscenes", "nuscenes", &["--threads", "2"]);
    outcome.expect_done();
    read_back(bench, &dest, "60");
    let pictures = bench.folder.path().join("pictures");
    let (store, judge) = (bench.store(), program("evaluate"));
    check_in_devkit("exports/nuscenes_devkit.py", &[&dest, &pictures, &store, &judge]);
    // The tables are the same for any number of threads.
    let (one, outcome) = export(bench, "nuscenes", "nuscenes-one", &["--threads", "1"]);
    outcome.expect_done();
    assert_eq!(digests(&dest), digests(&one));
    // Everything: readings between samples, boxes that nobody sees.
    let all = [
        "--version-name",
        "v1.0-trainval",
        "--sweeps",
        "lidar,radar,camera",
        "--radius",
        "100",
        "--empty-boxes",
        "--infos",
        "mmdet3d",
    ];
    let (all, outcome) = export(bench, "nuscenes", "nuscenes-all", &all);
    outcome.expect_done();
    read_back(bench, &all, "-100");
    check_in_python("exports/infos.py", &["numpy"], &[&all]);
    // Another version leaves nothing of the one before.
    let named = |name: &'static str, dest: &str| {
        let args = ["--no-map-mask", "--sensors", "LIDAR", "--version-name", name, "--force"];
        let (dest, outcome) = export(bench, "nuscenes", dest, &args);
        outcome.expect_done();
        dest
    };
    let renamed = named("v1.0-first", "nuscenes-renamed");
    assert!(renamed.join("v1.0-first/sample.json").is_file());
    named("v1.0-second", "nuscenes-renamed");
    assert!(!renamed.join("v1.0-first").exists() && !renamed.join("lidarseg/v1.0-first").exists());
    assert_eq!(digests(&renamed), digests(&named("v1.0-second", "nuscenes-fresh")));
    // No more than must be.
    let least = ["--no-lidarseg", "--no-map-mask", "--sensors", "LIDAR,RGB-*", "--agents", "rsu_0"];
    let (least, outcome) = export(bench, "nuscenes", "nuscenes-least", &least);
    outcome.expect_done();
    read_back(bench, &least, "60");
    let (_, refused) = export(bench, "nuscenes", "nuscenes-blind", &["--sensors", "RGB-*"]);
    assert!(refused.stderr.contains("has no lidar"), "{}", refused.stderr);
    let (_, refused) = export(bench, "nuscenes", "nuscenes-named", &["--version-name", "a/b"]);
    assert!(refused.code == 2 && refused.stderr.contains("version `a/b`"), "{}", refused.stderr);
}

fn read_back(bench: &Bench, dest: &Path, radius: &str) {
    let packages = ["numpy", "pyarrow", "PIL"];
    check_in_python("exports/nuscenes.py", &packages, &[&bench.store(), dest, Path::new(radius)]);
}
