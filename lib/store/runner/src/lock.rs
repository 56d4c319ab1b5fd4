//! One plan at a time: workers of one configuration share a store, others are refused.

use std::path::Path;
use std::sync::Arc;

use settings::DatasetSettings;
use store::{Holder, Lock, LockEvents, Pace, Store, StoreError, Work};

use crate::editions;
use crate::error::StageError;
use crate::interrupt;

/// By what workers share a store: a digest of their resolved configuration.
fn key(settings: &DatasetSettings) -> Result<String, serde_json::Error> {
    Ok(store::hash_bytes(&serde_json::to_vec(settings)?))
}

/// Holds a store while a program works on it by a configuration. A place that cannot be written at all is
/// not held: nobody can change it.
///
/// # Errors
/// Somebody works by another configuration, the store cannot be read or written, or a signal came.
pub(crate) fn hold(
    store: &Store,
    settings: &DatasetSettings,
    program: &str,
) -> Result<Option<Lock>, StageError> {
    let key = key(settings).map_err(StageError::usage)?;
    let digest: String = key.chars().take(8).collect();
    let name = format!("{program} of `{}`, configuration {digest}", settings.name);
    held(store, &Work { key, name })
}

/// Holds a store while all stages are run, one after the other. Where there is no configuration or no store,
/// nothing is held, and the first stage says why.
///
/// # Errors
/// Somebody works by another configuration, the store cannot be read or written, or a signal came.
pub fn hold_for_all_stages(config: Option<&Path>, store: &Path) -> Result<Option<Lock>, StageError> {
    let store = match Store::open(store) {
        // A service that is away was waited for already.
        Err(away) if away.is_transient() => return Err(away.into()),
        opened => opened.ok(),
    };
    let Some(store) = store else { return Ok(None) };
    let settings = match config {
        Some(config) => settings::load(config).ok().map(|(settings, _)| settings),
        None => editions::newest_recorded(&store).ok(),
    };
    settings.map_or(Ok(None), |settings| hold(&store, &settings, "convoy run"))
}

/// Holds a store for work that goes together with no other.
///
/// # Errors
/// Somebody works on it, it or its locks cannot be read or written, or a signal came.
pub fn hold_alone(store: &Store, program: &str) -> Result<Lock, StageError> {
    // Without a lock others would be at work at the same time.
    held(store, &Work::alone(program))?.ok_or_else(|| {
        let place = store.location("_locks");
        StageError::usage(format!("{place}: cannot be written, so others cannot be kept away meanwhile"))
    })
}

fn held(store: &Store, work: &Work) -> Result<Option<Lock>, StageError> {
    use std::io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
    // A process has one lock: what it finds unfinished is of others that were killed, and harms nobody.
    let _ = Lock::sweep(store);
    match Lock::hold(store, work, Pace::default(), Arc::new(Teller)) {
        Ok(lock) => Ok(Some(lock)),
        Err(_) if interrupt::stopped() => Err(StageError::Stopped),
        Err(StoreError::Write { source, .. })
            if matches!(source.kind(), PermissionDenied | ReadOnlyFilesystem) =>
        {
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

/// Tells of locks, and stops the work when the lock is lost.
struct Teller;

impl LockEvents for Teller {
    fn is_stopped(&self) -> bool {
        interrupt::stopped()
    }

    fn watches(&self, holder: &Holder) {
        tracing::info!("{}", waiting(holder));
    }

    fn takes_over(&self, from: &[Holder]) {
        if let Some(taken) = taken_over(from) {
            tracing::warn!("{taken}");
        }
    }

    fn is_lost(&self, to: &Holder) {
        tracing::error!("{}", lost(to));
        interrupt::stop();
    }
}

fn waiting(holder: &Holder) -> String {
    format!("waits to see whether this one still works on the store: {holder}")
}

fn taken_over(from: &[Holder]) -> Option<String> {
    let (first, others) = from.split_first()?;
    let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
    Some(format!(
        "takes over what {first}{more} held: ended without a word; others that work on the store go on"
    ))
}

fn lost(to: &Holder) -> String {
    format!("nothing was heard from this process for a while, and the store went to {to}: stops")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::example_settings;

    #[test]
    fn workers_share_by_all_that_makes_the_dataset() {
        let settings = example_settings();
        let same = |change: fn(&mut DatasetSettings)| {
            let mut other = settings.clone();
            change(&mut other);
            key(&settings).expect("is JSON") == key(&other).expect("is JSON")
        };
        assert!(same(|_| ()));
        // How the store is kept is nothing of the dataset.
        assert!(same(|s| s.store.ask_beyond_s = 1.0));
        assert!(!same(|s| s.name = "other".into()));
        assert!(!same(|s| s.tracks.future_s = 3.0));
        assert!(!same(|s| s.scenes.clear()));
    }

    #[test]
    fn a_held_store_is_worth_another_try() {
        let store = Store::open("memory:").expect("is a place");
        let settings = example_settings();
        let mut other = settings.clone();
        other.seed += 1;
        let lock = hold(&store, &settings, "bev-gt").expect("is free");
        hold(&store, &settings, "stats").expect("shares");
        let refused = hold(&store, &other, "bev-gt").expect_err("is held");
        assert_eq!(refused.exit_code(), crate::EXIT_TRY_AGAIN);
        assert!(refused.report().contains("(bev-gt of `dataset`, configuration "), "{}", refused.report());
        assert!(hold_alone(&store, "convoy tidy").is_err());
        drop(lock);
        let alone = hold_alone(&store, "convoy tidy").expect("is free");
        assert!(hold(&store, &other, "bev-gt").is_err());
        drop(alone);
        hold(&store, &other, "bev-gt").expect("is free");
    }

    #[test]
    fn holders_are_named_to_people() {
        let holder = |process: u32| -> Holder {
            let said = serde_json::json!({
                "work": "convoy run of `town`, configuration 0a1b2c3d",
                "owner": "mira",
                "host": "node-7",
                "process": process,
                "since": "2026-11-28T09:00:00Z",
            });
            serde_json::from_value(said).expect("is a holder")
        };
        insta::assert_snapshot!(waiting(&holder(17)), @"waits to see whether this one still works on the store: mira on node-7, process 17, since 2026-11-28T09:00:00Z (convoy run of `town`, configuration 0a1b2c3d)");
        assert_eq!(taken_over(&[]), None);
        let taken = [&[holder(17)][..], &[holder(17), holder(18), holder(19)]].map(taken_over);
        insta::assert_snapshot!(taken.map(Option::unwrap_or_default).join("\n"), @"
        takes over what mira on node-7, process 17, since 2026-11-28T09:00:00Z (convoy run of `town`, configuration 0a1b2c3d) held: ended without a word; others that work on the store go on
        takes over what mira on node-7, process 17, since 2026-11-28T09:00:00Z (convoy run of `town`, configuration 0a1b2c3d) and 2 more held: ended without a word; others that work on the store go on
        ");
        insta::assert_snapshot!(lost(&holder(17)), @"nothing was heard from this process for a while, and the store went to mira on node-7, process 17, since 2026-11-28T09:00:00Z (convoy run of `town`, configuration 0a1b2c3d): stops");
    }
}
