//! A store in memory: for tests, and the pattern for places without a file system.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use bytes::Bytes;

use crate::backend::{Area, Backend, LARGEST_READ, Listed, Listing, Shard, Sink, Unfinished, Whole};
use crate::error::StoreError;

/// Objects in memory, gone with the process. Its contract is that of an object store: an object is put whole,
/// or on condition that there is none; an upload that nobody completed is listed apart.
///
/// ```
/// use store::{Backend, Memory};
///
/// let place = Memory::default();
/// assert!(place.put_if_absent("plan/_manifest.json", "spawn-planner", b"first")?);
/// assert!(!place.put_if_absent("plan/_manifest.json", "spawn-planner", b"second")?);
/// let object = place.open("plan/_manifest.json", None)?;
/// assert_eq!(object.size(), 5);
/// assert_eq!(object.read_at(1..3).expect("lies inside"), "ir");
/// # Ok::<(), store::StoreError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Memory {
    inner: Arc<Mutex<Inner>>,
    capacity: Option<usize>,
}

#[derive(Debug, Default)]
struct Inner {
    objects: BTreeMap<String, (Bytes, SystemTime)>,
    uploads: BTreeMap<u64, Upload>,
    next: u64,
}

#[derive(Debug)]
struct Upload {
    key: String,
    owner: String,
    bytes: Vec<u8>,
}

impl Inner {
    fn put(&mut self, key: &str, bytes: Bytes) {
        self.objects.insert(key.to_owned(), (bytes, SystemTime::now()));
    }

    fn used(&self) -> usize {
        let objects: usize = self.objects.values().map(|(bytes, _)| bytes.len()).sum();
        objects + self.uploads.values().map(|upload| upload.bytes.len()).sum::<usize>()
    }

    /// How many of `wanted` more bytes have room.
    fn room(&self, capacity: Option<usize>, wanted: usize) -> io::Result<usize> {
        let Some(capacity) = capacity else { return Ok(wanted) };
        match capacity.saturating_sub(self.used()).min(wanted) {
            0 if wanted > 0 => Err(io::ErrorKind::StorageFull.into()),
            room => Ok(room),
        }
    }
}

impl Memory {
    /// A place that is full when it holds this many bytes, unfinished objects included.
    #[must_use]
    pub fn with_capacity(bytes: usize) -> Self {
        Self { capacity: Some(bytes), ..Self::default() }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        // Each change is one statement under the lock: a panic elsewhere leaves nothing half done.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct Upstream {
    place: Memory,
    number: u64,
    key: String,
}

impl Write for Upstream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let capacity = self.place.capacity;
        let mut inner = self.place.inner();
        let n = inner.room(capacity, bytes.len())?;
        // One that was swept takes no more: the place has forgotten it.
        let upload = inner.uploads.get_mut(&self.number).ok_or(io::ErrorKind::NotFound)?;
        upload.bytes.extend_from_slice(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Sink for Upstream {
    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        let mut inner = self.place.inner();
        let Some(upload) = inner.uploads.remove(&self.number) else {
            let source = io::ErrorKind::NotFound.into();
            return Err(StoreError::write(self.place.location(&self.key), "complete", source));
        };
        inner.put(&upload.key, upload.bytes.into());
        Ok(())
    }
}

impl Drop for Upstream {
    fn drop(&mut self) {
        self.place.inner().uploads.remove(&self.number);
    }
}

/// Whether a key lies below a folder; everything lies below `""`.
fn is_below(key: &str, folder: &str) -> bool {
    let folder = folder.trim_end_matches('/');
    folder.is_empty() || key.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
}

impl Backend for Memory {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        let mut inner = self.inner();
        let number = inner.next;
        inner.next += 1;
        inner
            .uploads
            .insert(number, Upload { key: key.to_owned(), owner: owner.to_owned(), bytes: Vec::new() });
        Ok(Box::new(Upstream { place: self.clone(), number, key: key.to_owned() }))
    }

    fn put_if_absent(&self, key: &str, _owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        let mut inner = self.inner();
        if inner.objects.contains_key(key) {
            return Ok(false);
        }
        match inner.room(self.capacity, bytes.len()) {
            Ok(room) if room == bytes.len() => {
                inner.put(key, Bytes::copy_from_slice(bytes));
                Ok(true)
            }
            _ => Err(StoreError::write(self.location(key), "write", io::ErrorKind::StorageFull.into())),
        }
    }

    fn replace(&self, key: &str, _owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
        let mut inner = self.inner();
        match inner.objects.get(key) {
            Some((there, _)) if *there == old => inner.put(key, Bytes::copy_from_slice(new)),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        match self.inner().objects.get(key) {
            Some((bytes, _)) if bytes.len() as u64 > LARGEST_READ => {
                Err(StoreError::too_large(self.location(key), bytes.len() as u64))
            }
            found => Ok(found.map(|(bytes, _)| bytes.to_vec())),
        }
    }

    fn open(&self, key: &str, _bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
        match self.inner().objects.get(key) {
            Some((bytes, _)) => Ok(Box::new(Whole(bytes.clone()))),
            None => Err(StoreError::Missing { path: self.location(key) }),
        }
    }

    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        Ok(self.inner().objects.get(key).map(|(bytes, _)| bytes.len() as u64))
    }

    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
        Ok(self.inner().objects.get(key).map(|&(_, put)| put))
    }

    fn remove(&self, key: &str) -> Result<(), StoreError> {
        self.inner().objects.remove(key);
        Ok(())
    }

    fn list(&self, folder: &str) -> Result<Listing, StoreError> {
        let inner = self.inner();
        let below = inner.objects.iter().filter(|(key, _)| is_below(key, folder));
        let listed = |(key, (bytes, _)): (&String, &(Bytes, SystemTime))| Listed {
            key: key.clone(),
            bytes: bytes.len() as u64,
        };
        Ok(Listing {
            objects: below.map(listed).collect(),
            has_unfinished: inner.uploads.values().any(|upload| is_below(&upload.key, folder)),
        })
    }

    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        let inner = self.inner();
        let below = inner.objects.keys().filter(|key| is_below(key, folder));
        let name = |key: &String| {
            let rest = key.strip_prefix(folder.trim_end_matches('/'))?.trim_start_matches('/');
            Some(rest.split_once('/')?.0.to_owned())
        };
        Ok(below.filter_map(name).collect::<BTreeSet<_>>().into_iter().collect())
    }

    fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError> {
        let inner = self.inner();
        let uploads = inner.uploads.values().filter(|upload| is_below(&upload.key, folder));
        Ok(uploads
            .map(|upload| Unfinished {
                location: self.location(&upload.key),
                owner: upload.owner.clone(),
                abandoned: true,
            })
            .collect())
    }

    fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError> {
        let mut inner = self.inner();
        let before = inner.uploads.len();
        // Only this process can see the place, and a process starts a stage once at a time: what is left is
        // abandoned.
        let lies_there = |key: &str| match area {
            Area::Top => !key.contains('/'),
            Area::Below(folder) => is_below(key, folder),
        };
        inner.uploads.retain(|_, upload| upload.owner != owner || !lies_there(&upload.key));
        Ok(before - inner.uploads.len())
    }

    fn location(&self, key: &str) -> String {
        format!("memory:{key}")
    }
}
