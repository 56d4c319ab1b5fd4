//! A service of buckets that fails: a server of the tests lets one request of a program go wrong, or all from
//! one on.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use convoy_tests::{Outcome, program};
use rustix::process::{Pid, Signal, kill_process};
use store::{Backend, Memory, hash_bytes};
use testkit::bucket::{BucketServer, Request, Snapshot, Wrong};

use crate::plan::{
    Choice, Digests, OTHER_SET, STEPS, Step, configuration, damage, difference, each, is_passing, lost,
    of_other_set,
};
use crate::tally::{Tally, ill_told, say};

const URL: &str = "s3://sets/one";
const FOLDER: &str = "sets/one";

/// What goes wrong with a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fault {
    name: &'static str,
    wrong: Wrong,
    /// The program is killed then.
    kills: bool,
    /// With all requests from then on, too.
    goes_on: bool,
    /// How the program may end.
    ends: &'static [i32],
}

/// What passes is not noticed.
const fn once(name: &'static str, wrong: Wrong) -> Fault {
    Fault { name, wrong, kills: false, goes_on: false, ends: &[0] }
}

const fn kill(name: &'static str, wrong: Wrong) -> Fault {
    Fault { name, wrong, kills: true, goes_on: false, ends: &[-1, 0] }
}

const fn for_good(name: &'static str, status: u16, ends: &'static [i32]) -> Fault {
    Fault { name, wrong: Wrong::Refused(status), kills: false, goes_on: true, ends }
}

const BUSY: Fault = once("503", Wrong::Refused(503));
const LOST: Fault = once("is done, its answer is lost", Wrong::AnswerLost);
const RESET: Fault = once("connection reset", Wrong::Reset);
const TRUNCATED: Fault = once("answer cut off", Wrong::Truncated);
const TWICE: Fault = once("is done twice", Wrong::Twice);
const LATE: Fault = once("answer late", Wrong::Late(Duration::from_millis(200)));
const KILLED: Fault = kill("killed after it", Wrong::AnswerLost);
const OVERTAKEN: Fault = kill("killed, it is done after the next run", Wrong::Held);
/// At the very end nothing is asked for any more that matters.
const AWAY: Fault = for_good("503 from here on", 503, &[75, 0]);
const FORBIDDEN: Fault = for_good("403 from here on", 403, &[2, 0]);

/// A request, as it is counted.
fn operation(request: &Request) -> &'static str {
    match request.method.as_str() {
        "PUT" if request.is_conditional() => "put on condition",
        "PUT" => "put",
        "DELETE" => "delete",
        "GET" if request.query.contains_key("list-type") => "list",
        "GET" => "get",
        "HEAD" => "head",
        _ => "upload",
    }
}

fn faults_of(operation: &str) -> &'static [Fault] {
    match operation {
        "get" | "list" => &[BUSY, RESET, TRUNCATED, AWAY, FORBIDDEN],
        "head" => &[BUSY, RESET, AWAY, FORBIDDEN],
        _ => &[BUSY, LOST, RESET, TRUNCATED, TWICE, LATE, KILLED, OVERTAKEN, AWAY, FORBIDDEN],
    }
}

/// What all tries share.
struct Buckets {
    folder: tempfile::TempDir,
}

impl Buckets {
    fn command(&self, step: &Step, server: &BucketServer) -> Command {
        let mut command = Command::new(program(step.program));
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.as_bytes().starts_with(b"AWS_")) {
            command.env_remove(name);
        }
        command.envs(server.environment()).env("HOME", self.folder.path()).env("CONVOY_DEVICE", "cpu");
        command.args(step.words).args(["--store", URL]).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(scenes) = step.scenes {
            command.arg("--config").arg(self.configuration(scenes)).args([
                "--threads",
                "1",
                "--progress",
                "none",
            ]);
        }
        if step.name == "merge" {
            command.arg(self.folder.path().join("merge-from"));
        }
        command
    }

    fn configuration(&self, scenes: u32) -> PathBuf {
        self.folder.path().join(format!("{scenes}.toml"))
    }

    fn run(&self, step: &Step, server: &BucketServer) -> Outcome {
        Outcome::of(&self.command(step, server).output().expect("the program starts"))
    }
}

fn digests(server: &BucketServer) -> Digests {
    server.objects(FOLDER).into_iter().map(|(key, bytes)| (key, hash_bytes(&bytes))).collect()
}

/// Kills a program, once its number is known.
fn end(process: &AtomicU32) {
    while process.load(Ordering::SeqCst) == 0 {
        thread::yield_now();
    }
    let process = i32::try_from(process.load(Ordering::SeqCst)).expect("is a process");
    let _ = kill_process(Pid::from_raw(process).expect("is no 0"), Signal::KILL);
}

