//! Open objects, for readers that want a stream or Parquet's interface.

use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;

use bytes::Bytes;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{ChunkReader, Length};

use crate::StoreError;
use crate::backend::Shard;
use crate::write::Failed;

/// An open object as a stream that can seek.
pub struct ShardStream(BufReader<Cursor>);

struct Cursor {
    shard: Arc<dyn Shard>,
    at: u64,
}

impl ShardStream {
    /// The stream from a byte on.
    #[must_use]
    pub fn new(shard: Arc<dyn Shard>, at: u64) -> Self {
        Self(BufReader::new(Cursor { shard, at }))
    }

    /// A hint: all is read soon, if that is not more than so many bytes.
    pub fn will_read_all(&self, most_bytes: u64) {
        let shard = &self.0.get_ref().shard;
        if shard.size() <= most_bytes {
            shard.will_read(0..shard.size());
        }
    }
}

impl Read for Cursor {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let end = self.shard.size().min(self.at.saturating_add(buffer.len() as u64));
        if end <= self.at {
            return Ok(0);
        }
        let bytes = self.shard.read_at(self.at..end)?;
        buffer[..bytes.len()].copy_from_slice(&bytes);
        self.at = end;
        Ok(bytes.len())
    }
}

impl Seek for Cursor {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (from, by) = match to {
            SeekFrom::Start(at) => (at, 0),
            SeekFrom::End(by) => (self.shard.size(), by),
            SeekFrom::Current(by) => (self.at, by),
        };
        self.at = from.checked_add_signed(by).ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.at)
    }
}

impl Read for ShardStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Seek for ShardStream {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

impl std::fmt::Debug for ShardStream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ShardStream({} bytes)", self.0.get_ref().shard.size())
    }
}

/// An open object as Parquet reads it.
#[derive(Clone)]
pub(crate) struct Chunks {
    shard: Arc<dyn Shard>,
    location: String,
    failed: Failed,
}

impl Chunks {
    pub(crate) fn new(shard: Box<dyn Shard>, location: String) -> Self {
        Self { shard: shard.into(), location, failed: Failed::default() }
    }

    /// A hint that these bytes are read soon.
    pub(crate) fn will_read(&self, range: std::ops::Range<u64>) {
        self.shard.will_read(range);
    }

    /// What went wrong: Parquet turns errors into text, so a failure of the place is told by what was
    /// remembered.
    pub(crate) fn error(&self, error: &dyn std::fmt::Display) -> StoreError {
        match self.failed.take() {
            Some(source) => StoreError::read(&self.location, "read", source),
            None => StoreError::Corrupt { path: self.location.clone(), problem: error.to_string() },
        }
    }
}

/// Remembers why reading failed.
pub(crate) struct Remembering {
    stream: ShardStream,
    failed: Failed,
}

impl Read for Remembering {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.read(buffer).map_err(|e| self.failed.remember(e))
    }
}

impl Length for Chunks {
    fn len(&self) -> u64 {
        self.shard.size()
    }
}

impl ChunkReader for Chunks {
    type T = Remembering;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        let stream = ShardStream::new(self.shard.clone(), start);
        Ok(Remembering { stream, failed: self.failed.clone() })
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let end = start.saturating_add(length as u64);
        if end > self.shard.size() {
            let problem = format!("bytes {start} to {end} of {}", self.shard.size());
            return Err(ParquetError::EOF(problem));
        }
        Ok(self.shard.read_at(start..end).map_err(|e| self.failed.remember(e))?)
    }
}
