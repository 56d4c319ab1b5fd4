//! The protocol on both places: sharing, refusing, taking over, and what goes wrong.

use std::sync::{Barrier, Mutex, PoisonError};

use super::*;
use crate::Memory;

/// What a lock told, in words.
#[derive(Default)]
struct Told {
    lines: Mutex<Vec<String>>,
    is_stopped: bool,
}

impl Told {
    fn lines(&self) -> Vec<String> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn add(&self, line: String) {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).push(line);
    }
}

impl LockEvents for Told {
    fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    fn watches(&self, holder: &Holder) {
        self.add(format!("watches {}", holder.host));
    }

    fn takes_over(&self, from: &[Holder]) {
        let hosts: Vec<&str> = from.iter().map(|holder| holder.host.as_str()).collect();
        self.add(format!("takes over from {}", hosts.join(", ")));
    }

    fn is_lost(&self, to: &Holder) {
        self.add(format!("lost to {}", to.host));
    }
}

fn work(key: &str) -> Work {
    Work { key: key.to_owned(), name: format!("work {key}") }
}

/// Nobody of this machine is judged by time, nor anybody by accident on a slow one.
const PACE: Pace =
    Pace { beat: Duration::from_millis(20), dead: Duration::from_secs(30), look: Duration::from_millis(2) };
/// The dead of elsewhere are judged soon.
const SOON: Pace = Pace { dead: Duration::from_millis(300), ..PACE };

/// A process of another machine.
fn elsewhere(host: &str) -> Holder {
    Holder { host: host.into(), machine: Some("elsewhere".into()), ..Holder::this("work of elsewhere") }
}

fn hold(store: &Store, key: &str, pace: Pace) -> (Result<Lock, StoreError>, Arc<Told>) {
    let told = Arc::new(Told::default());
    (Lock::hold(store, &work(key), pace, told.clone()), told)
}

/// Expects to hold a store without a word.
#[track_caller]
fn held(store: &Store, key: &str) -> Lock {
    let (lock, told) = hold(store, key, PACE);
    assert_eq!(told.lines(), [""; 0]);
    lock.expect("is free")
}

#[track_caller]
fn refused(store: &Store, key: &str, pace: Pace) -> Holder {
    match hold(store, key, pace) {
        (Err(StoreError::Held { holder, work, .. }), _) if work == format!("work {key}") => *holder,
        (other, _) => panic!("{other:?}"),
    }
}

/// An object of another process, which stays as it is.
fn left(store: &Store, key: &str, holder: Holder, turn: Turn) -> String {
    let mut own = Own::put(store, &work(key), holder, PACE).expect("puts");
    own.set(turn).expect("puts");
    let key = own.key.clone();
    // As a killed process leaves it.
    std::mem::forget(own);
    key
}

fn locks(store: &Store) -> Vec<String> {
    store.backend().keys(keys::LOCKS).expect("lists")
}

