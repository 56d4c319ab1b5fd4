//! Reading tables, whole or group by group.

use std::collections::BTreeSet;
use std::marker::PhantomData;

use arrow_array::RecordBatch;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use schema::table::{Column, ColumnError, Row};
use serde::de::DeserializeOwned;

use crate::backend::Shard;
use crate::manifest::Manifest;
use crate::shard::{Chunks, ShardStream};
use crate::{Store, StoreError, convert};

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

    /// A table that a manifest names, some rows at a time. Columns that the row type does not name are not read.
    ///
    /// # Errors
    /// As [`Store::read_rows`]; later groups report their own.
    pub fn row_groups<R: Row>(&self, manifest: &Manifest, key: &str) -> Result<RowGroups<R>, StoreError> {
        let chunks = Chunks::new(self.open_output(manifest, key)?, self.location(key));
        let builder =
            ParquetRecordBatchReaderBuilder::try_new(chunks.clone()).map_err(|e| chunks.error(&e))?;
        let groups = builder.metadata().num_row_groups();
        let largest = (0..groups).map(|g| builder.metadata().row_group(g).num_rows()).max().unwrap_or(0);
        // A batch never spans more than a few thousand rows, nor several frames of a sensor.
        let batch = usize::try_from(largest).unwrap_or(1).clamp(1, 8192);
        let named: BTreeSet<&str> = R::fields().iter().map(|field| field.name).collect();
        let columns = builder.parquet_schema().root_schema().get_fields();
        let wanted: Vec<usize> = (0..columns.len()).filter(|i| named.contains(columns[*i].name())).collect();
        let columns = ProjectionMask::roots(builder.parquet_schema(), wanted);
        let reader =
            builder.with_projection(columns).with_batch_size(batch).build().map_err(|e| chunks.error(&e))?;
        Ok(RowGroups { reader, chunks, before: 0, row: PhantomData })
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
        let chunks = Chunks::new(self.open_output(manifest, key)?, self.location(key));
        let builder =
            ParquetRecordBatchReaderBuilder::try_new(chunks.clone()).map_err(|e| chunks.error(&e))?;
        let entries = builder.metadata().file_metadata().key_value_metadata();
        let entry = entries.into_iter().flatten().find(|entry| entry.key == name);
        Ok(entry.and_then(|entry| entry.value.clone()))
    }

    /// Names of the columns of a table that a manifest names, in file order.
    ///
    /// # Errors
    /// As [`Store::read_rows`].
    pub fn table_columns(&self, manifest: &Manifest, key: &str) -> Result<Vec<String>, StoreError> {
        let chunks = Chunks::new(self.open_output(manifest, key)?, self.location(key));
        let builder =
            ParquetRecordBatchReaderBuilder::try_new(chunks.clone()).map_err(|e| chunks.error(&e))?;
        Ok(builder.schema().fields().iter().map(|field| field.name().clone()).collect())
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
        match self.backend().size(key)? {
            None => return Err(StoreError::Missing { path }),
            Some(found) if found != output.bytes => {
                return Err(StoreError::Size { path, expected: output.bytes, found });
            }
            Some(_) => {}
        }
        self.backend().open(key)
    }
}

/// Rows of a table, some at a time.
pub struct RowGroups<R> {
    reader: ParquetRecordBatchReader,
    chunks: Chunks,
    /// Rows handed out so far.
    before: usize,
    row: PhantomData<fn() -> R>,
}

impl<R: Row> Iterator for RowGroups<R> {
    type Item = Result<Vec<R>, StoreError>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.reader.next()?;
        let batch = batch.map_err(|e| self.chunks.error(&e));
        let before = self.before;
        Some(batch.and_then(|batch| {
            self.before += batch.num_rows();
            let in_file = |e: ColumnError| ColumnError { row: e.row.map(|row| before + row), ..e };
            rows_of(&batch).map_err(|e| self.chunks.error(&in_file(e)))
        }))
    }
}

fn rows_of<R: Row>(batch: &RecordBatch) -> Result<Vec<R>, ColumnError> {
    let wanted: Vec<Column> = R::to_columns(&[]);
    let mut columns = Vec::with_capacity(wanted.len());
    for (field, column) in R::fields().into_iter().zip(&wanted) {
        let array = batch.column_by_name(field.name).ok_or_else(|| ColumnError {
            column: field.name.to_owned(),
            row: None,
            problem: "is missing".into(),
        })?;
        columns.push(convert::from_arrow(field.name, column, array.as_ref())?);
    }
    R::from_columns(columns)
}
