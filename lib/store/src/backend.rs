//! The few operations a place of storage must offer.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

use parquet::errors::Result as ParquetResult;
use parquet::file::reader::{ChunkReader, Length};

use crate::StoreError;

/// A place of storage. Keys are relative paths with `/`.
///
/// An object becomes visible whole or not at all. A disk writes under another name and renames; an object store
/// uploads and completes.
pub trait Backend: Send + Sync {
    /// Starts an object that becomes visible under `key` at [`Sink::commit`], replacing what was there.
    /// `owner` names the stage in whose leftovers it is counted until then.
    ///
    /// # Errors
    /// The place cannot be written to.
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError>;

    /// A whole object, or `None` when it does not exist.
    ///
    /// # Errors
    /// It exists and cannot be read.
    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError>;

    /// Opens an object for reading parts of it.
    ///
    /// # Errors
    /// It does not exist or cannot be read.
    fn open(&self, key: &str) -> Result<Shard, StoreError>;

    /// An object's size in bytes, or `None` when it does not exist.
    ///
    /// # Errors
    /// The place cannot be asked.
    fn size(&self, key: &str) -> Result<Option<u64>, StoreError>;

    /// Removes an object, if it exists.
    ///
    /// # Errors
    /// It exists and cannot be removed.
    fn remove(&self, key: &str) -> Result<(), StoreError>;

    /// All objects whose key starts with a folder, sorted.
    ///
    /// # Errors
    /// The place cannot be listed.
    fn list(&self, folder: &str) -> Result<Vec<String>, StoreError>;

    /// Removes what unfinished writers of `owner` left under a folder. Returns how many leftovers there were.
    ///
    /// # Errors
    /// The place cannot be listed or changed.
    fn sweep(&self, folder: &str, owner: &str) -> Result<usize, StoreError>;

    /// Where a key is, for messages.
    fn location(&self, key: &str) -> String;
}

/// An object being written. Dropping it discards what was written.
pub trait Sink: Write + Send {
    /// Makes the object durable and visible.
    ///
    /// # Errors
    /// It could not be made durable.
    fn commit(self: Box<Self>) -> Result<(), StoreError>;
}

/// An open object.
#[derive(Debug)]
pub enum Shard {
    /// A file on disk.
    File(File),
    /// Bytes in memory.
    Bytes(bytes::Bytes),
}

impl Length for Shard {
    fn len(&self) -> u64 {
        match self {
            Self::File(file) => file.metadata().map_or(0, |m| m.len()),
            Self::Bytes(bytes) => bytes.len() as u64,
        }
    }
}

/// Reads an object from a position to its end.
pub enum ShardReader {
    /// From a file.
    File(io::BufReader<File>),
    /// From memory.
    Bytes(io::Cursor<bytes::Bytes>),
}

impl Read for ShardReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Bytes(bytes) => bytes.read(buffer),
        }
    }
}

impl ChunkReader for Shard {
    type T = ShardReader;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        Ok(match self {
            Self::File(file) => {
                let mut file = file.try_clone()?;
                file.seek(SeekFrom::Start(start))?;
                ShardReader::File(io::BufReader::new(file))
            }
            Self::Bytes(bytes) => {
                let mut cursor = io::Cursor::new(bytes.clone());
                cursor.set_position(start);
                ShardReader::Bytes(cursor)
            }
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<bytes::Bytes> {
        match self {
            Self::File(file) => file.get_bytes(start, length),
            Self::Bytes(bytes) => bytes.get_bytes(start, length),
        }
    }
}

impl Shard {
    /// The object as a stream from its start that can seek.
    #[must_use]
    pub fn into_stream(self) -> Box<dyn ReadSeek> {
        match self {
            Self::File(file) => Box::new(io::BufReader::new(file)),
            Self::Bytes(bytes) => Box::new(io::Cursor::new(bytes)),
        }
    }
}

/// A stream that can seek.
pub trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}
