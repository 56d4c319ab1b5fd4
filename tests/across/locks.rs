//! One plan at a time: runs of two configurations do not meet in one store, workers of one do.

use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use convoy_tests::{Bench, Outcome, TINY, check_in_python, program};
use serde_json::Value;

/// [`TINY`] with other traffic: another plan.
fn other() -> String {
    TINY.replace("vehicles = 12", "vehicles = 13")
}

/// Writes another configuration beside that of a bench.
fn beside(bench: &Bench, text: &str) -> PathBuf {
    let path = bench.folder.path().join("other.toml");
    std::fs::write(&path, text).expect("the configuration is written");
    path
}

/// A program by another configuration.
fn by(bench: &Bench, config: &PathBuf, name: &str, args: &[&str]) -> Command {
    let mut command = Command::new(program(name));
    if name == "convoy" {
        command.arg("run");
    }
    command.arg("--config").arg(config).arg("--store").arg(bench.store());
    command.args(["--progress", "none"]).args(args);
    command
}

fn outcome(command: &mut Command) -> Outcome {
    Outcome::of(&command.output().expect("starts"))
}

/// What the locks of a store say.
fn locks(bench: &Bench) -> Vec<Value> {
    let Ok(folder) = std::fs::read_dir(bench.store().join("_locks")) else { return Vec::new() };
    let paths = folder.filter_map(|entry| Some(entry.ok()?.path()));
    let texts =
        paths.filter(|p| p.extension().is_some_and(|e| e == "json")).filter_map(|p| std::fs::read(p).ok());
    texts.map(|text| serde_json::from_slice(&text).expect("is JSON")).collect()
}

