//! Tasks as engines run them: each a share of the scenes, given nothing but the store.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::Command;

use convoy_tests::{Bench, LEAN, Outcome, program};
use runner::Graph;
use serde_json::Value;

use super::slips::words;

/// Three scenes; those of two seconds take twice as long as the others.
fn config() -> String {
    LEAN.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 3")
        .replace("max_duration_s = 1", "max_duration_s = 2")
}

/// A task as an engine starts it: without the configuration.
fn task(bench: &Bench, shard: &str) -> Outcome {
    let mut command = Command::new(program("convoy"));
    command.args(["run", "--stages", "scenes", "--shard", shard, "--progress", "none", "--store"]);
    Outcome::of(&command.arg(bench.store()).output().expect("starts"))
}

/// The record of the plan.
fn planned(bench: &Bench) -> Value {
    let path = bench.store().join("plan/_manifest.json");
    serde_json::from_slice(&fs::read(&path).expect("is there")).expect("is JSON")
}

/// Changes the record of the plan.
fn edit_plan(bench: &Bench, edit: impl Fn(&mut Value)) {
    let path = bench.store().join("plan/_manifest.json");
    let mut plan = planned(bench);
    edit(&mut plan);
    fs::write(&path, serde_json::to_vec_pretty(&plan).expect("is JSON")).expect("is written");
}

#[test]
fn tasks_make_what_one_machine_makes() {
    let (tasks, whole) = (Bench::new(&config()), Bench::new(&config()));
    whole.run("convoy", &["run", "--progress", "none"]).expect_done();
    assert_eq!(task(&tasks, "0/2").code, 2, "there is no plan");
    assert!(!tasks.store().exists());
    tasks.run("convoy", &["run", "--stages", "plan", "--progress", "none"]).expect_done();
    // At the same time, and one of them twice, as engines do.
    let mut others = Vec::new();
    for shard in ["0/2", "1/2", "1/2"] {
        let mut command = Command::new(program("convoy"));
        command.args(["run", "--stages", "scenes", "--shard", shard, "--progress", "none", "--store"]);
        others.push(command.arg(tasks.store()).spawn().expect("starts"));
    }
    for mut other in others {
        let code = other.wait().expect("ends").code();
        // Whoever replaced the other's shards in the middle ends with 75: it is tried again.
        assert!(matches!(code, Some(0 | 75)), "{code:?}");
    }
    for shard in ["0/2", "1/2"] {
        let again = task(&tasks, shard);
        again.expect_done();
        assert!(again.stderr.contains("of 2: 0 scenes to make"), "{}", again.stderr);
    }
    let joined = Command::new(program("convoy"))
        .args(["run", "--stages", "stats", "--progress", "none", "--store"])
        .arg(tasks.store())
        .output();
    Outcome::of(&joined.expect("starts")).expect_done();
    assert_eq!(tasks.digests(), whole.digests());

    // The store tells how it stands without a configuration, too.
    let mut told = Command::new(program("convoy"));
    let told = told.args(["status", "--json", "--store"]).arg(tasks.store()).output().expect("starts");
    assert_eq!(told.status.code(), Some(0));
    let told: Value = serde_json::from_slice(&told.stdout).expect("is JSON");
    assert_eq!(told["stages"]["bev-gt"]["done"], 3);
    assert_eq!(told["work"]["left_core_s"], 0.0);
    let watched = tasks.run("convoy", &["status", "--watch", "1"]);
    watched.expect_done();
    assert!(watched.stdout.contains("100.0 % of the work is done"), "{}", watched.stdout);
}

