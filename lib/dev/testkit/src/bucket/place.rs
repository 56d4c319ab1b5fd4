//! What a server keeps.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What is kept.
#[derive(Default)]
pub(crate) struct Place {
    pub(crate) objects: BTreeMap<String, Object>,
    /// Uploads by number: the key, and parts by number.
    pub(crate) uploads: BTreeMap<u64, (String, BTreeMap<u32, Vec<u8>>)>,
    pub(crate) changes: u64,
    pub(crate) ignores_conditions: bool,
}

/// An object, and what tells its versions apart.
#[derive(Clone)]
pub(crate) struct Object {
    pub(crate) bytes: Arc<Vec<u8>>,
    pub(crate) version: u64,
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