/// What a server has, as a store to be looked at.
fn contents(server: &BucketServer) -> Arc<dyn Backend> {
    let memory = Memory::default();
    for (key, bytes) in server.objects(FOLDER) {
        assert!(memory.put_if_absent(&key, "a test", &bytes).expect("puts"));
    }
    Arc::new(memory)
}

/// What a step starts with and ends with, and states from which it was seen to end well.
struct States {
    start: Snapshot,
    end: Snapshot,
    before: Digests,
    after: Digests,
    good: Mutex<BTreeSet<String>>,
}

#[test]
fn whatever_goes_wrong_with_a_bucket_nothing_is_lost_and_the_bytes_are_the_same() {
    let choice = Choice::from_environment(1000);
    if STEPS.iter().all(|step| !choice.may_have("bucket", step)) {
        return;
    }
    let buckets = Buckets { folder: tempfile::tempdir().expect("a temporary folder") };
    for scenes in [1, 2] {
        fs::write(buckets.configuration(scenes), configuration(scenes)).expect("writes");
    }
    let server = BucketServer::start();
    let tally = Tally::default();
    for step in &STEPS {
        prepare(step, &server, &buckets);
        let (start, before) = (server.snapshot(), digests(&server));
        let requests: Arc<Mutex<Vec<&'static str>>> = Arc::default();
        let seen = Arc::clone(&requests);
        server.fail(move |_, request| {
            seen.lock().expect("is whole").push(operation(request));
            None
        });
        buckets.run(step, &server).expect_done();
        server.mend();
        let requests = std::mem::take(&mut *requests.lock().expect("is whole"));
        let (end, after) = (server.snapshot(), digests(&server));
        let states = States { start, end, before, after, good: Mutex::default() };
        let tries: Vec<(String, usize, &str, Fault)> = requests
            .iter()
            .enumerate()
            .flat_map(|(number, operation)| {
                faults_of(operation).iter().map(move |f| (number, *operation, *f))
            })
            .map(|(number, operation, fault)| {
                (format!("bucket/{}/{number}/{}", step.name, fault.name), number, operation, fault)
            })
            .filter(|(name, ..)| choice.has(step, name))
            .collect();
        // Those who wait for an answer need no processor.
        let threads = 3 * thread::available_parallelism().map_or(1, usize::from);
        let servers: Vec<BucketServer> = (0..threads).map(|_| BucketServer::start()).collect();
        let begun = std::time::Instant::now();
        each(&tries, threads, |worker, (name, number, operation, fault)| {
            let (outcome, problem) = buckets.attempt(step, &servers[worker], *number, *fault, &states);
            tally.add(name, operation, fault.name, &outcome, problem);
        });
        say(&format!(
            "bucket, {}: {} requests, {} tries in {:.0} s",
            step.name,
            requests.len(),
            tries.len(),
            begun.elapsed().as_secs_f64()
        ));
    }
    tally.end("bucket");
}

/// What lies in the bucket before a step that the steps before it did not make.
fn prepare(step: &Step, server: &BucketServer, buckets: &Buckets) {
    let objects = server.objects(FOLDER);
    match step.name {
        // A tile that no scene names, as older code leaves them, and a file that no manifest names.
        "tidy" => {
            let stray = format!("{FOLDER}/scenes/0000/stray.parquet");
            server.damage(&stray, Some(b"of January, as all that this server has".to_vec()));
            let key = objects.keys().find(|key| key.starts_with("tiles/")).expect("has tiles");
            let set = key.split('/').nth(1).expect("has a set").to_owned();
            for (key, bytes) in objects.iter().filter(|(key, _)| key.split('/').nth(1) == Some(&set)) {
                let is_manifest = key.ends_with("/_manifest.json");
                let bytes = if is_manifest { of_other_set(bytes, &set, OTHER_SET) } else { bytes.clone() };
                server.damage(&format!("{FOLDER}/{}", key.replace(&set, OTHER_SET)), Some(bytes));
            }
        }
        // From a folder that has all into a store with a plan alone.
        "merge" => {
            for (key, bytes) in &objects {
                let file = buckets.folder.path().join("merge-from").join(key);
                fs::create_dir_all(file.parent().expect("lies in a folder")).expect("makes a folder");
                fs::write(file, bytes).expect("writes");
                if key.starts_with("scenes/") || key.starts_with("stats/") || key == "README.md" {
                    server.damage(&format!("{FOLDER}/{key}"), None);
                }
            }
        }
        _ => {}
    }
}

impl Buckets {
    /// Lets a request of a step go wrong. Returns how the step ended, and what is wrong then.
    fn attempt(
        &self,
        step: &Step,
        server: &BucketServer,
        number: usize,
        fault: Fault,
        states: &States,
    ) -> (Outcome, Option<String>) {
        server.restore(&states.start);
        let victim = Arc::new(AtomicU32::new(0));
        let mut command = self.command(step, server);
        // What passes is waited for; nobody waits for what does not.
        if fault.goes_on {
            command.env("CONVOY_RETRY_S", "0");
        }
        let process = Arc::clone(&victim);
        server.fail(move |now, _| {
            let is_meant = now == number as u64 || fault.goes_on && now > number as u64;
            if is_meant && fault.kills {
                end(&process);
            }
            is_meant.then_some(fault.wrong)
        });
        let child = command.spawn().expect("the program starts");
        victim.store(child.id(), Ordering::SeqCst);
        let outcome = Outcome::of(&child.wait_with_output().expect("the program ends"));
        server.mend();
        let problem = self.judge(step, server, &outcome, fault, states);
        (outcome, problem)
    }

