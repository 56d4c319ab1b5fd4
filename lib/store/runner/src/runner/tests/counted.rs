//! How often a store is asked: what a request costs a disk is nothing, and all that there is over a network.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::SystemTime;

use store::{Area, Listing, Shard, Sink, StoreError, Unfinished};

use super::*;
use crate::overview::{Remembered, overview};
use crate::survey::scene_stages;

/// A place that counts requests, by kind and key.
#[derive(Default)]
struct Counting {
    place: Memory,
    requests: Mutex<BTreeMap<(&'static str, String), u32>>,
}

impl Counting {
    fn count(&self, kind: &'static str, key: &str) -> &Memory {
        *self.requests.lock().expect("no test panics").entry((kind, key.to_owned())).or_default() += 1;
        &self.place
    }

    /// What was asked for since the last time.
    fn take(&self) -> BTreeMap<(&'static str, String), u32> {
        std::mem::take(&mut self.requests.lock().expect("no test panics"))
    }
}

impl Backend for Counting {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        self.count("create", key).create(key, owner)
    }
    fn put_if_absent(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        self.count("put", key).put_if_absent(key, owner, bytes)
    }
    fn replace(&self, key: &str, owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
        self.count("replace", key).replace(key, owner, old, new)
    }
    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.count("read", key).read(key)
    }
    fn open(&self, key: &str, bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
        self.count("open", key).open(key, bytes)
    }
    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        self.count("size", key).size(key)
    }
    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
        self.count("modified", key).modified(key)
    }
    fn remove(&self, key: &str) -> Result<(), StoreError> {
        self.count("remove", key).remove(key)
    }
    fn list(&self, folder: &str) -> Result<Listing, StoreError> {
        self.count("list", folder).list(folder)
    }
    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        self.count("folders", folder).folders(folder)
    }
    fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError> {
        self.count("unfinished", folder).unfinished(folder)
    }
    fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError> {
        self.count("sweep", &format!("{area:?}")).sweep(area, owner)
    }
    fn location(&self, key: &str) -> String {
        self.place.location(key)
    }
}

/// Requests as `kind key`, without those of keys that are named; each was made once, or it is told.
fn told(requests: &BTreeMap<(&'static str, String), u32>) -> Vec<String> {
    let times = |count: &u32| if *count == 1 { String::new() } else { format!(" {count} times") };
    requests.iter().map(|((kind, key), count)| format!("{kind} {key}{}", times(count))).collect()
}

/// A counted store with three scenes that are simulated and have masks.
fn made() -> (Arc<Counting>, Store, DatasetSettings) {
    let counting = Arc::new(Counting::default());
    let (store, settings) = (Store::new(counting.clone()), example_settings());
    simulated(&store, &settings);
    let run = run_of(&settings, &store, |job| write(job, 10));
    assert_eq!(all(&run).expect("runs"), EXIT_DONE);
    counting.take();
    (counting, store, settings)
}

#[test]
fn a_scene_is_listed_once_and_each_manifest_is_read_once() {
    let (counting, store, settings) = made();
    let editions = Editions::only(&settings);
    let status = Status::new(&store, &editions, &COMMITTED);
    let mut done = 0;
    overview(&status, &mut Remembered::default(), |_, states| {
        done += states.iter().filter(|state| **state == State::Done).count()
    })
    .expect("is told");
    assert_eq!(done, 6, "logs and masks");
    let expected: Vec<String> = ["list scenes/0000", "list scenes/0001", "list scenes/0002"]
        .into_iter()
        .chain(["read plan/_manifest.json"])
        .map(str::to_owned)
        .chain((0..3).flat_map(|scene| {
            ["bev-gt", "simulate-and-log"]
                .map(|stage| format!("read scenes/000{scene}/_manifests/{stage}.json"))
        }))
        .collect();
    let mut asked = told(&counting.take());
    // Statistics were never made.
    asked.retain(|request| request != "list stats");
    assert_eq!(asked, expected);
}

#[test]
fn a_scene_that_was_done_is_not_looked_at_again_by_one_plan() {
    let (counting, store, settings) = made();
    for stage in scene_stages().filter(|stage| !["simulate-and-log", "bev-gt"].contains(&stage.name)) {
        // Two scenes have all their stages.
        for scene in [0, 2] {
            finished(&store, &settings, stage.name, Scope::Scene(scene));
        }
    }
    let editions = Editions::only(&settings);
    let mut remembered = Remembered::default();
    let mut look = || {
        let mut told = Vec::new();
        let status = Status::new(&store, &editions, &COMMITTED);
        let done = |states: &[State]| states.iter().filter(|state| **state == State::Done).count();
        let seen = overview(&status, &mut remembered, |scene, states| told.push((scene, done(states))));
        let stats = seen.expect("is told").stats.into_iter().map(|(stage, state)| (stage.name, state));
        (told, stats.collect::<Vec<_>>())
    };
    let all = scene_stages().count();
    counting.take();
    let first = look();
    assert_eq!(first.0, [(0, all), (1, 2), (2, all)]);
    counting.take();
    assert_eq!(look(), first);
    let lists = |requests: &BTreeMap<(&'static str, String), u32>| {
        let scenes = requests.keys().filter(|(kind, key)| *kind == "list" && key.starts_with("scenes/"));
        scenes.map(|(_, key)| key.clone()).collect::<Vec<_>>()
    };
    assert_eq!(lists(&counting.take()), ["scenes/0001"]);
    let plan = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("stands");
    let other = Manifest { inputs: BTreeMap::from([("map".into(), "other".into())]), ..plan.clone() };
    store.replace_manifest(Scope::Plan, &plan, &other).expect("replaces");
    counting.take();
    look();
    assert_eq!(lists(&counting.take()).len(), 3, "another plan: all are looked at");
}

#[test]
fn a_stage_with_nothing_to_do_asks_no_more() {
    let (counting, store, settings) = made();
    let run = run_of(&settings, &store, |_| panic!("nothing is to be done"));
    assert_eq!(all(&run).expect("keeps all"), EXIT_DONE);
    let asked = counting.take();
    let twice: Vec<_> = asked.iter().filter(|(_, count)| **count > 1).collect();
    assert!(twice.is_empty(), "{twice:?}");
    let kinds: BTreeMap<&str, u32> = asked.iter().fold(BTreeMap::new(), |mut kinds, ((kind, _), count)| {
        *kinds.entry(*kind).or_default() += count;
        kinds
    });
    // The plan, `dataset.json` for its name, two manifests a scene and one listing each.
    assert_eq!(kinds, BTreeMap::from([("list", 3), ("read", 8)]), "{:?}", told(&asked));
}

#[test]
fn other_scenes_are_not_looked_at_when_one_is_made_again() {
    let (counting, store, settings) = made();
    let mut run = run_of(&settings, &store, |job| write(job, 11));
    run.force = true;
    assert_eq!(some(&run, &SCENES[1..2]).expect("runs"), EXIT_DONE);
    let others = ["scenes/0000", "scenes/0002"];
    let asked = counting.take();
    let stray: Vec<_> =
        asked.keys().filter(|(_, key)| key.is_empty() || others.iter().any(|o| key.contains(o))).collect();
    assert!(stray.is_empty(), "{stray:?}");
    assert!(asked.contains_key(&("sweep", r#"Below("scenes/0001")"#.to_owned())), "{asked:?}");
}
