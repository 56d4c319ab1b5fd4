//! Files of a store, opened by other people's crates alone.

mod npz;
mod picture;
mod table;

pub(crate) use npz::Npz;
pub(crate) use picture::{Picture, jpeg_size};
pub(crate) use table::{Batch, Table, extent, unreal};

use std::path::Path;

use serde_json::Value;

/// A file that is missing, broken or not what it should be: which, and why.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct Unreadable(pub(crate) String);

impl Unreadable {
    pub(crate) fn new(path: &Path, why: impl std::fmt::Display) -> Self {
        Self(format!("{}: {why}", path.display()))
    }
}

/// A file of JSON.
pub(crate) fn read_json(path: &Path) -> Result<Value, Unreadable> {
    let text = std::fs::read(path).map_err(|e| Unreadable::new(path, e))?;
    serde_json::from_slice(&text).map_err(|e| Unreadable::new(path, e))
}
