//! The file store: shards, manifests and their atomic commit.
//!
//! A shard becomes visible in one step and only when it is complete; a stage's manifest for a scene is
//! written last and names every shard with its checksum. Readers follow manifests. So a process can be killed
//! at any instant: what is named by a manifest is whole, what is not is swept at the next start.
//!
//! * [`Store::open`]: a store by its path or URL.
//! * [`Backend`]: the few operations a place of storage must offer, as [`Disk`], [`Objects`] and [`Memory`]
//!   do. Nothing above it renames or assumes a file system.
//! * [`keys`]: the layout, one function per kind of file.
//! * [`Manifest`], [`Attempt`], [`Unit`]: writing a stage's outputs.
//! * [`Store::read_rows`], [`Store::row_groups`]: reading tables.
//! * [`Lock`]: one plan at a time. [`probe`]: whether a place can hold a store at all.
//! * [`verify`]: re-hashing everything.

mod adopt;
mod attempt;
mod backend;
mod convert;
mod disk;
mod error;
mod finding;
mod groups;
mod holder;
pub mod keys;
mod known;
mod lock;
mod manifest;
mod memory;
mod objects;
mod parallel;
mod place;
mod probe;
mod process;
mod read;
mod roster;
mod shard;
mod strays;
mod table;
mod verify;
mod write;

use std::ffi::OsStr;
use std::sync::Arc;

pub use attempt::{Attempt, Identity, Unit};
pub use backend::{Area, Backend, LARGEST_READ, Listed, Listing, Shard, Sink, Unfinished};
pub use disk::Disk;
pub use error::StoreError;
pub use finding::{Finding, Problem};
pub use groups::RowGroups;
pub use holder::Holder;
pub use keys::Scope;
pub use lock::{Lock, LockEvents, Pace, Work};
pub use manifest::{Failure, MadeBy, Manifest, Output, Redo};
pub use memory::Memory;
pub use objects::{Objects, hurry_when};
pub use parallel::{Aside, aside, side_by_side};
pub use place::check_place;
pub use probe::{probe, remove_probes};
pub use read::TableHead;
pub use roster::{SceneKind, has_scenes, kind_names, scene_kinds, scenes_begun};
pub use shard::ShardStream;
pub use strays::{Strays, remove_strays};
pub use table::{EncodedGroup, GroupEncoder, TableOptions, TableWriter};
pub use verify::{Verification, verify};
pub use write::{FileWriter, Finished};

/// A store of one dataset. Cheap to clone.
#[derive(Clone)]
pub struct Store {
    backend: Arc<dyn Backend>,
}

impl Store {
    /// The store at a place: a folder, which need not exist yet, by its path or as `file:///FOLDER`; a folder
    /// of a bucket, as `s3://BUCKET/FOLDER`, `az://CONTAINER/FOLDER` or `gs://BUCKET/FOLDER`, whose service
    /// and credentials come from the environment; `memory:` is a fresh one that ends with the process.
    ///
    /// ```
    /// use store::{Scope, Store, StoreError};
    ///
    /// let store = Store::open("file:///data/town%2003")?;
    /// assert_eq!(store.location("plan/scenes.parquet"), "/data/town 03/plan/scenes.parquet");
    /// assert!(store.manifest(Scope::Plan, "spawn-planner")?.is_none());
    /// assert!(matches!(Store::open("ftp://server/set"), Err(StoreError::Place { .. })));
    /// # Ok::<(), StoreError>(())
    /// ```
    ///
    /// # Errors
    /// A URL of a kind that is not known, a file, or a store of another format.
    pub fn open(place: impl AsRef<OsStr>) -> Result<Self, StoreError> {
        let store = Self { backend: place::open(place.as_ref())? };
        match store.read(keys::DATASET)? {
            Some(dataset) => store.check_format(keys::DATASET, &dataset)?,
            // Of a bucket that is not there, or must not be listed, that is all that a read would tell.
            None if store.backend().at_once() > 1 => drop(store.backend().folders(keys::LOCKS)?),
            None => {}
        }
        Ok(store)
    }

    /// The store at a place where there is one.
    ///
    /// # Errors
    /// [`StoreError::NoStore`], or those of [`Store::open`].
    pub fn open_made(place: impl AsRef<OsStr>) -> Result<Self, StoreError> {
        let store = Self::open(place.as_ref())?;
        // One of them may have been lost.
        for key in [keys::DATASET, &Scope::Plan.manifest("")] {
            if store.read(key)?.is_some() {
                return Ok(store);
            }
        }
        Err(StoreError::NoStore { path: place.as_ref().display().to_string() })
    }

    /// A store on any backend.
    #[must_use]
    pub fn new(backend: Arc<dyn Backend>) -> Self {
        Self { backend }
    }

    /// The backend.
    #[must_use]
    pub fn backend(&self) -> &dyn Backend {
        self.backend.as_ref()
    }

    /// Where a key is, for messages.
    #[must_use]
    pub fn location(&self, key: &str) -> String {
        self.backend.location(key)
    }

    /// A whole small object, or `None` when it does not exist.
    ///
    /// # Errors
    /// The backend cannot read.
    pub fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        self.backend.read(key)
    }
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Store({})", self.location(""))
    }
}

/// BLAKE3 of some bytes, as 64 hexadecimal digits: every checksum and digest in a store.
#[must_use]
pub fn hash_bytes(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
