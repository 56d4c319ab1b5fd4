//! Exports of several scenes, splits, vehicles and RSUs: read back, grown scene by scene, killed and gone on
//! with.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use convoy_tests::{Bench, TINY, check_in_python, digests};

use super::{LAYOUTS, command, export};

/// Makes an export of `simbev2x` the same wherever it stands.
const PREFIX: [&str; 2] = ["--path-prefix", "/data/convoy"];

/// Two scenes, one in each of two splits, with two vehicles and two RSUs each.
fn store() -> Bench {
    let mut config = TINY.replace("flow = true\n", "");
    for agents in ["vehicles", "rsus"] {
        for end in ["min", "max"] {
            config = config.replace(&format!("{end}_{agents} = 1"), &format!("{end}_{agents} = 2"));
        }
    }
    let config = config.replace("[agents]", "[scenes.val]\n\"convoy/demo\" = 1\n\n[agents]");
    let bench = Bench::new(&config);
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    bench
}

#[test]
fn several_scenes_splits_and_rsus() {
    let bench = store();
    for layout in LAYOUTS {
        let whole = made(&bench, layout, "whole", &[]);
        reads_back(&bench, layout, &whole);
        let bytes = digests(&whole);
        // What grows is the same for all layouts, what is written at the end is not.
        let ahead = (layout == "kitti").then_some(("ahead", ["0", "0-1"]));
        for (dest, order) in ahead.into_iter().chain([("backwards", ["1", "0,1"])]) {
            let mut grown = PathBuf::new();
            for scenes in order {
                grown = made(&bench, layout, dest, &["--scenes", scenes]);
            }
            assert_eq!(bytes, digests(&grown), "{layout}: scenes {} first", order[0]);
            fs::remove_dir_all(grown).expect("is removed");
        }
        if ["mcap", "nuscenes"].contains(&layout) {
            assert_eq!(bytes, digests(&killed(&bench, layout)), "{layout}: killed");
        }
    }
}

fn options(layout: &str) -> &'static [&'static str] {
    if layout == "simbev2x" { &PREFIX } else { &[] }
}

/// An export of a layout in a folder of its own.
fn made(bench: &Bench, layout: &str, dest: &str, args: &[&str]) -> PathBuf {
    let args = [options(layout), args].concat();
    let (dest, outcome) = export(bench, layout, &format!("{dest}-{layout}"), &args);
    outcome.expect_done();
    dest
}

/// The independent reader of a layout finds nothing wrong.
fn reads_back(bench: &Bench, layout: &str, dest: &Path) {
    let store = bench.store();
    let (script, args): (&str, Vec<&Path>) = match layout {
        "opv2v" | "v2x-real" => ("exports/opv2v.py", vec![&store, dest]),
        "nuscenes" => ("exports/nuscenes.py", vec![&store, dest, Path::new("60")]),
        "mcap" => ("exports/mcap.py", vec![&store, dest]),
        "kitti" => ("exports/kitti.py", vec![&store, dest]),
        "simbev2x" => {
            let processed = made_in_place(bench, "processed", &[]);
            let raw = made_in_place(bench, "raw", &["--state", "raw"]);
            let packages = ["numpy", "pyarrow", "PIL"];
            check_in_python("exports/simbev2x.py", &packages, &[&store, &processed, &raw]);
            return;
        }
        other => panic!("say how {other} is read back"),
    };
    check_in_python(script, &["numpy", "pyarrow", "PIL"], &args);
    if layout == "v2x-real" {
        for scenario in ["train/scene_0000", "validate/scene_0001"] {
            for rsu in ["-1", "-2"] {
                let frame = dest.join("V2X-Real").join(scenario).join(rsu).join("000000.bin");
                assert!(frame.is_file(), "{}", frame.display());
            }
        }
    }
}

/// An export of `simbev2x` whose files are named as they stand.
fn made_in_place(bench: &Bench, dest: &str, args: &[&str]) -> PathBuf {
    let (dest, outcome) = export(bench, "simbev2x", dest, args);
    outcome.expect_done();
    dest
}

/// An export that is killed without warning when it has a part in hand, again when a part is finished, and
/// then gone on with.
fn killed(bench: &Bench, layout: &str) -> PathBuf {
    let dest = bench.folder.path().join(format!("killed-{layout}"));
    // A busy machine may let it end before it is looked at.
    let early = (0..20).any(|_| {
        let killed = kill_when(bench, layout, &dest, |name| name.ends_with(".journal"));
        let (_, told) = export(bench, layout, &format!("killed-{layout}"), &["--dry-run"]);
        told.expect_done();
        let early = killed && !told.stdout.contains(" 0 parts to make");
        if !early {
            fs::remove_dir_all(&dest).expect("is removed");
        }
        early
    });
    assert!(early, "{layout} was too fast to be killed");
    kill_when(bench, layout, &dest, |name| name.starts_with("scene_") && name.ends_with(".json"));
    // A kill may come just before a finished part's journal is removed.
    let records = dest.join(".convoy-export").join(layout);
    for entry in fs::read_dir(&records).expect("has records").flatten() {
        let name = entry.file_name().into_string().expect("is text");
        if let Some(part) = name.strip_suffix(".json").filter(|part| part.starts_with("scene_")) {
            fs::write(records.join(format!("{part}.journal")), "").expect("is written");
        }
    }
    made(bench, layout, "killed", &["--threads", "2"])
}

/// Starts an export on one thread and kills it as soon as a record of some name stands; whether it came to
/// that.
fn kill_when(bench: &Bench, layout: &str, dest: &Path, sign: impl Fn(&str) -> bool) -> bool {
    let mut command = command(bench, layout, dest, &["--threads", "1"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts");
    loop {
        let records = fs::read_dir(dest.join(".convoy-export").join(layout)).into_iter().flatten().flatten();
        if records.into_iter().any(|entry| entry.file_name().to_str().is_some_and(&sign)) {
            child.kill().expect("the child is killed");
            let status = child.wait().expect("the child is reaped");
            return !status.success();
        }
        if let Some(status) = child.try_wait().expect("the child can be asked") {
            assert!(status.success(), "{layout}: {status}");
            return false;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
