//! All programs as one file, as bundles and wheels have it, and what needs no files beside it: the demo, the
//! configurations that come with the programs, the doctor.

use std::ffi::OsStr;
use std::os::unix::fs::symlink;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

use convoy_tests::{Bench, LEAN, Outcome, program, workspace};

/// Programs whose help is compared; the others are stages like the first.
const PROGRAMS: [&str; 8] =
    ["bev-gt", "spawn-planner", "render-sensors", "convoy", "export", "evaluate", "viz", "check"];

fn run(program: impl AsRef<OsStr>, folder: &Path, args: &[&str]) -> Outcome {
    let mut command = Command::new(program);
    // The help states what the environment holds.
    command.env_remove("CONVOY_DEVICE").env("COLUMNS", "100").current_dir(folder).args(args);
    Outcome::of(&command.output().expect("the program starts"))
}

#[test]
fn links_to_the_one_file_are_the_programs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in PROGRAMS {
        let link = folder.path().join(name);
        symlink(program("convoy-all"), &link).expect("is linked");
        let said = run(&link, folder.path(), &["--help"]);
        said.expect_done();
        assert_eq!(said.stdout, run(program(name), folder.path(), &["--help"]).stdout, "{name}");
    }
    // What `convoy` starts is called as it was typed, by the one file as by programs of their own.
    for convoy in [folder.path().join("convoy"), program("convoy"), program("convoy-all")] {
        for (command, usage) in [
            ("bev-gt", "Usage: convoy bev-gt [OPTIONS]"),
            ("preview", "Usage: convoy preview [OPTIONS]"),
            ("viz", "Usage: convoy viz [OPTIONS]"),
            ("export", "Usage: convoy export <COMMAND>"),
        ] {
            let said = run(&convoy, folder.path(), &[command, "--help"]);
            assert!(said.stdout.contains(usage), "{} {command}: {}", convoy.display(), said.stdout);
        }
    }
    // `viz preview` is typed by itself, too.
    let said = run(folder.path().join("viz"), folder.path(), &["preview", "--help"]);
    assert!(said.stdout.contains("Usage: viz preview [OPTIONS]"), "{}", said.stdout);
    // A file of any other name is `convoy`.
    let mut renamed = Command::new(program("convoy-all"));
    let said = Outcome::of(&renamed.arg0("my-convoy").args(["status", "--help"]).output().expect("starts"));
    assert!(said.stdout.contains("Usage: my-convoy status"), "{}", said.stdout);
}

#[test]
fn the_one_file_makes_the_demo_by_itself() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let convoy = folder.path().join("convoy");
    symlink(program("convoy-all"), &convoy).expect("is linked");
    let demo = run(&convoy, folder.path(), &["demo", "--device", "cpu", "--progress", "none"]);
    demo.expect_done();
    let store = folder.path().join("convoy-demo");
    assert!(store.join("stats/report.html").is_file());
    let verified = run(&convoy, folder.path(), &["verify", "--store", "convoy-demo"]);
    verified.expect_done();
    // What it tells people to type in Python can be typed.
    let lines = demo.stdout.lines().skip_while(|line| !line.starts_with("Open it from Python"));
    let lines = lines.skip(1).take_while(|line| !line.is_empty());
    let script: String = lines.map(|line| format!("{}\n", line.trim())).collect();
    assert!(script.starts_with("import convoy\n"), "{}", demo.stdout);
    if let Some(python) = testkit::python(&["numpy", "pyarrow"]) {
        let mut command = Command::new(python);
        command.args(["-c", &script]).env("PYTHONPATH", workspace().join("python/src")).current_dir(&folder);
        let output = Outcome::of(&command.output().expect("Python starts"));
        output.expect_done();
        assert!(output.stdout.contains("LIDAR"), "{}", output.stdout);
    }
}

#[test]
fn configurations_come_with_the_programs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let convoy = |args: &[&str]| run(program("convoy"), folder.path(), args);
    let listed = convoy(&["config", "list"]);
    listed.expect_done();
    for (name, file) in [("demo", "configs/demo.toml"), ("rigs/opv2v", "configs/rigs/opv2v.toml")] {
        assert!(listed.stdout.lines().any(|line| line.trim_start().starts_with(name)), "{}", listed.stdout);
        let text = std::fs::read_to_string(workspace().join(file)).expect("is there");
        assert_eq!(convoy(&["config", "show", name]).stdout, text);
    }
    let unknown = convoy(&["config", "show", "dmo"]);
    assert_eq!(unknown.code, 2);
    assert!(unknown.stderr.contains("no configuration is called `dmo`; there are"), "{}", unknown.stderr);
    // By name where a file is wanted.
    let planned = convoy(&["forecast", "--config", "tiny"]);
    planned.expect_done();
    assert!(planned.stdout.contains("1 scenes (1 train, 0 val, 0 test)"), "{}", planned.stdout);
    let unknown = convoy(&["forecast", "--config", "dmo"]);
    assert_eq!(unknown.code, 2);
    assert!(unknown.stderr.contains("convoy config list"), "{}", unknown.stderr);
}

#[test]
fn a_forecast_counts_what_is_still_to_do() {
    let bench = Bench::new(&LEAN.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2"));
    let fresh = bench.run("convoy", &["forecast"]);
    fresh.expect_done();
    assert!(!fresh.stdout.contains("still to do"), "{}", fresh.stdout);
    assert!(!bench.store().exists(), "nothing is written");
    bench.run("spawn-planner", &[]).expect_done();
    let planned = bench.run("convoy", &["forecast"]);
    assert!(planned.stdout.contains("still to do: 2 of 2 scenes, 100 % of the work"), "{}", planned.stdout);
    bench.run("simulate-and-log", &["--scenes", "0"]).expect_done();
    let begun = bench.run("convoy", &["forecast"]);
    assert!(begun.stdout.contains("still to do: 2 of 2 scenes, "), "{}", begun.stdout);
    assert!(!begun.stdout.contains("100 %"), "{}", begun.stdout);
}

#[test]
fn slips_of_the_hand_are_told_what_was_meant() {
    let said = run(program("convoy"), Path::new("."), &["rnu"]);
    assert_eq!(said.code, 2);
    assert!(said.stderr.contains("similar subcommand exists: 'run'"), "{}", said.stderr);
}

#[test]
fn the_doctor_says_what_there_is_and_what_for() {
    let said = run(program("convoy"), Path::new("."), &["doctor"]);
    said.expect_done();
    for word in ["version", "processor", "memory", "disk", "programs", "gpu", "python", "ffmpeg"] {
        assert!(said.stdout.lines().any(|line| line.starts_with(word)), "{word}: {}", said.stdout);
    }
    assert!(said.stdout.contains("all are there"), "{}", said.stdout);
}
