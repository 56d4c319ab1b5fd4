//! One plan at a time: who works on a store, and for what.
//!
//! Each process has an object of its own below [`keys::LOCKS`], whose name says for which work it is. Those
//! of one work share the store. Those of different works take turns as in Lamport's bakery, which needs
//! nothing but objects that are put whole and seen by whoever looks next: a process puts its object
//! ("choosing"), looks, draws a number higher than those that it sees ("waiting"), and waits until those of
//! lower numbers hold the store, and it is refused, or are gone. So of several that start at once one gets
//! the store, and who is refused keeps nobody else out. Who sees none of other work at the first look needs
//! no number.
//!
//! A holder puts its object again every few seconds, with another count. One of this machine is dead when its
//! process is gone; another one when its object has stayed the same for a while by the clock of who watches.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::backend::Area;
use crate::holder::Holder;
use crate::manifest::to_json;
use crate::{Store, StoreError, hash_bytes, keys, process};

/// What a store is held for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    /// Those of equal keys share a store.
    pub key: String,
    /// For people.
    pub name: String,
}

impl Work {
    /// Work that shares the store with nobody.
    #[must_use]
    pub fn alone(name: &str) -> Self {
        Self {
            key: format!("{name} {} {}", process::machine().unwrap_or_default(), tag()),
            name: name.into(),
        }
    }
}

/// How often is looked and told.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// A holder tells that it is alive as often as this.
    pub beat: Duration,
    /// Who has not told anything for so long is dead.
    pub dead: Duration,
    /// Who waits looks as often as this.
    pub look: Duration,
}

impl Default for Pace {
    fn default() -> Self {
        let [beat, dead, look] = [10_000, 60_000, 50].map(Duration::from_millis);
        Self { beat, dead, look }
    }
}

/// Who is told what happens, and asked whether to go on.
pub trait LockEvents: Send + Sync {
    /// Whether to wait no longer.
    fn is_stopped(&self) -> bool;
    /// Whether another one is alive is not known yet, and it is watched.
    fn watches(&self, holder: &Holder);
    /// Some that held the store are dead, and were removed.
    fn takes_over(&self, from: &[Holder]);
    /// Others believed this process dead, and one works on the store now.
    fn is_lost(&self, to: &Holder);
}

/// A store that is held. Dropping it lets it go.
#[derive(Debug)]
pub struct Lock {
    tells: Option<Sender<()>>,
    heart: Option<JoinHandle<()>>,
}

impl Lock {
    /// Holds a store for some work, together with all of the same work.
    ///
    /// # Errors
    /// [`StoreError::Held`]: somebody works on something else, or it was stopped while it waited; or the
    /// store cannot be read or written.
    pub fn hold(
        store: &Store,
        work: &Work,
        pace: Pace,
        events: Arc<dyn LockEvents>,
    ) -> Result<Self, StoreError> {
        let mut own = Own::put(store, work, Holder::this(&work.name), pace)?;
        let listed = own.listed()?;
        let mut dead = own.sweep(&listed)?;
        let others = own.others(listed)?;
        if !others.is_empty() {
            let turns = others.iter().map(|key| Ok(own.entry_of(key)?.and_then(|(entry, _)| entry.turn())));
            let turns: Vec<Option<u32>> = turns.collect::<Result<_, StoreError>>()?;
            own.set(Turn::Waiting(1 + turns.into_iter().flatten().max().unwrap_or(0)))?;
            dead.extend(own.wait(events.as_ref())?);
        }
        own.set(Turn::Holding)?;
        if !dead.is_empty() {
            dead.sort_by(|a, b| a.since.cmp(&b.since));
            events.takes_over(&dead);
        }
        let path = store.location(&own.key);
        let (tells, told) = channel();
        let heart =
            std::thread::Builder::new().name("lock".into()).spawn(move || own.beat_on(&told, &events));
        let heart = heart.map_err(|e| StoreError::write(path, "watch over the lock", e))?;
        Ok(Self { tells: Some(tells), heart: Some(heart) })
    }

    /// Removes what writers of locks left that were killed; the locks of the dead go with the next
    /// [`Lock::hold`].
    ///
    /// # Errors
    /// The store cannot be listed or changed.
    pub fn sweep(store: &Store) -> Result<usize, StoreError> {
        store.backend().sweep(Area::Below(keys::LOCKS), keys::LOCKS)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        drop(self.tells.take());
        if let Some(heart) = self.heart.take() {
            // It removes its object when it ends, even by a panic.
            let _ = heart.join();
        }
    }
}

/// How far a process has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Turn {
    /// It looks which number to draw.
    Choosing,
    /// It has drawn one.
    Waiting(u32),
    /// It works.
    Holding,
}

