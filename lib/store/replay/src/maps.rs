//! Maps as a store keeps them (`maps/NAME.xodr.zst`), held against the digest that the plan has.

use std::io::{self, Read};

use opendrive::Map;
use store::{Store, StoreError, keys};

/// Largest map text that is believed, bytes.
const MAX_MAP_BYTES: u64 = 1 << 30;
/// How hard zstd tries.
const LEVEL: i32 = 9;

/// A map of a store cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The store failed.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// It cannot be unpacked.
    #[error("{path}: cannot decompress: {source} (run spawn-planner with --force)")]
    Decompress {
        /// The file.
        path: String,
        /// Why.
        source: io::Error,
    },
    /// It is not there.
    #[error("{path}: missing (run spawn-planner with --force)")]
    Missing {
        /// The file.
        path: String,
    },
    /// It is another one than the plan was made with.
    #[error("{path}: is not the map of the plan (run spawn-planner with --force)")]
    Other {
        /// The file.
        path: String,
    },
    /// It is no OpenDRIVE file.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// Where and why.
        source: opendrive::ReadError,
    },
}

/// A map's text as a store keeps it.
///
/// # Errors
/// There is not enough memory: nothing else can go wrong.
pub fn pack(text: &[u8]) -> io::Result<Vec<u8>> {
    let packed = zstd::bulk::compress(text, LEVEL);
    packed.map_err(|e| io::Error::new(io::ErrorKind::OutOfMemory, e.to_string()))
}

/// The OpenDRIVE text of a map of a store, by its name; `None` when the store has no such map.
///
/// # Errors
/// It cannot be read or unpacked.
pub fn read_text(store: &Store, name: &str) -> Result<Option<Vec<u8>>, MapError> {
    let key = keys::map(name);
    let Some(packed) = store.read(&key)? else { return Ok(None) };
    let mut text = Vec::new();
    zstd::Decoder::new(packed.as_slice())
        .and_then(|decoder| decoder.take(MAX_MAP_BYTES).read_to_end(&mut text))
        .map_err(|source| MapError::Decompress { path: store.location(&key), source })?;
    Ok(Some(text))
}

/// Reads a map of a store by its name and the BLAKE3 of its text.
///
/// # Errors
/// It is missing, changed, or no OpenDRIVE file.
pub fn read(store: &Store, name: &str, hash: &str) -> Result<Map, MapError> {
    let path = || store.location(&keys::map(name));
    let text = read_text(store, name)?.ok_or_else(|| MapError::Missing { path: path() })?;
    if store::hash_bytes(&text) != hash {
        return Err(MapError::Other { path: path() });
    }
    let network = opendrive::read_bytes(&text).map_err(|source| MapError::Read { path: path(), source })?;
    Ok(Map::new(network))
}
