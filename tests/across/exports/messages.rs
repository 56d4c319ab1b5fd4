//! What exports say of themselves, and how they refuse: whole messages. `INSTA_UPDATE=always` writes them
//! anew.

use std::fs;

use convoy_tests::{Bench, Outcome};

use super::{LAYOUTS, export};

/// What was said, without times and where this test runs.
fn said(bench: &Bench, text: &str) -> String {
    let folder = bench.folder.path().display().to_string();
    let line = |line: &str| line.split_once("ERROR ").map_or(line, |(_, rest)| rest).to_owned();
    text.replace(&folder, "FOLDER").lines().map(line).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn refused(bench: &Bench, outcome: &Outcome) -> String {
    assert_eq!(outcome.code, 2, "{outcome:?}");
    said(bench, &outcome.stderr)
}

/// The lines on what is left out, and on what is otherwise than one may think.
fn summary(bench: &Bench, layout: &str, args: &[&str]) -> String {
    let (_, outcome) = export(bench, layout, "nowhere", &[&["--dry-run"], args].concat());
    outcome.expect_done();
    let about = |line: &&str| line.starts_with("left out: ") || line.starts_with("note: ");
    said(bench, &outcome.stdout.lines().filter(about).collect::<Vec<_>>().join("\n"))
}

pub(super) fn check(bench: &Bench) {
    for layout in LAYOUTS {
        insta::assert_snapshot!(format!("export-summary-{layout}"), summary(bench, layout, &[]));
    }
    insta::assert_snapshot!("export-summary-opv2v-lidar", summary(bench, "opv2v", &["--sensors", "LIDAR"]));

    export(bench, "mcap", "mine", &["--agents", "vehicle_0", "--every", "10"]).1.expect_done();
    let (_, other) =
        export(bench, "mcap", "mine", &["--agents", "vehicle_0,rsu_*", "--voxel-block", "2", "--depth"]);
    insta::assert_snapshot!("export-of-other-options", refused(bench, &other));
    let (_, strange) = export(bench, "mcap", "store", &[]);
    let strange = refused(bench, &strange);
    assert!(strange.contains("already, which no export made: choose another folder"), "{strange}");
    for (name, args) in [
        ("export-of-unknown-scenes", ["--scenes", "0,7-9"]),
        ("export-of-unknown-agents", ["--agents", "vehicle_7,rsu_9"]),
    ] {
        insta::assert_snapshot!(name, refused(bench, &export(bench, "mcap", "nowhere", &args).1));
    }
    one_at_a_time(bench);
}

/// A folder in which another export is at work is left alone; that of one that has ended is taken over.
fn one_at_a_time(bench: &Bench) {
    let lock = bench.folder.path().join("mine/.convoy-export/lock.json");
    let put = |host: &str, process: u32| {
        let text =
            format!("{{\"host\": \"{host}\", \"process\": {process}, \"began\": 7, \"layout\": \"mcap\"}}");
        fs::write(&lock, text).expect("is written");
    };
    let again = || export(bench, "mcap", "mine", &["--agents", "vehicle_0", "--every", "10", "--force"]).1;
    put("elsewhere", 4711);
    insta::assert_snapshot!("export-beside-another", refused(bench, &again()));
    assert!(lock.is_file());
    // This process began at another time.
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    put(host.trim(), std::process::id());
    again().expect_done();
    assert!(!lock.exists(), "it is given back");
}