/// An object below [`keys::LOCKS`].
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Entry {
    work: String,
    holder: Holder,
    turn: Turn,
    beat: u64,
}

impl Entry {
    fn turn(&self) -> Option<u32> {
        if let Turn::Waiting(turn) = self.turn { Some(turn) } else { None }
    }
}

/// Tells objects of one process apart.
pub(crate) fn tag() -> String {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    // A name only has to differ from others.
    let nanos = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos());
    format!("{}~{nanos:x}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed))
}

/// What an object's name tells of it without being read.
struct Named<'k> {
    work: &'k str,
    host: &'k str,
    process: u32,
}

impl<'k> Named<'k> {
    fn parse(key: &'k str) -> Option<Self> {
        let name = key.strip_prefix(keys::LOCKS)?.strip_prefix('/')?.strip_suffix(".json")?;
        let mut parts = name.split('~');
        let (work, host) = (parts.next()?, parts.next()?);
        Some(Self { work, host, process: parts.next()?.parse().ok()? })
    }
}

/// The first part of an object's name, by its work.
fn name_of(work: &str) -> String {
    hash_bytes(work.as_bytes()).chars().take(16).collect()
}

/// The object of this process. Dropping it removes it.
struct Own {
    store: Store,
    key: String,
    work: Work,
    entry: Entry,
    pace: Pace,
    told: Instant,
}

impl Own {
    fn put(store: &Store, work: &Work, holder: Holder, pace: Pace) -> Result<Self, StoreError> {
        let key = format!("{}/{}~{}~{}.json", keys::LOCKS, name_of(&work.key), holder.host, tag());
        let entry = Entry { work: work.key.clone(), holder, turn: Turn::Choosing, beat: 0 };
        if !store.backend().put_if_absent(&key, keys::LOCKS, &to_json(&entry))? {
            let problem = "another process has the same name, number and time".to_owned();
            return Err(StoreError::Corrupt { path: store.location(&key), problem });
        }
        Ok(Self { store: store.clone(), key, work: work.clone(), entry, pace, told: Instant::now() })
    }

    /// All objects that tell who is at work.
    fn listed(&self) -> Result<Vec<String>, StoreError> {
        self.store.backend().keys(keys::LOCKS)
    }

    /// Objects of other work, out of those that were listed. They are listed once more: some file systems
    /// miss a file that is replaced while its folder is read.
    fn others(&self, listed: Vec<String>) -> Result<BTreeSet<String>, StoreError> {
        let own = name_of(&self.work.key);
        let mut found: BTreeSet<String> = listed.into_iter().chain(self.listed()?).collect();
        found.retain(|key| Named::parse(key).is_some_and(|named| named.work != own));
        Ok(found)
    }

    /// An object, if it is there, and its bytes. One that cannot be understood holds the store, whoever it
    /// is.
    fn entry_of(&self, key: &str) -> Result<Option<(Entry, Vec<u8>)>, StoreError> {
        let Some(bytes) = self.store.read(key)? else { return Ok(None) };
        let entry = serde_json::from_slice(&bytes).unwrap_or_else(|_| {
            let named = Named::parse(key);
            let holder = Holder {
                work: "a lock of another version".into(),
                owner: "somebody".into(),
                host: named.as_ref().map_or("?", |named| named.host).to_owned(),
                process: named.map_or(0, |named| named.process),
                since: "?".into(),
                machine: None,
                started: None,
            };
            Entry { work: String::new(), holder, turn: Turn::Holding, beat: 0 }
        });
        Ok(Some((entry, bytes)))
    }

