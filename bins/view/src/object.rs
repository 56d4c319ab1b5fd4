//! An open object of a store: a file, or what lies in a bucket.

use std::ops::Range;
use std::sync::Arc;

use bytes::Bytes;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{ChunkReader, Length};
use store::{Shard, ShardStream, Store, StoreError};

use crate::error::{ViewError, of_place};

/// An open object, read in parts.
#[derive(Clone)]
pub(crate) struct Object {
    shard: Arc<dyn Shard>,
    /// Where it is, for messages.
    pub(crate) place: String,
}

impl Object {
    /// The object under a key, if there is one.
    ///
    /// # Errors
    /// It cannot be read.
    pub(crate) fn open(store: &Store, key: &str) -> Result<Option<Self>, ViewError> {
        match store.backend().open(key, None) {
            Ok(shard) => Ok(Some(Self { shard: shard.into(), place: store.location(key) })),
            Err(StoreError::Missing { .. }) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    pub(crate) fn size(&self) -> u64 {
        self.shard.size()
    }

    /// The whole object.
    ///
    /// # Errors
    /// It cannot be read.
    pub(crate) fn bytes(&self) -> Result<Bytes, ViewError> {
        self.shard.read_at(0..self.size()).map_err(of_place(&self.place))
    }

    /// A hint that these bytes are read soon.
    pub(crate) fn will_read(&self, range: Range<u64>) {
        self.shard.will_read(range);
    }

    /// The object as a stream from a byte on.
    pub(crate) fn stream(&self, at: u64) -> ShardStream {
        ShardStream::new(Arc::clone(&self.shard), at)
    }
}

impl std::fmt::Debug for Object {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.place)
    }
}

impl Length for Object {
    fn len(&self) -> u64 {
        self.size()
    }
}

impl ChunkReader for Object {
    type T = ShardStream;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        Ok(self.stream(start))
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let end = start.saturating_add(length as u64);
        if end > self.size() {
            return Err(ParquetError::EOF(format!("bytes {start} to {end} of {}", self.size())));
        }
        Ok(self.shard.read_at(start..end)?)
    }
}
