//! A folder of a bucket as a place of storage.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::SystemTime;

use bytes::Bytes;
use futures_util::TryStreamExt;
use object_store::path::Path;
use object_store::{ObjectMeta, ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload, UpdateVersion};
use tokio::sync::Semaphore;

use super::failure::{Access, Failure};
use super::ranges::Ranges;
use super::service::Service;
use super::upload::{UNDER_WAY, Upload};
use crate::StoreError;
use crate::backend::{Area, Backend, LARGEST_READ, Listed, Listing, Shard, Sink, Unfinished};

/// How often is looked again where an answer means neither yes nor no.
const LOOKS: usize = 5;

/// A folder of a bucket.
pub struct Objects {
    service: Arc<Service>,
    /// The bucket, as a URL.
    bucket: String,
    /// The folder in it, without `/` at its end; `""` for all of the bucket.
    folder: String,
    parts: Arc<Semaphore>,
    /// What is open: who reads the same object shares what was fetched of it.
    opened: Mutex<BTreeMap<Path, Weak<Ranges>>>,
    access: Arc<Access>,
}

impl Objects {
    /// The store in a folder of a bucket, `""` for all of it. `bucket` is its URL, for messages.
    #[must_use]
    pub fn new(service: Arc<dyn ObjectStore>, bucket: &str, folder: &str) -> Self {
        let (bucket, folder) = (bucket.to_owned(), folder.to_owned());
        let parts = Arc::new(Semaphore::new(UNDER_WAY));
        let access = Access { endpoint: None, credentials: "the program gave credentials".into() };
        let service = Arc::new(Service::new(service));
        Self { service, bucket, folder, parts, opened: Mutex::default(), access: access.into() }
    }

    /// Says how the service is reached, for messages.
    pub(crate) fn reached_by(self, access: Access) -> Self {
        Self { access: access.into(), ..self }
    }

    /// Where a key lies in the bucket.
    fn path(&self, key: &str) -> Result<Path, StoreError> {
        let whole = match (self.folder.as_str(), key) {
            ("", key) => key.to_owned(),
            (folder, "") => folder.to_owned(),
            (folder, key) => format!("{folder}/{key}"),
        };
        Path::parse(&whole)
            .map_err(|e| StoreError::Corrupt { path: self.location(key), problem: e.to_string() })
    }

    fn opened(&self) -> MutexGuard<'_, BTreeMap<Path, Weak<Ranges>>> {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The key of what lies at a path, if it lies in the store.
    fn key(&self, path: &Path) -> Option<String> {
        let whole = path.as_ref();
        if self.folder.is_empty() {
            return Some(whole.to_owned());
        }
        Some(whole.strip_prefix(self.folder.as_str())?.strip_prefix('/')?.to_owned())
    }

    fn read_failed(&self, key: &str, action: &'static str) -> impl Fn(Failure) -> StoreError + Send + use<> {
        let (location, access) = (self.location(key), Arc::clone(&self.access));
        move |failure| failure.into_store(location.clone(), action, false, &access)
    }

    fn write_failed(&self, key: &str, action: &'static str) -> impl Fn(Failure) -> StoreError + Send + use<> {
        let (location, access) = (self.location(key), Arc::clone(&self.access));
        move |failure| failure.into_store(location.clone(), action, true, &access)
    }

    /// A whole object and its version, or `None` when there is none.
    fn found(&self, path: &Path) -> Result<Option<(Found, UpdateVersion)>, Failure> {
        let found = self.service.wait(self.service.read(|| async {
            let found = self.service.client.get(path).await?;
            let version =
                UpdateVersion { e_tag: found.meta.e_tag.clone(), version: found.meta.version.clone() };
            let size = found.meta.size;
            if size > LARGEST_READ {
                return Ok((Found::TooLarge(size), version));
            }
            Ok((Found::Whole(found.bytes().await?), version))
        }));
        match found {
            Ok(found) => Ok(Some(found)),
            Err(Failure::Absent) => Ok(None),
            Err(failure) => Err(failure),
        }
    }

    /// What a service tells of an object without its bytes.
    fn head(&self, key: &str) -> Result<Option<ObjectMeta>, StoreError> {
        let path = self.path(key)?;
        match self.service.wait(async { self.service.client.head(&path).await.map_err(Failure::from) }) {
            Ok(found) => Ok(Some(found)),
            Err(Failure::Absent) => Ok(None),
            Err(failure) => Err(self.read_failed(key, "look at")(failure)),
        }
    }

    fn put(&self, path: &Path, bytes: &[u8], mode: PutMode) -> Result<(), Failure> {
        let payload = PutPayload::from(Bytes::copy_from_slice(bytes));
        let options = PutOptions { mode, ..PutOptions::default() };
        self.service.wait(async {
            self.service.client.put_opts(path, payload, options).await.map(drop).map_err(Failure::from)
        })
    }