    /// Removes what dead processes of this machine left that did the same work, out of what was listed:
    /// nobody else looks at them.
    fn sweep(&self, listed: &[String]) -> Result<Vec<Holder>, StoreError> {
        let (own, host) = (name_of(&self.work.key), &self.entry.holder.host);
        let mut dead = Vec::new();
        for key in listed {
            let is_ended = |named: Named<'_>| {
                named.work == own && named.host == *host && !process::is_running(named.process)
            };
            if Named::parse(key).is_some_and(is_ended)
                && let Some((entry, _)) = self.entry_of(key)?
                && entry.holder.is_running() == Some(false)
            {
                self.store.backend().remove(key)?;
                dead.push(entry.holder);
            }
        }
        Ok(dead)
    }

    /// Waits until nobody of other work is before this one; who of them turned out to be dead.
    fn wait(&mut self, events: &dyn LockEvents) -> Result<Vec<Holder>, StoreError> {
        let others = self.others(self.listed()?)?.into_iter();
        let mut watched: BTreeMap<String, Watched> = others.map(|key| (key, Watched::default())).collect();
        let mut dead = Vec::new();
        loop {
            let mut before = BTreeMap::new();
            let mut first = None;
            for (key, mut watch) in watched {
                // Who is gone is not before us.
                let Some((entry, bytes)) = self.entry_of(&key)? else { continue };
                let life = watch.look(bytes, &entry.holder, self.pace.dead);
                match entry.turn {
                    _ if life == Life::Dead => {
                        self.store.backend().remove(&key)?;
                        dead.push(entry.holder);
                        continue;
                    }
                    Turn::Holding if life == Life::Alive => return Err(self.refused(entry.holder)),
                    // Who has drawn a higher number sees ours, and waits for us.
                    Turn::Waiting(turn) if (Some(turn), &key) > (self.entry.turn(), &self.key) => continue,
                    _ => {}
                }
                if life == Life::Unknown && watch.is_long() {
                    events.watches(&entry.holder);
                }
                first.get_or_insert(entry.holder);
                before.insert(key, watch);
            }
            let Some(first) = first else { return Ok(dead) };
            if events.is_stopped() {
                return Err(self.refused(first));
            }
            watched = before;
            if self.told.elapsed() > self.pace.beat {
                self.set(self.entry.turn)?;
            }
            std::thread::sleep(self.pace.look);
        }
    }

    fn refused(&self, holder: Holder) -> StoreError {
        let (path, work) = (self.store.location(""), self.work.name.clone());
        StoreError::Held { path, holder: Box::new(holder), work }
    }

    /// Puts the object again; whether it was still there.
    fn tell(&mut self) -> Result<bool, StoreError> {
        let is_there = self.store.backend().size(&self.key)?.is_some();
        self.entry.beat += 1;
        let mut sink = self.store.backend().create(&self.key, keys::LOCKS)?;
        let written = sink.write_all(&to_json(&self.entry));
        written.map_err(|e| StoreError::write(self.store.location(&self.key), "write", e))?;
        sink.commit()?;
        self.told = Instant::now();
        Ok(is_there)
    }

    fn set(&mut self, turn: Turn) -> Result<(), StoreError> {
        self.entry.turn = turn;
        if self.tell()? {
            return Ok(());
        }
        let removed = std::io::Error::other("another process believed this one dead and removed it");
        Err(StoreError::write(self.store.location(&self.key), "keep the lock", removed))
    }

    /// Tells that this process is alive until it is told to end. A store that cannot be written just now
    /// stops nobody. One that others took over does.
    fn beat_on(mut self, told: &Receiver<()>, events: &Arc<dyn LockEvents>) {
        while told.recv_timeout(self.pace.beat) == Err(RecvTimeoutError::Timeout) {
            // Removed: by others, or by hand. Ours is put before the others are looked for.
            if matches!(self.tell(), Ok(false))
                && let Ok(others) = self.listed().and_then(|listed| self.others(listed))
                && let Some(Ok(Some((other, _)))) = others.first().map(|key| self.entry_of(key))
            {
                events.is_lost(&other.holder);
                return;
            }
        }
    }
}

impl Drop for Own {
    fn drop(&mut self) {
        // What cannot be removed now is dead to whoever looks.
        let _ = self.store.backend().remove(&self.key);
    }
}

/// Whether a process lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Life {
    Alive,
    Dead,
    Unknown,
}

/// How an object changes.
#[derive(Default)]
struct Watched {
    /// Its bytes, and since when they are these.
    last: Option<(Vec<u8>, Instant)>,
    is_told: bool,
    has_changed: bool,
}

impl Watched {
    fn look(&mut self, bytes: Vec<u8>, holder: &Holder, dead: Duration) -> Life {
        let is_same = self.last.as_ref().is_some_and(|(last, _)| *last == bytes);
        if !is_same {
            self.has_changed = self.last.is_some();
            self.last = Some((bytes, Instant::now()));
        }
        match holder.is_running() {
            Some(true) => Life::Alive,
            Some(false) => Life::Dead,
            None if self.last.as_ref().is_some_and(|(_, since)| since.elapsed() > dead) => Life::Dead,
            None if self.has_changed => Life::Alive,
            None => Life::Unknown,
        }
    }

    /// Whether it has been looked at for some time; once.
    fn is_long(&mut self) -> bool {
        let is_long = self.last.as_ref().is_some_and(|(_, since)| since.elapsed() > LONG);
        is_long && !std::mem::replace(&mut self.is_told, true)
    }
}

/// Who waits longer says so.
const LONG: Duration = Duration::from_secs(1);

#[cfg(test)]
mod tests;
