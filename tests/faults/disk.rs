//! A disk that fails: `disk.c` is loaded into the programs and lets one of their calls go wrong.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use convoy_tests::{Outcome, digests, program, workspace};
use rustix::io::Errno;
use rustix::process::{Pid, Signal, kill_process};
use store::hash_bytes;

use crate::plan::{
    Choice, Digests, OTHER_SET, STEPS, Step, configuration, damage, difference, each, is_passing, lost,
    of_other_set,
};
use crate::tally::{Tally, ill_told, say};

/// How long another one is given before the one that is stopped goes on.
const PATIENCE: Duration = Duration::from_secs(20);

/// What goes wrong with a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fault {
    name: &'static str,
    kind: &'static str,
    code: i32,
    /// With all calls that write from then on, too.
    goes_on: bool,
    /// The program must end well all the same.
    is_unnoticed: bool,
}

const fn once(name: &'static str, kind: &'static str, code: i32) -> Fault {
    Fault { name, kind, code, goes_on: false, is_unnoticed: false }
}

const fn unnoticed(name: &'static str, kind: &'static str, code: i32) -> Fault {
    Fault { is_unnoticed: true, ..once(name, kind, code) }
}

const fn from_here_on(name: &'static str, code: Errno) -> Fault {
    Fault { goes_on: true, ..once(name, "fail", code.raw_os_error()) }
}

const KILLED: Fault = once("killed after it", "killed", 0);
const FAILS: Fault = once("input/output error", "fail", Errno::IO.raw_os_error());
const LOST: Fault = once("is done, reports an error", "lost", Errno::IO.raw_os_error());
/// As file systems of a network lose the answer to a link.
const LINKED: Fault = unnoticed("is done, its answer is lost", "lost", Errno::IO.raw_os_error());
const HALF: Fault = unnoticed("half of it", "half", 0);
const FORBIDDEN: Fault = once("permission denied", "fail", Errno::ACCESS.raw_os_error());
const NO_HANDLE: Fault = once("too many open files", "fail", Errno::MFILE.raw_os_error());
const NAME_TOO_LONG: Fault = once("name too long", "fail", Errno::NAMETOOLONG.raw_os_error());
const STOPPED: Fault = unnoticed("stopped, another one does all, goes on", "stop", 0);
const BACK: Fault = unnoticed("the clock goes back by 100 days", "clock", 8_640_000);
const FULL: Fault = from_here_on("disk full from here on", Errno::NOSPC);
const QUOTA: Fault = from_here_on("quota used up from here on", Errno::DQUOT);
const READ_ONLY: Fault = from_here_on("read-only from here on", Errno::ROFS);

/// What can go wrong with an operation.
fn faults_of(operation: &str) -> &'static [Fault] {
    match operation {
        "create" => &[KILLED, FAILS, FORBIDDEN, NO_HANDLE, NAME_TOO_LONG, FULL, READ_ONLY, BACK],
        "make" => &[KILLED, FORBIDDEN, FULL],
        "write" => &[KILLED, FAILS, HALF, FULL, QUOTA],
        "sync" => &[KILLED, FAILS, LOST],
        "rename" => &[KILLED, FAILS, LOST, STOPPED],
        "link" => &[KILLED, FAILS, LINKED, STOPPED],
        "remove" => &[KILLED, FAILS, LOST],
        "open" => &[FAILS, FORBIDDEN, NO_HANDLE],
        "read" => &[FAILS, HALF],
        "look" | "list" => &[FAILS],
        other => panic!("no faults of {other}"),
    }
}

/// The library that is loaded into programs; none where there is no C compiler.
fn library(folder: &Path) -> Option<PathBuf> {
    let file = folder.join("disk.so");
    let mut compiler = Command::new(std::env::var("CC").unwrap_or_else(|_| "cc".to_owned()));
    compiler.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&file).arg(workspace().join("tests/faults/disk.c"));
    match compiler.arg("-ldl").status() {
        Ok(status) => {
            assert!(status.success(), "disk.c does not compile");
            Some(file)
        }
        Err(_) => None,
    }
}

/// What all tries share.
struct Disk {
    folder: tempfile::TempDir,
    library: PathBuf,
}

impl Disk {
    /// A program on a store.
    fn command(&self, step: &Step, store: &Path) -> Command {
        let mut command = Command::new(program(step.program));
        command.args(step.words).arg("--store").arg(store).env("CONVOY_DEVICE", "cpu");
        if let Some(scenes) = step.scenes {
            command.arg("--config").arg(self.configuration(scenes)).args([
                "--threads",
                "1",
                "--progress",
                "none",
            ]);
        }
        if step.name == "merge" {
            command.arg(self.before("merge-from"));
        }
        command
    }

    fn configuration(&self, scenes: u32) -> PathBuf {
        self.folder.path().join(format!("{scenes}.toml"))
    }

