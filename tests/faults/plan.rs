//! What is tried: programs, one after the other, and which of their faults.

use std::collections::BTreeMap;
use std::env;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use convoy_tests::workspace;
use store::hash_bytes;

/// Objects of a store, by key, with the digests of their bytes.
pub(crate) type Digests = BTreeMap<String, String>;

/// A program that takes a store a step further.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Its name here.
    pub(crate) name: &'static str,
    /// The program.
    pub(crate) program: &'static str,
    /// Its arguments besides store and configuration.
    pub(crate) words: &'static [&'static str],
    /// Whether it takes a configuration, and of how many scenes.
    pub(crate) scenes: Option<u32>,
    /// One of so many tries is made: one of 1, but where many files are written in one and the same way.
    pub(crate) one_of: u64,
}

/// One scene from nothing, one more, a copy, and what nobody needs taken away.
pub(crate) const STEPS: [Step; 12] = [
    stage("plan", "spawn-planner", &[], 1),
    stage("simulate", "simulate-and-log", &[], 1),
    stage("render", "render-sensors", &[], 1),
    stage("bev", "bev-gt", &[], 1),
    stage("occupancy", "occupancy-gt", &[], 1),
    stage("valid", "postprocess-valid", &[], 1),
    stage("tracks", "merge-tracks", &[], 1),
    // It writes 190 figures and tables.
    Step { one_of: 8, ..stage("stats", "stats", &[], 1) },
    stage("grow", "spawn-planner", &["--grow"], 2),
    stage("simulate-second", "simulate-and-log", &[], 2),
    Step { name: "tidy", program: "convoy", words: &["tidy"], scenes: None, one_of: 1 },
    Step { name: "merge", program: "convoy", words: &["merge"], scenes: None, one_of: 1 },
];

const fn stage(
    name: &'static str,
    program: &'static str,
    words: &'static [&'static str],
    scenes: u32,
) -> Step {
    Step { name, program, words, scenes: Some(scenes), one_of: 1 }
}

/// The configuration of so many scenes.
pub(crate) fn configuration(scenes: u32) -> String {
    let street = workspace().join("tests/configurations/street.xodr");
    include_str!("../configurations/street.toml").replace(
        "\"tests/configurations/street.xodr\" = 1",
        &format!("{:?} = {scenes}", street.display().to_string()),
    )
}

/// Which of all tries are made.
#[derive(Clone, Debug)]
pub(crate) enum Choice {
    All,
    /// One of so many, by a seed.
    Share(u64, u64),
    /// Those of this name.
    One(String),
}

impl Choice {
    /// What `CONVOY_FAULTS` says; otherwise a share that takes seconds.
    pub(crate) fn from_environment(usual: u64) -> Self {
        let Ok(text) = env::var("CONVOY_FAULTS") else { return Self::Share(usual, 1) };
        if text == "all" {
            return Self::All;
        }
        let mut parts = text.split('/');
        match (parts.next(), parts.next().and_then(|n| n.parse().ok()), parts.next().map(str::parse)) {
            (Some("1"), Some(of), None) if of > 0 => Self::Share(of, 1),
            (Some("1"), Some(of), Some(Ok(seed))) if of > 0 => Self::Share(of, seed),
            _ => Self::One(text),
        }
    }

    /// Whether a try of a step is made that has this name.
    pub(crate) fn has(&self, step: &Step, name: &str) -> bool {
        let drawn = |seed: u64, of: u64| {
            let digest = hash_bytes(format!("{seed} {name}").as_bytes());
            u64::from_str_radix(&digest[..15], 16).expect("is a number").is_multiple_of(of)
        };
        match self {
            Self::All => drawn(1, step.one_of),
            Self::Share(of, seed) => drawn(*seed, of * step.one_of),
            Self::One(one) => one == name,
        }
    }

    /// Whether a step has any try that is made, as far as can be told before its operations are counted.
    pub(crate) fn may_have(&self, place: &str, step: &Step) -> bool {
        match self {
            Self::One(one) => one.starts_with(&format!("{place}/{}/", step.name)),
            _ => true,
        }
    }
}

/// A set of tiles that no scene names.
pub(crate) const OTHER_SET: &str = "0123456789abcdef";

/// A manifest of a set of tiles as one of another set, without a checksum of its text.
pub(crate) fn of_other_set(manifest: &[u8], set: &str, other: &str) -> Vec<u8> {
    let text = String::from_utf8_lossy(manifest).replace(set, other);
    let manifest: store::Manifest = serde_json::from_str(&text).expect("is a manifest");
    let mut text = serde_json::to_vec_pretty(&manifest).expect("is JSON");
    text.push(b'\n');
    text
}

/// What is lost of a store after a fault: objects that were there before, and that the step does not change,
/// must be as they were. `before` and `after` are the states around a step without faults.
pub(crate) fn lost(now: &Digests, before: &Digests, after: &Digests) -> Option<String> {
    let kept = before.iter().filter(|(key, digest)| after.get(*key) == Some(digest));
    for (key, digest) in kept.filter(|(key, _)| !is_passing(key)) {
        match now.get(key) {
            None => return Some(format!("{key} is gone")),
            Some(found) if found != digest => return Some(format!("{key} has other bytes")),
            Some(_) => {}
        }
    }
    None
}

/// What a store says of its own damage.
pub(crate) fn damage(place: Arc<dyn store::Backend>) -> Option<String> {
    match store::verify(&store::Store::new(place), &[], |_| {}) {
        Err(error) => Some(error.to_string()),
        Ok(found) => {
            use store::Problem::{Failed, NotDone, Stray};
            // What was not finished is nobody's yet.
            let real = |f: &&store::Finding| !matches!(f.problem, Stray | NotDone | Failed(_));
            found.findings.iter().find(real).map(ToString::to_string)
        }
    }
}

/// The difference of two states, if there is one; locks and what is unfinished are none.
pub(crate) fn difference(found: &Digests, expected: &Digests) -> Option<String> {
    let keys = found.keys().chain(expected.keys()).filter(|key| !is_passing(key));
    keys.filter(|key| found.get(*key) != expected.get(*key))
        .map(|key| {
            let state = |digests: &Digests| if digests.contains_key(key) { "there" } else { "absent" };
            format!("{key}: {} where {} is expected", state(found), state(expected))
        })
        .next()
}

/// Whether an object is of a process alone: a lock, or what was begun.
pub(crate) fn is_passing(key: &str) -> bool {
    key.starts_with("_locks/") || Path::new(key).extension().is_some_and(|ending| ending == "tmp")
}

/// Does something with each of many, on some threads.
pub(crate) fn each<T: Sync>(items: &[T], threads: usize, act: impl Fn(usize, &T) + Sync) {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for worker in 0..threads.min(items.len()) {
            let (next, act) = (&next, &act);
            scope.spawn(move || {
                while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
                    act(worker, item);
                }
            });
        }
    });
}
