//! Reading tables, whole or group by group.

use std::ops::Range;

use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions};
use schema::table::Row;
use serde::de::DeserializeOwned;

use crate::backend::{Shard, Whole};
use crate::groups::RowGroups;
use crate::manifest::Manifest;
use crate::shard::{Chunks, ShardStream};
use crate::{Store, StoreError};

/// Outputs of at most so many bytes are read in one go.
const SMALL: u64 = 1 << 20;

impl Store {
    /// A whole table that a manifest names.
    ///
    /// # Errors
    /// It is missing, of another size than its manifest says, or cannot be decoded.
    pub fn read_rows<R: Row>(&self, manifest: &Manifest, key: &str) -> Result<Vec<R>, StoreError> {
        let mut rows = Vec::new();
        for group in self.row_groups(manifest, key)? {
            rows.extend(group?);
        }
        Ok(rows)
    }

    /// All rows of a table that need not be there: none where the manifest does not name it.
    ///
    /// # Errors
    /// As [`Store::read_rows`].
    pub fn read_optional_rows<R: Row>(&self, manifest: &Manifest, key: &str) -> Result<Vec<R>, StoreError> {
        if manifest.output(key).is_some() { self.read_rows(manifest, key) } else { Ok(Vec::new()) }
    }

    /// A table that a manifest names, some rows at a time. Columns that the row type does not name are not
    /// read.
    ///
    /// # Errors
    /// As [`Store::read_rows`]; later groups report their own.
    pub fn row_groups<R: Row>(&self, manifest: &Manifest, key: &str) -> Result<RowGroups<R>, StoreError> {
        RowGroups::open(self.chunks(manifest, key)?, None)
    }

    /// Some rows of such a table, in ascending ranges that do not overlap; what lies beyond its end is left
    /// out. Groups in which no row is wanted are not read, and of the others only the wanted rows are
    /// decoded.
    ///
    /// # Errors
    /// As [`Store::row_groups`].
    pub fn rows_at<R: Row>(
        &self,
        manifest: &Manifest,
        key: &str,
        wanted: Vec<Range<usize>>,
    ) -> Result<RowGroups<R>, StoreError> {
        RowGroups::open(self.chunks(manifest, key)?, Some(wanted))
    }

    fn chunks(&self, manifest: &Manifest, key: &str) -> Result<Chunks, StoreError> {
        Ok(Chunks::new(self.open_output(manifest, key)?, self.location(key)))
    }

    /// What a table that a manifest names says of itself under a key.
    ///
    /// # Errors
    /// As [`Store::read_rows`].
    pub fn table_metadata(
        &self,
        manifest: &Manifest,
        key: &str,
        name: &str,
    ) -> Result<Option<String>, StoreError> {
        Ok(self.table_head(manifest, key, name)?.metadata)
    }

    /// Names of the columns of a table that a manifest names, in file order.
    ///
    /// # Errors
    /// As [`Store::read_rows`].
    pub fn table_columns(&self, manifest: &Manifest, key: &str) -> Result<Vec<String>, StoreError> {
        Ok(self.table_head(manifest, key, "")?.columns)
    }

    /// Both at once: what a table says of itself under a key, and its columns.
    ///
    /// # Errors
    /// As [`Store::read_rows`].
    pub fn table_head(&self, manifest: &Manifest, key: &str, name: &str) -> Result<TableHead, StoreError> {
        let chunks = self.chunks(manifest, key)?;
        let loaded = ArrowReaderMetadata::load(&chunks, ArrowReaderOptions::new());
        let about = loaded.map_err(|e| chunks.error(&e))?;
        let entries = about.metadata().file_metadata().key_value_metadata();
        let entry = entries.into_iter().flatten().find(|entry| entry.key == name);
        let columns = about.schema().fields().iter().map(|field| field.name().clone()).collect();
        Ok(TableHead { metadata: entry.and_then(|entry| entry.value.clone()), columns })
    }

    /// A record in JSON that a manifest names.
    ///
    /// # Errors
    /// As [`Store::open_output`], or it cannot be understood.
    pub fn read_output_json<T: DeserializeOwned>(
        &self,
        manifest: &Manifest,
        key: &str,
    ) -> Result<T, StoreError> {
        let stream = self.stream_output(manifest, key)?;
        serde_json::from_reader(stream).map_err(|e| match e.io_error_kind() {
            Some(kind) => StoreError::read(self.location(key), "read", kind.into()),
            None => StoreError::Corrupt { path: self.location(key), problem: e.to_string() },
        })
    }

    /// An output as a stream that can seek, after checking its size against the manifest.
    ///
    /// # Errors
    /// As [`Store::open_output`].
    pub fn stream_output(&self, manifest: &Manifest, key: &str) -> Result<ShardStream, StoreError> {
        Ok(ShardStream::new(self.open_output(manifest, key)?.into(), 0))
    }

    /// Opens an output after checking its size against the manifest.
    ///
    /// # Errors
    /// The manifest does not name it, it is missing, or of another size.
    pub fn open_output(&self, manifest: &Manifest, key: &str) -> Result<Box<dyn Shard>, StoreError> {
        let path = self.location(key);
        let Some(output) = manifest.output(key) else {
            let problem = format!("is not among the outputs of stage {}", manifest.stage);
            return Err(StoreError::Corrupt { path, problem });
        };
        let shard: Box<dyn Shard> = if output.bytes <= SMALL {
            match self.backend().read(key)? {
                Some(bytes) => Box::new(Whole(bytes.into())),
                None => return Err(StoreError::Missing { path }),
            }
        } else {
            self.backend().open(key, Some(output.bytes))?
        };
        match shard.size() {
            found if found != output.bytes => Err(StoreError::Size { path, expected: output.bytes, found }),
            _ => Ok(shard),
        }
    }
}

/// What a table says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableHead {
    /// Under the key that was asked for.
    pub metadata: Option<String>,
    /// Names of the columns, in file order.
    pub columns: Vec<String>,
}