/// Waits until a program holds the store; the number of its process.
#[track_caller]
fn held_by(bench: &Bench, name: &str) -> u32 {
    let start = Instant::now();
    loop {
        for lock in locks(bench) {
            let work = lock["holder"]["work"].as_str().expect("says for what");
            if work.starts_with(name) && lock["turn"] == "holding" {
                return u32::try_from(lock["holder"]["process"].as_u64().expect("has a number"))
                    .expect("is short");
            }
        }
        assert!(start.elapsed() < Duration::from_secs(120), "{name} never holds the store");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn signal(process: u32, signal: &str) {
    let told = Command::new("kill").args([signal, &process.to_string()]).status();
    assert!(told.expect("kill runs").success(), "{signal} {process}");
}

/// A process that stands still wherever it is, and is killed at last.
struct Stopped(Child);

impl Stopped {
    fn when_it_holds(bench: &Bench, name: &str) -> Self {
        let child = bench.start(name, &[]);
        assert_eq!(held_by(bench, name), child.id());
        signal(child.id(), "-STOP");
        Self(child)
    }

    fn kill(mut self) {
        self.0.kill().expect("is killed");
        self.0.wait().expect("is reaped");
    }
}

/// A text about the holder of a lock, without what differs from run to run and machine to machine.
fn masked(bench: &Bench, lock: &Value, text: &str) -> String {
    let holder = &lock["holder"];
    let of = |name: &str| holder[name].as_str().expect("is a text");
    let text = text
        .replace(&bench.folder.path().display().to_string(), "FOLDER")
        .replace(&format!("{} on {}", of("owner"), of("host")), "OWNER on HOST")
        .replace(&format!("process {}", holder["process"]), "process NUMBER")
        .replace(of("since"), "DATE");
    // Digests have eight digits.
    let mut parts = text.split("configuration ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| format!("{text}configuration DIGEST{}", &part[8..]))
}

#[test]
fn another_configuration_waits_and_the_same_one_shares() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    let other = beside(&bench, &other());
    let holder = Stopped::when_it_holds(&bench, "simulate-and-log");
    let before = bench.digests();
    let all = locks(&bench);
    let [lock] = &all[..] else { panic!("not one lock: {all:?}") };
    let refused = outcome(&mut by(&bench, &other, "spawn-planner", &[]));
    assert_eq!(refused.code, 75, "{refused:?}");
    insta::assert_snapshot!("held", masked(&bench, lock, &refused.stderr));
    // A whole run says it as well, before any stage.
    let run = outcome(&mut by(&bench, &other, "convoy", &[]));
    assert!(run.code == 75 && run.stdout.is_empty(), "{run:?}");
    assert!(run.stderr.contains("this is convoy run of `tiny`, configuration "), "{run:?}");
    for name in ["bev-gt", "stats"] {
        let refused = outcome(&mut by(&bench, &other, name, &[]));
        assert!(refused.code == 75 && refused.stderr.contains("held by"), "{refused:?}");
    }
    let tidy = bench.run("convoy", &["tidy"]);
    assert_eq!(tidy.code, 75, "{tidy:?}");
    insta::assert_snapshot!("held-from-tidy", masked(&bench, lock, &tidy.stderr));
    // Whoever only reads needs nothing.
    outcome(&mut by(&bench, &other, "spawn-planner", &["--dry-run"])).expect_done();
    assert_eq!(bench.run("convoy", &["status"]).code, 1);
    let verify = bench.run("convoy", &["verify"]);
    assert!(!verify.stdout.contains("_locks"), "{verify:?}");
    // Nor is the same configuration refused.
    bench.run("spawn-planner", &[]).expect_done();
    let shares = bench.run("bev-gt", &[]);
    assert!(shares.code == 1 && shares.stderr.contains("simulate-and-log is missing"), "{shares:?}");
    assert!(bench.digests() == before, "a store that is held was touched");

    holder.kill();
    let next = outcome(&mut by(&bench, &other, "spawn-planner", &[]));
    next.expect_done();
    let said: Vec<&str> = next.stderr.lines().filter(|line| line.contains("takes over")).collect();
    insta::assert_snapshot!("taken-over", masked(&bench, lock, said.join("\n").trim()));
    let again = outcome(&mut by(&bench, &other, "spawn-planner", &[]));
    assert!(again.code == 0 && !again.stderr.contains("takes over"), "{again:?}");
    assert!(!bench.store().join("_locks").exists());
}

/// `convoy run` holds the store for all stages, and each stage for itself.
#[test]
fn a_whole_run_holds_the_store_until_all_of_it_is_gone() {
    let bench = Bench::new(TINY);
    let other = beside(&bench, &other());
    let mut driver = bench.start("convoy", &["run"]);
    assert_eq!(held_by(&bench, "convoy run"), driver.id());
    let stage = held_by(&bench, "simulate-and-log");
    signal(stage, "-STOP");
    driver.kill().expect("is killed");
    driver.wait().expect("is reaped");
    let refused = outcome(&mut by(&bench, &other, "convoy", &[]));
    assert_eq!(refused.code, 75, "{refused:?}");
    assert!(refused.stderr.contains(&format!("process {stage}, since ")), "{refused:?}");
    signal(stage, "-KILL");
    // Its parent is gone: it is reaped by others, whenever they do.
    let is_there = || {
        let stat = std::fs::read_to_string(format!("/proc/{stage}/stat")).unwrap_or_default();
        stat.rsplit(") ").next().is_some_and(|rest| !rest.is_empty() && !rest.starts_with(['Z', 'X']))
    };
    while is_there() {
        std::thread::sleep(Duration::from_millis(2));
    }
    let next = outcome(&mut by(&bench, &other, "spawn-planner", &[]));
    next.expect_done();
    assert_eq!(next.stderr.matches("takes over what ").count(), 1, "{next:?}");
    assert!(!bench.store().join("_locks").exists());
    // A run that is told to end lets go.
    let mut driver = bench.start("convoy", &["run"]);
    held_by(&bench, "simulate-and-log");
    signal(driver.id(), "-TERM");
    assert_eq!(driver.wait().expect("ends").code(), Some(75));
    assert!(!bench.store().join("_locks").exists());
}

#[test]
fn of_two_first_runs_at_once_one_works() {
    let bench = Bench::new(TINY);
    let other = beside(&bench, &other());
    let start = |config: &PathBuf| {
        let mut command = by(&bench, config, "convoy", &[]);
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        command.spawn().expect("starts")
    };
    let runs = [start(&bench.config()), start(&other)];
    let [first, second] = runs.map(|run| Outcome::of(&run.wait_with_output().expect("ends")));
    let mut codes = [first.code, second.code];
    codes.sort_unstable();
    assert_eq!(codes, [0, 75], "{first:?}\n{second:?}");
    let (refused, config) = if first.code == 75 { (first, &other) } else { (second, &bench.config()) };
    assert!(refused.stderr.contains("held by") && refused.stderr.lines().count() == 1, "{refused:?}");
    // The store is that of the one that worked, whole.
    bench.run("convoy", &["verify"]).expect_done();
    let kept = outcome(&mut by(&bench, config, "convoy", &[]));
    kept.expect_done();
    assert!(kept.stderr.contains("render-sensors: 0 done, 1 kept, 0 failed"), "{kept:?}");
}

/// Ctrl-C, no and yes where a run asks whether finished work may be made again.
#[test]
fn a_question_is_answered_at_a_terminal() {
    let bench = Bench::new(&format!("{TINY}\n[store]\nask_beyond_s = 0\n"));
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let other = beside(&bench, &format!("{}\n[store]\nask_beyond_s = 0\n", other()));
    let before = bench.digests();
    let planner = program("spawn-planner");
    let answer = |word: &str| {
        check_in_python("question.py", &["pty"], &[&planner, &other, &bench.store(), Path::new(word)]);
    };
    answer("no");
    assert!(bench.digests() == before);
    answer("yes");
    assert!(bench.digests() != before, "the plan was not made again");
}