    /// The store as it is before a step.
    fn before(&self, name: &str) -> PathBuf {
        self.folder.path().join("before").join(name)
    }

    /// The same with the library loaded.
    fn watched(&self, step: &Step, store: &Path) -> Command {
        let mut command = self.command(step, store);
        command
            .env("LD_PRELOAD", &self.library)
            .env("FAULTS_PROGRAM", step.program)
            .env("FAULTS_FOLDER", store);
        command
    }

    /// A try of this worker: an own copy of a store. Programs never change a file, so links do.
    fn copy(&self, from: &Path, to: &Path) {
        let _ = fs::remove_dir_all(to);
        fs::create_dir_all(to).expect("makes a folder");
        for entry in walkdir::WalkDir::new(from).min_depth(1) {
            let entry = entry.expect("lists");
            let copied = to.join(entry.path().strip_prefix(from).expect("is below"));
            if entry.file_type().is_dir() {
                fs::create_dir_all(copied).expect("makes a folder");
            } else {
                fs::hard_link(entry.path(), copied).expect("links");
            }
        }
    }
}

fn output(mut command: Command) -> Outcome {
    Outcome::of(&command.output().expect("the program starts"))
}

/// The state of a store as a program finds it: what was begun counts by its bytes alone.
fn fingerprint(digests: &Digests) -> String {
    let mut lines: Vec<String> = digests
        .iter()
        .filter(|(key, _)| !key.starts_with("_locks/"))
        .map(|(key, digest)| {
            let name = if is_passing(key) {
                key.split('~').take(2).collect::<Vec<_>>().join("~")
            } else {
                key.clone()
            };
            format!("{name} {digest}\n")
        })
        .collect();
    lines.sort_unstable();
    hash_bytes(lines.concat().as_bytes())
}

/// A call of a step.
struct Call {
    number: usize,
    operation: String,
}

fn calls_of(log: &str) -> Vec<Call> {
    let of = |line: &str| {
        let mut words = line.split(' ');
        let number = words.next().and_then(|n| n.parse().ok()).expect("has a number");
        Call { number, operation: words.next().expect("has a name").to_owned() }
    };
    log.lines().map(of).collect()
}

