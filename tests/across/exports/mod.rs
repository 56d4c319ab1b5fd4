//! Exports of a tiny dataset, each read back by a script that knows its layout and shares no code with us.

mod blind;
mod kitti;
mod mcap;
mod messages;
mod nuscenes;
mod opv2v;
mod several;
mod simbev2x;

use std::path::{Path, PathBuf};
use std::process::Command;

use convoy_tests::{Bench, Outcome, TINY, digests, program, workspace};

/// All layouts.
const LAYOUTS: [&str; 6] = ["kitti", "mcap", "nuscenes", "opv2v", "v2x-real", "simbev2x"];

/// All image kinds and every sensor at both kinds of agents; beams enough to thin them.
fn store() -> Bench {
    let config = TINY
        .replace("min_vehicles = 1", "min_vehicles = 2")
        .replace("max_vehicles = 1", "max_vehicles = 2")
        .replace("channels = 16", "channels = 32");
    let bench = Bench::new(&config);
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    bench
}

/// `export LAYOUT` on a dataset.
fn command(bench: &Bench, layout: &str, dest: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(program("export"));
    command.arg(layout).arg("--store").arg(bench.store()).arg("--dest").arg(dest);
    command.args(["--progress", "none"]).args(args);
    command
}

/// Runs `export LAYOUT` on a dataset; the destination's path and how it ended.
fn export(bench: &Bench, layout: &str, dest: &str, args: &[&str]) -> (PathBuf, Outcome) {
    let dest = bench.folder.path().join(dest);
    let output = command(bench, layout, &dest, args).output().expect("the program starts");
    let outcome = Outcome::of(&output);
    if outcome.code == 0 && !args.contains(&"--dry-run") {
        what_was_announced_is_done(&outcome);
    }
    (dest, outcome)
}

/// Progress ends at its total.
#[track_caller]
fn what_was_announced_is_done(outcome: &Outcome) {
    let count = |line: Option<&str>| -> Option<u64> {
        line?.split(" agent-frames").next()?.rsplit(' ').next()?.parse().ok()
    };
    let mut lines = outcome.stdout.lines();
    let (announced, done) = (count(lines.next()), count(lines.next_back()));
    assert!(announced.is_some() && announced == done, "{}", outcome.stdout);
}

#[test]
fn every_layout_is_listed() {
    let help =
        Outcome::of(&Command::new(program("export")).arg("--help").output().expect("the program starts"));
    let commands = help.stdout.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = commands.map_while(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    assert_eq!(names.collect::<Vec<_>>(), LAYOUTS);
    for file in ["docs/exports.md", "README.md", "Makefile", "tests/across/probes/mod.rs"] {
        let text = std::fs::read_to_string(workspace().join(file)).expect("reads");
        for layout in LAYOUTS {
            assert!(text.contains(layout), "{file} does not name {layout}");
        }
    }
}

#[test]
fn every_layout_reads_back() {
    let bench = store();
    a_destination_is_gone_on_with(&bench);
    kitti::check(&bench);
    mcap::check(&bench);
    nuscenes::check(&bench);
    opv2v::check(&bench);
    simbev2x::check(&bench);
    messages::check(&bench);
}

/// However an export is made, its bytes are the same; what is there is kept, what is damaged made again, what
/// is somebody else's left alone.
fn a_destination_is_gone_on_with(bench: &Bench) {
    let (one, outcome) = export(bench, "kitti", "one", &["--threads", "1"]);
    outcome.expect_done();
    let whole = digests(&one);
    let (two, outcome) = export(bench, "kitti", "two", &["--threads", "2", "--agents", "vehicle_0,rsu_*"]);
    outcome.expect_done();
    let (_, refused) = export(bench, "kitti", "two", &["--threads", "2"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(
        refused.stderr.contains("other options (--agents: vehicle_0,rsu_* -> all)"),
        "{}",
        refused.stderr
    );
    let before = digests(&two);
    export(bench, "kitti", "two", &["--threads", "2", "--force", "--dry-run"]).1.expect_done();
    assert_eq!(before, digests(&two), "a dry run changes nothing");
    export(bench, "kitti", "two", &["--threads", "2", "--force"]).1.expect_done();
    assert_eq!(whole, digests(&two));

    let (_, again) = export(bench, "kitti", "one", &[]);
    assert!(again.stdout.contains("0 parts to make"), "{}", again.stdout);
    let label = whole.keys().find(|name| name.contains("label_02")).expect("has labels");
    std::fs::write(two.join(label), "short").expect("is written");
    let (_, mended) = export(bench, "kitti", "two", &["--dry-run"]);
    assert!(mended.stdout.contains("1 parts to make"), "{}", mended.stdout);
    export(bench, "kitti", "two", &[]).1.expect_done();
    assert_eq!(whole, digests(&two));

    let (_, strange) = export(bench, "kitti", "store", &[]);
    assert_eq!(strange.code, 2, "{}", strange.stderr);
    let (_, unknown) = export(bench, "kitti", "three", &["--scenes", "0,7"]);
    assert!(unknown.code == 2 && unknown.stderr.contains('7'), "{}", unknown.stderr);
}
