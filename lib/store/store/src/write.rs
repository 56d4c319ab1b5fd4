//! Writing shards of any bytes.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use crate::backend::Sink;
use crate::manifest::Output;
use crate::parallel::side_by_side;
use crate::{Store, StoreError};

/// A shard in hand: counts and hashes what is written. Dropping it discards it.
pub struct FileWriter {
    key: String,
    location: String,
    sink: Box<dyn Sink>,
    hasher: blake3::Hasher,
    bytes: u64,
    failed: Failed,
}

/// The first I/O error of a shard. Parquet turns errors into text; this remembers the real one.
#[derive(Clone, Default)]
pub(crate) struct Failed(Arc<Mutex<Option<io::Error>>>);

impl Failed {
    /// Keeps the error and returns one like it, to be passed on.
    pub(crate) fn remember(&self, error: io::Error) -> io::Error {
        let copy = error.raw_os_error().map_or_else(|| error.kind().into(), io::Error::from_raw_os_error);
        // Interrupted writes are tried again.
        if error.kind() != io::ErrorKind::Interrupted
            && let Ok(mut slot) = self.0.lock()
        {
            slot.get_or_insert(error);
        }
        copy
    }

    pub(crate) fn take(&self) -> Option<io::Error> {
        self.0.lock().ok().and_then(|mut slot| slot.take())
    }
}

impl FileWriter {
    pub(crate) fn create(store: &Store, key: &str, owner: &str) -> Result<Self, StoreError> {
        Ok(Self {
            key: key.to_owned(),
            location: store.location(key),
            sink: store.backend().create(key, owner)?,
            hasher: blake3::Hasher::new(),
            bytes: 0,
            failed: Failed::default(),
        })
    }

    pub(crate) fn key(&self) -> &str {
        &self.key
    }

    /// Where the shard will be, for messages.
    #[must_use]
    pub fn location(&self) -> &str {
        &self.location
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn write_bytes(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        self.write_all(bytes).map_err(|e| self.error("write", e))
    }

    /// Ends the shard; it becomes visible when its unit is finished.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn finish(mut self, rows: u64) -> Result<Finished, StoreError> {
        self.sink.flush().map_err(|e| self.error("write", e))?;
        let blake3 = self.hasher.finalize().to_hex().to_string();
        let Self { key, bytes, sink, .. } = self;
        let output = Output { key, bytes, rows, blake3, made_from: None, counts: BTreeMap::new() };
        Ok(Finished { output, sink })
    }

    fn error(&self, action: &'static str, error: io::Error) -> StoreError {
        StoreError::write(self.location.clone(), action, self.failed.take().unwrap_or(error))
    }

    /// What keeps the first error.
    pub(crate) fn failed(&self) -> Failed {
        self.failed.clone()
    }
}

impl Write for FileWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.sink.write(bytes) {
            Ok(n) => {
                self.hasher.update(&bytes[..n]);
                self.bytes += n as u64;
                Ok(n)
            }
            Err(e) => Err(self.failed.remember(e)),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush().map_err(|e| self.failed.remember(e))
    }
}

impl std::fmt::Debug for FileWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "FileWriter({}, {} bytes)", self.location, self.bytes)
    }
}

/// A complete shard that is not visible yet.
pub struct Finished {
    output: Output,
    sink: Box<dyn Sink>,
}

impl Finished {
    /// What the manifest will say of it.
    #[must_use]
    pub fn output(&self) -> &Output {
        &self.output
    }

    /// Says what it depends on, by a digest, and what is counted of it: a later try may keep it.
    #[must_use]
    pub fn made_from(mut self, digest: &str, counts: BTreeMap<String, u64>) -> Self {
        (self.output.made_from, self.output.counts) = (Some(digest.to_owned()), counts);
        self
    }

    pub(crate) fn commit(self) -> Result<Output, StoreError> {
        self.sink.commit()?;
        Ok(self.output)
    }
}

/// Makes shards visible, some side by side. Returns what a manifest says of them, in their order.
pub(crate) fn commit(shards: Vec<Finished>, at_once: usize) -> Result<Vec<Output>, StoreError> {
    let shards: Vec<Mutex<Option<Finished>>> =
        shards.into_iter().map(|shard| Mutex::new(Some(shard))).collect();
    let done = side_by_side(&shards, at_once, |shard| {
        let taken = shard.lock().unwrap_or_else(PoisonError::into_inner).take();
        taken.map(Finished::commit).transpose()
    });
    Ok(done?.into_iter().flatten().collect())
}

impl std::fmt::Debug for Finished {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Finished({:?})", self.output)
    }
}