#[test]
fn whatever_goes_wrong_with_a_disk_nothing_is_lost_and_the_bytes_are_the_same() {
    let choice = Choice::from_environment(1000);
    if STEPS.iter().all(|step| !choice.may_have("disk", step)) {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(library) = library(folder.path()) else {
        say("note: skipped the faults of a disk: there is no C compiler");
        return;
    };
    let disk = Disk { folder, library };
    for scenes in [1, 2] {
        fs::write(disk.configuration(scenes), configuration(scenes)).expect("writes");
    }
    let tally = Tally::default();
    let now = disk.folder.path().join("now");
    fs::create_dir_all(&now).expect("makes a folder");
    for step in &STEPS {
        match step.name {
            // A tile that no scene names, as older code leaves them, and a file that no manifest names.
            "tidy" => {
                let stray = now.join("scenes/0000/stray.parquet");
                fs::write(&stray, "left by a process of the day before yesterday").expect("writes");
                let then = SystemTime::now() - Duration::from_hours(48);
                fs::File::open(&stray).and_then(|file| file.set_modified(then)).expect("sets its time");
                let tiles = now.join("tiles");
                let set = fs::read_dir(&tiles).expect("has tiles").next().expect("has a set").expect("lists");
                let other = tiles.join(OTHER_SET);
                disk.copy(&set.path(), &other);
                let name = set.file_name().into_string().expect("is a text");
                for entry in walkdir::WalkDir::new(&other) {
                    let file = entry.expect("lists").into_path();
                    if file.ends_with("_manifest.json") {
                        let manifest = of_other_set(&fs::read(&file).expect("reads"), &name, OTHER_SET);
                        // The file is a link to the one that it was copied from.
                        fs::remove_file(&file).expect("removes");
                        fs::write(&file, manifest).expect("writes");
                    }
                }
            }
            // From all that there is into a store with a plan alone.
            "merge" => {
                disk.copy(&now, &disk.before("merge-from"));
                let _ = fs::remove_dir_all(now.join("scenes"));
                let _ = fs::remove_dir_all(now.join("stats"));
                let _ = fs::remove_file(now.join("README.md"));
            }
            _ => {}
        }
        let before = disk.before(step.name);
        disk.copy(&now, &before);
        let log = disk.folder.path().join(format!("{}.log", step.name));
        let mut clean = disk.watched(step, &now);
        clean.env("FAULTS_LOG", &log);
        output(clean).expect_done();
        let calls = calls_of(&fs::read_to_string(&log).expect("has a log"));
        assert!(calls.len() > 20, "{}: the library counts nothing", step.name);
        let states = States { before: digests(&before), after: digests(&now), good: Mutex::default() };
        let tries: Vec<(String, &Call, Fault)> = calls
            .iter()
            .flat_map(|call| faults_of(&call.operation).iter().map(move |fault| (call, *fault)))
            .map(|(call, fault)| (format!("disk/{}/{}/{}", step.name, call.number, fault.name), call, fault))
            .filter(|(name, _, _)| choice.has(step, name))
            .collect();
        let threads = thread::available_parallelism().map_or(1, usize::from);
        let start = Instant::now();
        each(&tries, threads, |worker, (name, call, fault)| {
            let place = disk.folder.path().join(format!("worker-{worker}/store"));
            disk.copy(&before, &place);
            let (outcome, problem) = disk.attempt(step, &place, call.number, *fault, &states);
            tally.add(name, &call.operation, fault.name, &outcome, problem);
        });
        say(&format!(
            "disk, {}: {} calls, {} tries in {:.0} s",
            step.name,
            calls.len(),
            tries.len(),
            start.elapsed().as_secs_f64()
        ));
    }
    tally.end("disk");
}

/// What a step starts with and ends with, and states from which it was seen to end well.
struct States {
    before: Digests,
    after: Digests,
    good: Mutex<BTreeSet<String>>,
}

impl Disk {
    /// Lets a call of a step go wrong. Returns how the step ended, and what is wrong then.
    fn attempt(
        &self,
        step: &Step,
        store: &Path,
        number: usize,
        fault: Fault,
        states: &States,
    ) -> (Outcome, Option<String>) {
        let mut command = self.watched(step, store);
        command.env("FAULTS_AT", number.to_string()).env("FAULTS_KIND", fault.kind);
        command.env("FAULTS_CODE", fault.code.to_string());
        if fault.goes_on {
            command.env("FAULTS_ON", "1");
        }
        let outcome = if fault == STOPPED { self.overtaken(step, store, command) } else { output(command) };
        let problem = self.judge(step, store, fault, &outcome, states);
        (outcome, problem)
    }

    /// Another process does all that the stopped one was to do; then it goes on.
    fn overtaken(&self, step: &Step, store: &Path, mut command: Command) -> Outcome {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = command.spawn().expect("the program starts");
        let pid = child.id();
        let is_stopped = || {
            let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
            stat.rsplit(") ").next().is_some_and(|rest| rest.starts_with(['T', 'Z']))
        };
        while !is_stopped() {
            thread::sleep(Duration::from_millis(2));
        }
        let mut other = self.command(step, store);
        let mut other =
            other.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        // Who wants the store alone waits for one that is about to take it.
        let patience = Instant::now();
        while other.try_wait().expect("is asked").is_none() && patience.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(2));
        }
        let process = Pid::from_raw(i32::try_from(pid).expect("is a number of a process"));
        // Of one that has ended there is nothing to go on with.
        let _ = kill_process(process.expect("is no 0"), Signal::CONT);
        let outcome = Outcome::of(&child.wait_with_output().expect("the program ends"));
        let other = Outcome::of(&other.wait_with_output().expect("the program ends"));
        // Work that nobody shares is refused to whoever comes second.
        if other.code != 0 && !(other.code == 75 && other.stderr.contains("ERROR")) {
            return other;
        }
        outcome
    }

    fn judge(
        &self,
        step: &Step,
        store: &Path,
        fault: Fault,
        outcome: &Outcome,
        states: &States,
    ) -> Option<String> {
        if let Some(problem) = ill_told(outcome) {
            return Some(problem);
        }
        if fault.is_unnoticed && outcome.code != 0 {
            return Some("does not end well".to_owned());
        }
        let found = if store.is_dir() { digests(store) } else { Digests::new() };
        if let Some(problem) = lost(&found, &states.before, &states.after) {
            return Some(problem);
        }
        if let Some(problem) = damage(Arc::new(store::Disk::new(store))) {
            return Some(problem);
        }
        // By a clock that went back nothing is old enough to be removed: the next run does it.
        let may_be_left = step.name == "tidy" && fault == BACK;
        if outcome.code == 0
            && !may_be_left
            && let Some(problem) = difference(&found, &states.after)
        {
            return Some(format!("ends well, but {problem}"));
        }
        let state = fingerprint(&found);
        if states.good.lock().expect("is whole").contains(&state) {
            return None;
        }
        let again = output(self.command(step, store));
        if again.code != 0 {
            return Some(format!("the next run ends with {}: {}", again.code, again.stderr.trim()));
        }
        let found = digests(store);
        if let Some(problem) = difference(&found, &states.after) {
            return Some(format!("after the next run {problem}"));
        }
        if let Some(left) = found.keys().find(|key| is_passing(key)) {
            return Some(format!("the next run leaves {left}"));
        }
        states.good.lock().expect("is whole").insert(state);
        None
    }
}
