//! Writing shards: any bytes, or tables.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::marker::PhantomData;
use std::sync::{Arc, Mutex};

use arrow_array::RecordBatch;
use arrow_schema::{DataType, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use parquet::schema::types::ColumnPath;
use schema::table::{Column, Row};

use crate::backend::Sink;
use crate::manifest::Output;
use crate::{Store, StoreError, convert};

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

impl std::fmt::Debug for Finished {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Finished({:?})", self.output)
    }
}

/// How a table is laid out.
#[derive(Clone, Debug, Default)]
pub struct TableOptions {
    /// Rows per row group; 0 leaves it to the default of 65,536. Sensors use 1, so that one frame can be
    /// fetched alone.
    pub rows_per_group: usize,
    /// Key-value metadata of the file.
    pub metadata: Vec<(String, String)>,
    /// The values are compressed already (images): do not try again.
    pub compressed: bool,
}

impl TableOptions {
    /// One frame a row, one row a group, with metadata.
    #[must_use]
    pub fn frames(metadata: Vec<(String, String)>) -> Self {
        Self { rows_per_group: 1, metadata, compressed: false }
    }

    /// The same for values that are compressed already (images).
    #[must_use]
    pub fn compressed_frames(metadata: Vec<(String, String)>) -> Self {
        Self { compressed: true, ..Self::frames(metadata) }
    }
}

/// A table in hand.
pub struct TableWriter<R> {
    writer: ArrowWriter<FileWriter>,
    schema: Arc<Schema>,
    location: String,
    failed: Failed,
    rows_per_group: usize,
    in_group: usize,
    rows: u64,
    row: PhantomData<fn(R)>,
}

impl<R: Row> TableWriter<R> {
    pub(crate) fn create(file: FileWriter, options: TableOptions) -> Result<Self, StoreError> {
        let schema = Arc::new(convert::arrow_schema::<R>());
        let rows_per_group = if options.rows_per_group == 0 { 65_536 } else { options.rows_per_group };
        let (location, failed) = (file.location.clone(), file.failed.clone());
        let properties = properties(&schema, &options);
        let writer = ArrowWriter::try_new(file, schema.clone(), Some(properties))
            .map_err(|e| StoreError::Corrupt { path: location.clone(), problem: e.to_string() })?;
        Ok(Self { writer, schema, location, failed, rows_per_group, in_group: 0, rows: 0, row: PhantomData })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn push(&mut self, rows: &[R]) -> Result<(), StoreError> {
        let mut rest = rows;
        while !rest.is_empty() {
            let n = rest.len().min(self.rows_per_group - self.in_group);
            let arrays = R::to_columns(&rest[..n]).into_iter().map(convert::to_arrow).collect();
            let result = RecordBatch::try_new(self.schema.clone(), arrays)
                .map_err(Into::into)
                .and_then(|batch| self.writer.write(&batch));
            self.check(result)?;
            self.in_group += n;
            self.rows += n as u64;
            if self.in_group == self.rows_per_group {
                let result = self.writer.flush();
                self.check(result)?;
                self.in_group = 0;
            }
            rest = &rest[n..];
        }
        Ok(())
    }

    /// Ends the table.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn finish(self) -> Result<Finished, StoreError> {
        let file = self.writer.into_inner().map_err(|e| error_of(&self.failed, &self.location, &e))?;
        file.finish(self.rows)
    }

    fn check(&self, result: parquet::errors::Result<()>) -> Result<(), StoreError> {
        result.map_err(|e| error_of(&self.failed, &self.location, &e))
    }
}

fn error_of(failed: &Failed, location: &str, error: &parquet::errors::ParquetError) -> StoreError {
    match failed.take() {
        Some(io) => StoreError::write(location, "write", io),
        None => StoreError::Corrupt { path: location.to_owned(), problem: error.to_string() },
    }
}

/// Writes a table of named columns.
pub(crate) fn write_columns(file: FileWriter, columns: Vec<(&str, Column)>) -> Result<Finished, StoreError> {
    let (location, failed) = (file.location.clone(), file.failed.clone());
    let rows = columns.first().map_or(0, |(_, column)| column.len()) as u64;
    let schema = Arc::new(convert::schema_of(columns.iter().map(|(name, column)| (*name, column))));
    let properties = properties(&schema, &TableOptions::default());
    let arrays = columns.into_iter().map(|(_, column)| convert::to_arrow(column)).collect();
    let mut writer = ArrowWriter::try_new(file, schema.clone(), Some(properties))
        .map_err(|e| error_of(&failed, &location, &e))?;
    let written =
        RecordBatch::try_new(schema, arrays).map_err(Into::into).and_then(|batch| writer.write(&batch));
    written.map_err(|e| error_of(&failed, &location, &e))?;
    writer.into_inner().map_err(|e| error_of(&failed, &location, &e))?.finish(rows)
}

fn properties(schema: &Schema, options: &TableOptions) -> WriterProperties {
    // Level 3 is zstd's own default; what comes frame by frame is large and must be fast; images are
    // compressed already.
    let level = if options.rows_per_group == 1 { 1 } else { 3 };
    let compression = if options.compressed {
        Compression::UNCOMPRESSED
    } else {
        ZstdLevel::try_new(level).map_or(Compression::UNCOMPRESSED, Compression::ZSTD)
    };
    let mut builder = WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_1_0)
        .set_created_by("convoy".into())
        .set_compression(compression)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_max_row_group_row_count(None);
    for field in schema.fields() {
        let (leaf, nested) = match field.data_type() {
            DataType::List(item) => (item.data_type(), Some("list.item")),
            DataType::FixedSizeList(item, _) => (item.data_type(), Some("list.item")),
            other => (other, None),
        };
        let path = match nested {
            Some(nested) => format!("{}.{nested}", field.name()),
            None => field.name().clone(),
        };
        let path = ColumnPath::from(path.split('.').map(str::to_owned).collect::<Vec<_>>());
        if nested.is_some() {
            // Nobody skips a row for the least and greatest of its list.
            builder = builder.set_column_statistics_enabled(path.clone(), EnabledStatistics::None);
        }
        if matches!(leaf, DataType::Float32 | DataType::Float64) {
            builder = builder
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
        } else if matches!(leaf, DataType::Float16) {
            // Not split into streams: readers know that of 16 bits since a short time only.
            builder = builder.set_column_dictionary_enabled(path, false);
        } else if matches!(leaf, DataType::Binary) {
            builder = builder
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_statistics_enabled(path, EnabledStatistics::None);
        }
    }
    if !options.metadata.is_empty() {
        let pairs = options.metadata.iter().map(|(k, v)| KeyValue::new(k.clone(), v.clone())).collect();
        builder = builder.set_key_value_metadata(Some(pairs));
    }
    builder.build()
}