    fn judge(
        &self,
        step: &Step,
        server: &BucketServer,
        outcome: &Outcome,
        fault: Fault,
        states: &States,
    ) -> Option<String> {
        if let Some(problem) = ill_told(outcome) {
            return Some(problem);
        }
        if !fault.ends.contains(&outcome.code) {
            return Some(format!("ends with {} where {:?} is expected", outcome.code, fault.ends));
        }
        let found = digests(server);
        if let Some(problem) = lost(&found, &states.before, &states.after) {
            return Some(problem);
        }
        if let Some(problem) = damage(contents(server)) {
            return Some(problem);
        }
        if outcome.code == 0
            && let Some(problem) = difference(&found, &states.after)
        {
            return Some(format!("ends well, but {problem}"));
        }
        let lines =
            found.iter().filter(|(key, _)| !is_passing(key)).map(|(key, digest)| format!("{key} {digest}\n"));
        let state = hash_bytes(lines.collect::<String>().as_bytes());
        let is_known = states.good.lock().expect("is whole").contains(&state);
        if !is_known {
            if let Some(problem) = self.ends_well(step, server, states) {
                return Some(problem);
            }
            states.good.lock().expect("is whole").insert(state);
        }
        if fault.wrong != Wrong::Held {
            return None;
        }
        // As the next run leaves it, and then what was on its way.
        server.replace(&states.end);
        server.deliver();
        if let Some(problem) = damage(contents(server)) {
            return Some(format!("after what came late {problem}"));
        }
        // The record of a unit that comes late stays until the stage is made anew.
        let late: Vec<String> = digests(server).into_keys().filter(|key| key.contains(".parts/")).collect();
        for key in late.iter().filter(|key| !states.after.contains_key(*key)) {
            server.damage(&format!("{FOLDER}/{key}"), None);
        }
        difference(&digests(server), &states.after)?;
        self.ends_well(step, server, states).map(|problem| format!("after what came late {problem}"))
    }

    /// The next run makes what a run without faults makes.
    fn ends_well(&self, step: &Step, server: &BucketServer, states: &States) -> Option<String> {
        let again = self.run(step, server);
        if again.code != 0 {
            return Some(format!("the next run ends with {}: {}", again.code, again.stderr.trim()));
        }
        difference(&digests(server), &states.after).map(|problem| format!("after the next run {problem}"))
    }
}

/// What a killed process of another configuration sent can still arrive when its successor has finished. No
/// condition of a service keeps it out; `verify` names it.
#[test]
fn what_comes_late_from_another_configuration_is_named() {
    let buckets = Buckets { folder: tempfile::tempdir().expect("a temporary folder") };
    let server = BucketServer::start();
    let write = |text: &str| fs::write(buckets.configuration(1), text).expect("writes");
    write(&configuration(1));
    let [plan, simulate, render, ..] = STEPS;
    for step in [plan, simulate] {
        buckets.run(&step, &server).expect_done();
    }
    let key = "scenes/0000/sensors/vehicle_0/LIDAR.parquet";
    let victim = Arc::new(AtomicU32::new(0));
    let process = Arc::clone(&victim);
    server.fail(move |_, request| {
        let is_meant = request.method == "PUT" && request.path.ends_with(key);
        if is_meant {
            end(&process);
        }
        is_meant.then_some(Wrong::Held)
    });
    let child = buckets.command(&render, &server).spawn().expect("the program starts");
    victim.store(child.id(), Ordering::SeqCst);
    assert_eq!(Outcome::of(&child.wait_with_output().expect("ends")).code, -1);
    server.mend();

    write(&configuration(1).replace("channels = 4\ncolumns = 32", "channels = 6\ncolumns = 32"));
    let redone = Step { words: &["--redo"], ..plan };
    buckets.run(&redone, &server).expect_done();
    buckets.run(&simulate, &server).expect_done();
    buckets.run(&render, &server).expect_done();
    let whole = digests(&server);
    assert_eq!(damage(contents(&server)), None);
    server.deliver();
    let said = damage(contents(&server)).expect("is named");
    assert!(said.contains(key), "{said}");
    // Made again by force, it is as it was; the manifest counts how often it was forced.
    buckets.run(&Step { words: &["--force"], ..render }, &server).expect_done();
    assert_eq!((damage(contents(&server)), &digests(&server)[key]), (None, &whole[key]));
}
