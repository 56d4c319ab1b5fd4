//! Manifests as they were found.

use std::sync::{Arc, OnceLock};

use store::{Manifest, Scope, Store, StoreError};

use crate::state::{Staleness, State};

/// A stage's manifest as it was found, with its digest once that was asked for.
#[derive(Debug)]
pub(crate) struct Record {
    /// None: the stage has not been done. What is damaged is stale: it can be made again as if something had
    /// changed.
    found: Result<Option<Manifest>, State>,
    digest: OnceLock<String>,
}

impl Record {
    /// Reads it.
    pub(crate) fn read(store: &Store, scope: Scope, stage: &str) -> Result<Arc<Self>, StoreError> {
        let found = match store.manifest(scope, stage) {
            Err(StoreError::Corrupt { path, problem }) => {
                Err(State::Stale(Staleness::Damaged(format!("{path} is damaged ({problem})"))))
            }
            other => Ok(other?),
        };
        Ok(Arc::new(Self { found, digest: OnceLock::new() }))
    }

    /// That of a stage that has not been done.
    pub(crate) fn none() -> Arc<Self> {
        Arc::new(Self { found: Ok(None), digest: OnceLock::new() })
    }

    /// One that is known to be sound, for tests.
    #[cfg(test)]
    pub(crate) fn of(manifest: Manifest) -> Arc<Self> {
        Arc::new(Self { found: Ok(Some(manifest)), digest: OnceLock::new() })
    }

    /// The manifest, or what is wrong with it.
    pub(crate) fn manifest(&self) -> Result<Option<&Manifest>, &State> {
        self.found.as_ref().map(Option::as_ref)
    }

    /// The manifest, where it is sound.
    pub(crate) fn sound(&self) -> Option<&Manifest> {
        self.manifest().unwrap_or_default()
    }

    /// Digest of the whole manifest; empty where there is none.
    pub(crate) fn digest(&self) -> &str {
        self.digest.get_or_init(|| self.sound().map(Manifest::digest).unwrap_or_default())
    }
}