/// On a disk and in memory.
fn on_both(test: impl Fn(&Store)) {
    test(&Store::open("memory:").expect("is a place"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    test(&Store::open(folder.path()).expect("is a folder"));
    // Folders exist for what is in them.
    assert_eq!(std::fs::read_dir(folder.path()).expect("reads").count(), 0);
}

#[test]
fn equal_work_shares_and_other_work_waits() {
    on_both(|store| {
        let (first, second) = (held(store, "a"), held(store, "a"));
        assert_eq!(locks(store).len(), 2);
        let holder = refused(store, "b", PACE);
        assert_eq!((holder.process, holder.work.as_str()), (std::process::id(), "work a"));
        drop(first);
        refused(store, "b", PACE);
        drop(second);
        let other = held(store, "b");
        refused(store, "a", PACE);
        drop(other);
        let alone = Lock::hold(store, &Work::alone("tidy"), PACE, Arc::new(Told::default()));
        let alone = alone.expect("is free");
        let second = Lock::hold(store, &Work::alone("tidy"), PACE, Arc::new(Told::default()));
        assert!(matches!(second, Err(StoreError::Held { .. })), "{second:?}");
        drop(alone);
        assert_eq!(locks(store), [""; 0]);
    });
}

/// Of many that start at once those of one work get the store, whichever it is, and no others.
#[test]
fn of_several_at_once_one_work_gets_the_store() {
    on_both(|store| {
        for round in 0..12_usize {
            let count = 2 + round % 5;
            let (start, end) = (Barrier::new(count), Barrier::new(count));
            let outcomes = Mutex::new(Vec::new());
            std::thread::scope(|scope| {
                for i in 0..count {
                    let (start, end, outcomes) = (&start, &end, &outcomes);
                    scope.spawn(move || {
                        let key = ["a", "b", "c"][i % 3_usize.min(count)];
                        start.wait();
                        let (lock, told) = hold(store, key, PACE);
                        let refused = matches!(&lock, Err(StoreError::Held { .. }));
                        let outcome = (key, lock.is_ok(), refused, told.lines());
                        outcomes.lock().unwrap_or_else(PoisonError::into_inner).push(outcome);
                        end.wait();
                        drop(lock);
                    });
                }
            });
            let outcomes = outcomes.into_inner().expect("is whole");
            let is_right = |(_, works, refused, told): &(&str, bool, bool, Vec<String>)| {
                (*works != *refused) && told.is_empty()
            };
            assert!(outcomes.iter().all(is_right), "round {round}: {outcomes:?}");
            let mut works = outcomes.iter().filter(|(_, works, ..)| *works).map(|(key, ..)| *key);
            let winner = works.next().expect("one of them works");
            assert!(works.all(|key| key == winner), "round {round}: {outcomes:?}");
            assert_eq!(locks(store), [""; 0]);
        }
    });
}

/// A share of the work that starts while another configuration is being refused is not refused with it.
#[test]
fn who_is_refused_keeps_nobody_out() {
    on_both(|store| {
        let holder = held(store, "a");
        let slip = left(store, "b", Holder::this("work b"), Turn::Waiting(1));
        std::thread::scope(|scope| {
            let share = scope.spawn(|| hold(store, "a", PACE).0.map(drop));
            std::thread::sleep(Duration::from_millis(50));
            assert!(!share.is_finished(), "it waits for what becomes of the other one");
            store.backend().remove(&slip).expect("removes");
            share.join().expect("ends").expect("shares");
        });
        drop(holder);
    });
}

#[test]
fn the_dead_of_this_machine_are_taken_over_at_once() {
    on_both(|store| {
        // Another process had our number.
        let gone = |work: &str| Holder { started: Some(1), host: "here".into(), ..Holder::this(work) };
        for turn in [Turn::Choosing, Turn::Waiting(0), Turn::Holding] {
            left(store, "a", gone("first"), turn);
        }
        let (lock, told) = hold(store, "b", PACE);
        assert_eq!(told.lines(), ["takes over from here, here, here"]);
        assert_eq!(locks(store).len(), 1);
        drop(lock.expect("is free"));
        // One of the same work, whose number is nobody's now: it keeps nobody out, and is swept.
        let mut child = std::process::Command::new("true").spawn().expect("starts");
        child.wait().expect("ends");
        let own = Own::put(store, &work("a"), Holder::this("first"), PACE).expect("puts");
        let key = own.key.replace(&format!("~{}~", std::process::id()), &format!("~{}~", child.id()));
        let entry =
            Entry { holder: Holder { process: child.id(), ..own.entry.holder.clone() }, ..own.entry.clone() };
        assert!(store.backend().put_if_absent(&key, keys::LOCKS, &to_json(&entry)).expect("puts"));
        drop(own);
        let (lock, told) = hold(store, "a", PACE);
        assert_eq!(told.lines(), [format!("takes over from {}", process::host())]);
        assert_eq!(locks(store).len(), 1);
        drop(lock.expect("is free"));
    });
}

#[test]
fn others_are_judged_by_their_heartbeat() {
    on_both(|store| {
        left(store, "a", elsewhere("wolf"), Turn::Holding);
        let (lock, told) = hold(store, "b", SOON);
        assert_eq!(told.lines(), ["takes over from wolf"]);
        drop(lock.expect("is free"));

        let mut own = Own::put(store, &work("a"), elsewhere("bear"), PACE).expect("puts");
        own.set(Turn::Holding).expect("puts");
        let (tells, told) = channel();
        let events: Arc<dyn LockEvents> = Arc::new(Told::default());
        let heart = std::thread::spawn(move || own.beat_on(&told, &events));
        assert_eq!(refused(store, "b", PACE).host, "bear");
        drop(tells);
        heart.join().expect("ends");
        drop(held(store, "b"));
    });
}

#[test]
fn a_signal_ends_the_wait() {
    on_both(|store| {
        let key = left(store, "a", elsewhere("wolf"), Turn::Holding);
        let told = Arc::new(Told { is_stopped: true, ..Told::default() });
        let stopped = Lock::hold(store, &work("b"), PACE, told);
        assert!(matches!(stopped, Err(StoreError::Held { .. })), "{stopped:?}");
        assert_eq!(locks(store), [key.as_str()]);
        store.backend().remove(&key).expect("removes");
    });
}

#[test]
fn what_cannot_be_understood_holds_the_store_until_it_is_dead() {
    on_both(|store| {
        let key = format!("{}/0123456789abcdef~wolf~12~7.json", keys::LOCKS);
        assert!(store.backend().put_if_absent(&key, keys::LOCKS, b"{\"format\": 2}").expect("puts"));
        let told = Arc::new(Told { is_stopped: true, ..Told::default() });
        let stopped = Lock::hold(store, &work("a"), PACE, told).expect_err("is not known to be dead");
        assert!(stopped.to_string().contains("somebody on wolf, process 12"), "{stopped}");
        let (lock, told) = hold(store, "a", SOON);
        assert_eq!(told.lines(), ["takes over from wolf"]);
        drop(lock.expect("is free"));
    });
}

/// Waits until something is so.
#[track_caller]
fn until(what: impl Fn() -> bool) {
    let start = Instant::now();
    while !what() {
        assert!(start.elapsed() < Duration::from_secs(20), "it never is");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn who_was_believed_dead_stops_when_others_work() {
    on_both(|store| {
        let (lock, told) = hold(store, "a", PACE);
        let lock = lock.expect("is free");
        let own = locks(store);
        // Removed by hand: it is put again.
        store.backend().remove(&own[0]).expect("removes");
        until(|| locks(store) == own);
        assert_eq!(told.lines(), [""; 0]);
        // Taken over.
        let other = left(store, "b", elsewhere("wolf"), Turn::Holding);
        store.backend().remove(&own[0]).expect("removes");
        until(|| told.lines() == ["lost to wolf"]);
        until(|| locks(store) == [other.as_str()]);
        drop(lock);
        store.backend().remove(&other).expect("removes");
    });
}

#[test]
fn a_full_store_stops_no_heart() {
    let store = Store::new(Arc::new(Memory::with_capacity(20_000)));
    let lock = held(&store, "a");
    let own = &locks(&store)[0];
    let now = || store.read(own).expect("reads");
    let room = 20_000 - now().map_or(0, |bytes| bytes.len()) - 10;
    // Not while a beat is under way.
    until(|| store.backend().put_if_absent("full", "test", &vec![0; room]).unwrap_or(false));
    let before = now();
    std::thread::sleep(Duration::from_millis(100));
    store.backend().remove("full").expect("removes");
    until(|| now() != before);
    assert!(lock.heart.as_ref().is_some_and(|heart| !heart.is_finished()));
    drop(lock);
    assert_eq!(locks(&store), [""; 0]);
}

#[test]
fn locks_are_nothing_of_the_dataset() {
    on_both(|store| {
        let lock = held(store, "a");
        let left = store.backend().create(&format!("{}/x.json", keys::LOCKS), keys::LOCKS).expect("begins");
        let found = crate::verify(store, &[], |_| {}).expect("reads");
        assert_eq!(found, crate::Verification::default());
        drop((left, lock));
    });
}