    /// Puts on a condition. The answer may be lost after it was done, and "there is one" may come of two that
    /// asked at once, of whom none succeeded: so what lies there decides, and nothing there means again.
    fn put_on_condition(&self, path: &Path, bytes: &[u8], mode: &PutMode) -> Result<bool, Failure> {
        let mut last = Failure::Conflict;
        for _ in 0..LOOKS {
            last = match self.put(path, bytes, mode.clone()) {
                Ok(()) => return Ok(true),
                // Nobody answers: looking would take as long again.
                Err(failure @ Failure::Away(_)) if self.service.is_away() => return Err(failure),
                Err(failure @ (Failure::Conflict | Failure::Away(_))) => failure,
                Err(failure) => return Err(failure),
            };
            match (self.found(path)?, mode) {
                (Some((Found::Whole(there), _)), _) if there == bytes => return Ok(true),
                (None, PutMode::Create) => {}
                (Some((_, now)), PutMode::Update(read)) if now == *read => {}
                _ => return Ok(false),
            }
        }
        Err(match last {
            Failure::Conflict => {
                Failure::Away(std::io::Error::other("the service keeps answering neither yes nor no"))
            }
            other => other,
        })
    }
}

/// An object that was read.
enum Found {
    Whole(Bytes),
    TooLarge(u64),
}

impl Backend for Objects {
    fn create(&self, key: &str, _owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        let (service, path) = (Arc::clone(&self.service), self.path(key)?);
        // Who opens it from now on shares nothing that was fetched of the one before.
        self.opened().remove(&path);
        let failed = Box::new(self.write_failed(key, "write"));
        Ok(Box::new(Upload::new(service, path, Arc::clone(&self.parts), failed)))
    }

    fn put_if_absent(&self, key: &str, _owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        self.put_on_condition(&self.path(key)?, bytes, &PutMode::Create)
            .map_err(self.write_failed(key, "write"))
    }

    fn replace(&self, key: &str, _owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
        let path = self.path(key)?;
        match self.found(&path).map_err(self.read_failed(key, "read"))? {
            Some((Found::Whole(there), version)) if there == old => {
                let mode = PutMode::Update(version);
                self.put_on_condition(&path, new, &mode).map_err(self.write_failed(key, "replace"))
            }
            _ => Ok(false),
        }
    }

    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        match self.found(&self.path(key)?).map_err(self.read_failed(key, "read"))? {
            None => Ok(None),
            Some((Found::Whole(bytes), _)) => Ok(Some(bytes.into())),
            Some((Found::TooLarge(size), _)) => Err(StoreError::too_large(self.location(key), size)),
        }
    }

    fn open(&self, key: &str, bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
        let path = self.path(key)?;
        if let Some(found) = self.opened().get(&path).and_then(Weak::upgrade)
            && bytes == Some(found.size())
        {
            return Ok(Box::new(found));
        }
        let found = Ranges::open(Arc::clone(&self.service), path.clone(), bytes);
        let found = Arc::new(found.map_err(self.read_failed(key, "open"))?);
        let mut opened = self.opened();
        opened.retain(|_, found| found.strong_count() > 0);
        opened.insert(path, Arc::downgrade(&found));
        Ok(Box::new(found))
    }

    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        Ok(self.head(key)?.map(|found| found.size))
    }

    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
        Ok(self.head(key)?.map(|found| found.last_modified.into()))
    }

    fn remove(&self, key: &str) -> Result<(), StoreError> {
        let path = self.path(key)?;
        match self.service.wait(async { self.service.client.delete(&path).await.map_err(Failure::from) }) {
            Ok(()) | Err(Failure::Absent) => Ok(()),
            Err(failure) => Err(self.write_failed(key, "remove")(failure)),
        }
    }

    fn list(&self, folder: &str) -> Result<Listing, StoreError> {
        let path = self.path(folder.trim_end_matches('/'))?;
        let found = self.service.wait(self.service.read(|| async {
            let found: Vec<_> = self.service.client.list(Some(&path)).try_collect().await?;
            Ok(found)
        }));
        let found = found.map_err(self.read_failed(folder, "list"))?;
        let listed = |meta: ObjectMeta| Some(Listed { key: self.key(&meta.location)?, bytes: meta.size });
        let mut objects: Vec<Listed> = found.into_iter().filter_map(listed).collect();
        objects.sort_unstable();
        Ok(Listing { objects, has_unfinished: false })
    }

    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        let path = self.path(folder.trim_end_matches('/'))?;
        let found = self.service.wait(
            self.service.read(|| async { Ok(self.service.client.list_with_delimiter(Some(&path)).await?) }),
        );
        let found = found.map_err(self.read_failed(folder, "list"))?;
        let names = found.common_prefixes.iter().filter_map(|path| path.filename().map(str::to_owned));
        Ok(names.collect::<BTreeSet<_>>().into_iter().collect())
    }

    fn unfinished(&self, _folder: &str) -> Result<Vec<Unfinished>, StoreError> {
        Ok(Vec::new())
    }

    fn lists_unfinished(&self) -> bool {
        false
    }

    fn sweep(&self, _area: Area<'_>, _owner: &str) -> Result<usize, StoreError> {
        Ok(0)
    }

    fn at_once(&self) -> usize {
        16
    }

    fn location(&self, key: &str) -> String {
        let parts = [self.bucket.as_str(), &self.folder, key];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/")
    }
}

impl std::fmt::Debug for Objects {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Objects({})", self.location(""))
    }
}
