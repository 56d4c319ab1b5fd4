//! Whether a place keeps what a store rests on, tried before a plan is made.

use crate::lock::tag;
use crate::process::{is_running, marked_host};
use crate::{Store, StoreError, keys};

/// First part of the names of what is put to try a place.
const PROBE: &str = "probe-";

/// Tries a place: of two that put one object, one succeeds; what was put is listed at once, and is read whole
/// and in part; what was removed is gone. Services ignore conditions, list late, or let a folder on a network
/// be seen by others only after a while: a store there would be ruined without a word.
///
/// # Errors
/// [`StoreError::Unfit`] names what failed; or the place cannot be read or written at all.
pub fn probe(store: &Store) -> Result<(), StoreError> {
    let backend = store.backend();
    let own = format!("{}/{PROBE}{}~", keys::LOCKS, marked_host());
    let key = format!("{own}{}", tag());
    // What processes of this machine left that were killed meanwhile.
    for left in backend.keys(keys::LOCKS)? {
        let process = left.strip_prefix(&own).and_then(|rest| rest.split('~').next()?.parse().ok());
        if process.is_some_and(|process| !is_running(process)) {
            backend.remove(&left)?;
        }
    }
    let unfit = |problem: &str| StoreError::Unfit { path: store.location(""), problem: problem.to_owned() };
    let (first, second) = (*b"of two that put one object", *b"one succeeds");
    let tried = (|| {
        if !backend.put_if_absent(&key, keys::LOCKS, &first)? {
            return Err(unfit("an object that nobody put is said to be there"));
        }
        if backend.put_if_absent(&key, keys::LOCKS, &second)? {
            return Err(unfit("of two that put an object where there is none, both succeed"));
        }
        if backend.read(&key)?.as_deref() != Some(&first[..]) {
            return Err(unfit("an object is read back with other bytes"));
        }
        let opened = backend.open(&key, Some(first.len() as u64))?;
        let part = opened.read_at(3..6).map_err(|e| StoreError::read(&key, "read a part of", e))?;
        if part != first[3..6] {
            return Err(unfit("a part of an object is read back with other bytes"));
        }
        if !backend.keys(keys::LOCKS)?.contains(&key) {
            return Err(unfit("an object that was put is not listed at once"));
        }
        Ok(())
    })();
    backend.remove(&key)?;
    tried?;
    if backend.size(&key)?.is_some() || backend.keys(keys::LOCKS)?.contains(&key) {
        return Err(unfit("an object that was removed is still there"));
    }
    Ok(())
}

/// Removes what killed processes left that tried a place; for who holds the store alone.
///
/// # Errors
/// The place cannot be listed or changed.
pub fn remove_probes(store: &Store) -> Result<(), StoreError> {
    let start = format!("{}/{PROBE}", keys::LOCKS);
    let left = store.backend().keys(keys::LOCKS)?.into_iter().filter(|key| key.starts_with(&start));
    left.into_iter().try_for_each(|key| store.backend().remove(&key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_killed_processes_of_this_machine_left_is_removed() {
        let mut ended = std::process::Command::new("true").spawn().expect("starts");
        ended.wait().expect("ends");
        let store = Store::open("memory:").expect("opens");
        let (own, host) = (std::process::id(), marked_host());
        let names = [
            format!("{host}~{}~1-0", ended.id()),
            format!("{host}~{own}~1-0"),
            format!("elsewhere+0~{}~1-0", ended.id()),
        ];
        let [left, ours, foreign] = names.map(|name| format!("{}/{PROBE}{name}", keys::LOCKS));
        for key in [&left, &ours, &foreign] {
            assert!(store.backend().put_if_absent(key, keys::LOCKS, b"").expect("puts"));
        }
        probe(&store).expect("is fit");
        let mut there = vec![ours, foreign];
        there.sort();
        assert_eq!(store.backend().keys(keys::LOCKS).expect("lists"), there);
        remove_probes(&store).expect("removes");
        assert_eq!(store.backend().keys(keys::LOCKS).expect("lists"), Vec::<String>::new());
    }
}