#[test]
fn tasks_refuse_plans_that_are_not_theirs() {
    let bench = Bench::new(&config());
    bench.run("convoy", &["run", "--stages", "plan", "--progress", "none"]).expect_done();
    let before = bench.digests();
    // Another configuration than was planned.
    bench.configure(&config().replace("channels = 8", "channels = 4"));
    let mut told = Vec::new();
    let mut refuse = |outcome: Outcome| {
        assert_eq!(outcome.code, 2, "{outcome:?}");
        told.push(words(&bench, &outcome));
    };
    refuse(bench.run("convoy", &["run", "--stages", "scenes", "--shard", "0/2"]));
    assert_eq!(bench.digests(), before, "nothing is touched");
    // Another release of a stage, whose own version rises whenever its bytes change.
    let ours = format!(
        "this one has version {}:",
        planned(&bench)["made_by"]["versions"]["bev-gt"].as_str().expect("is said")
    );
    edit_plan(&bench, |plan| plan["made_by"]["versions"]["bev-gt"] = "999".into());
    refuse(task(&bench, "1/2"));
    bench.configure(&config());
    bench.run("convoy", &["run", "--stages", "plan", "--progress", "none"]).expect_done();
    assert_eq!(bench.digests(), before, "the plan was kept, its versions are those of this program again");
    // What is no share, or no stage.
    refuse(task(&bench, "2/2"));
    refuse(bench.run("convoy", &["run", "--stages", "plan,scenes", "--shard", "0/2"]));
    refuse(bench.run("convoy", &["run", "--stages", "scenes,paint"]));
    fs::remove_file(bench.store().join("dataset.json")).expect("is there");
    refuse(task(&bench, "0/2"));
    insta::assert_snapshot!(told.join("\n---\n").replace(&ours, "this one has version OURS:"));
}

#[test]
fn a_killed_stage_is_told_from_a_stopped_one() {
    let bench = Bench::new(&config());
    bench.run("convoy", &["run", "--stages", "plan", "--progress", "none"]).expect_done();
    // The programs of a build, one of which the system kills, or somebody stops.
    let programs = bench.folder.path().join("programs");
    fs::create_dir(&programs).expect("is made");
    // What runs is told by the file, not by a link to it.
    fs::copy(program("convoy"), programs.join("convoy")).expect("is copied");
    for stage in &Graph::get().stages {
        symlink(program(stage.name), programs.join(stage.name)).expect("links");
    }
    let broken = programs.join("bev-gt");
    fs::remove_file(&broken).expect("is there");
    for (signal, code) in [("KILL", 137), ("TERM", 75), ("SEGV", 1)] {
        fs::write(&broken, format!("#!/bin/sh\nkill -{signal} $$\n")).expect("is written");
        fs::set_permissions(&broken, fs::Permissions::from_mode(0o755)).expect("may run");
        let command =
            bench.command("convoy", &["run", "--stages", "bev-gt", "--shard", "0/1", "--progress", "none"]);
        let output = Command::new(programs.join("convoy")).args(command.get_args()).output();
        let outcome = Outcome::of(&output.expect("starts"));
        assert_eq!(outcome.code, code, "{signal}: {outcome:?}");
    }
}

#[test]
fn whoever_submits_changes_no_plan_that_is_there() {
    let bench = Bench::new(&config());
    let submit = || bench.run("convoy", &["submit", "--engine", "slurm", "--cores", "1", "--memory", "2"]);
    let first = submit();
    first.expect_done();
    assert!(planned(&bench)["sections"].get("scene/0002").is_some(), "a new store is planned: {first:?}");
    let before = bench.digests();
    // Of a sensor, which the plan does not see, and of what it does.
    for (key, other) in [("channels = 8", "channels = 4"), ("max_duration_s = 2", "max_duration_s = 3")] {
        let text = config().replace(key, other);
        assert_ne!(text, config(), "{key}");
        bench.configure(&text);
        let refused = submit();
        assert!(refused.code == 2 && refused.stderr.contains("has a plan already"), "{refused:?}");
        assert!(refused.stderr.contains("convoy run --stages plan --config"), "{refused:?}");
        assert_eq!(bench.digests(), before, "nothing is touched");
    }
    bench.configure(&config());
    submit().expect_done();
    assert_eq!(bench.digests(), before);
}
