//! Writing tables. What costs time is encoding rows, which any thread does; groups of rows are then appended
//! in their order.

use std::io;
use std::marker::PhantomData;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::{
    ArrowColumnChunk, ArrowColumnWriter, ArrowRowGroupWriterFactory, compute_leaves,
};
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::ColumnPath;
use schema::SCENE_COLUMN;
use schema::table::{Column, Row};

use crate::write::{Failed, FileWriter, Finished};
use crate::{StoreError, convert, keys};

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
    file: SerializedFileWriter<FileWriter>,
    encoder: GroupEncoder<R>,
    failed: Failed,
    /// The group that is being filled.
    open: Option<OpenGroup>,
    rows: u64,
}

impl<R: Row> TableWriter<R> {
    pub(crate) fn create(file: FileWriter, options: TableOptions) -> Result<Self, StoreError> {
        let schema = convert::arrow_schema::<R>();
        let rows_per_group = if options.rows_per_group == 0 { 65_536 } else { options.rows_per_group };
        let failed = file.failed();
        let (file, encoder) = start(file, schema, &options)?;
        let encoder = GroupEncoder { encoder: Arc::new(encoder), rows_per_group, row: PhantomData };
        Ok(Self { file, encoder, failed, open: None, rows: 0 })
    }

    /// What encodes groups of this table, on any thread.
    #[must_use]
    pub fn encoder(&self) -> GroupEncoder<R> {
        self.encoder.clone()
    }

    /// Appends rows.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn push(&mut self, rows: &[R]) -> Result<(), StoreError> {
        let mut rest = rows;
        while !rest.is_empty() {
            let GroupEncoder { encoder, rows_per_group, .. } = &self.encoder;
            let mut group = self.open.take().map_or_else(|| encoder.open(), Ok)?;
            let n = rest.len().min(rows_per_group - group.rows);
            encoder.fill(&mut group, R::to_columns(&rest[..n]), n)?;
            if group.rows == *rows_per_group {
                let group = encoder.close(group)?;
                self.append(group)?;
            } else {
                self.open = Some(group);
            }
            rest = &rest[n..];
        }
        Ok(())
    }

    /// Appends a group, after those rows that were pushed before.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn append(&mut self, group: EncodedGroup) -> Result<(), StoreError> {
        if let Some(open) = self.open.take() {
            let before = self.encoder.encoder.close(open)?;
            self.append(before)?;
        }
        self.rows += group.rows;
        let appended = append(&mut self.file, group);
        appended.map_err(|e| error_of(&self.failed, &self.encoder.encoder.location, e))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn finish(mut self) -> Result<Finished, StoreError> {
        if let Some(open) = self.open.take() {
            let last = self.encoder.encoder.close(open)?;
            self.append(last)?;
        }
        let file = self.file.into_inner();
        file.map_err(|e| error_of(&self.failed, &self.encoder.encoder.location, e))?.finish(self.rows)
    }
}

/// Encodes groups of rows of one table, on any thread. Cheap to clone.
pub struct GroupEncoder<R> {
    encoder: Arc<Encoder>,
    rows_per_group: usize,
    row: PhantomData<fn(R)>,
}

impl<R> Clone for GroupEncoder<R> {
    fn clone(&self) -> Self {
        Self { encoder: Arc::clone(&self.encoder), rows_per_group: self.rows_per_group, row: PhantomData }
    }
}

impl<R: Row> GroupEncoder<R> {
    /// Encodes rows as groups of their own, each of as many rows as the table's groups have and the last of
    /// what is left.
    ///
    /// # Errors
    /// The rows are none of such a table.
    pub fn encode(&self, rows: &[R]) -> Result<Vec<EncodedGroup>, StoreError> {
        let group = |rows: &[R]| {
            let mut group = self.encoder.open()?;
            self.encoder.fill(&mut group, R::to_columns(rows), rows.len())?;
            self.encoder.close(group)
        };
        rows.chunks(self.rows_per_group).map(group).collect()
    }
}

/// Rows of a table, encoded and compressed, that are in no file yet.
pub struct EncodedGroup {
    columns: Vec<ArrowColumnChunk>,
    rows: u64,
}

struct OpenGroup {
    columns: Vec<ArrowColumnWriter>,
    rows: usize,
}

struct Encoder {
    /// What the column of the scene says, where the table is one of a scene.
    scene: Option<u32>,
    schema: Arc<Schema>,
    factory: ArrowRowGroupWriterFactory,
    location: String,
}

impl Encoder {
    fn open(&self) -> Result<OpenGroup, StoreError> {
        // The number of the group matters to encryption alone.
        let columns = self.factory.create_column_writers(0).map_err(|e| self.error(e))?;
        Ok(OpenGroup { columns, rows: 0 })
    }

    fn fill(&self, group: &mut OpenGroup, columns: Vec<Column>, rows: usize) -> Result<(), StoreError> {
        let scene = self.scene.map(|scene| Column::U32(vec![scene; rows]));
        let arrays = scene.into_iter().chain(columns).map(convert::to_arrow).collect();
        let batch = RecordBatch::try_new(Arc::clone(&self.schema), arrays).map_err(ParquetError::from);
        batch.and_then(|batch| write(group, &batch)).map_err(|e| self.error(e))?;
        group.rows += rows;
        Ok(())
    }

    fn close(&self, group: OpenGroup) -> Result<EncodedGroup, StoreError> {
        let columns: Result<_, _> = group.columns.into_iter().map(ArrowColumnWriter::close).collect();
        Ok(EncodedGroup { columns: columns.map_err(|e| self.error(e))?, rows: group.rows as u64 })
    }

    fn error(&self, error: ParquetError) -> StoreError {
        not_encoded(&self.location, error)
    }
}

fn write(group: &mut OpenGroup, batch: &RecordBatch) -> Result<(), ParquetError> {
    let mut columns = group.columns.iter_mut();
    for (field, array) in batch.schema_ref().fields().iter().zip(batch.columns()) {
        for leaf in compute_leaves(field, array)? {
            let column = columns.next().ok_or_else(|| ParquetError::General("a column is missing".into()))?;
            column.write(&leaf)?;
        }
    }
    Ok(())
}

fn start(
    file: FileWriter,
    schema: Schema,
    options: &TableOptions,
) -> Result<(SerializedFileWriter<FileWriter>, Encoder), StoreError> {
    let (location, scene) = (file.location().to_owned(), keys::scene_of(file.key()));
    let mut fields: Vec<_> = schema.fields().iter().cloned().collect();
    if scene.is_some() {
        fields.insert(0, Arc::new(Field::new(SCENE_COLUMN.name, DataType::UInt32, false)));
    }
    let schema = Arc::new(Schema::new(fields));
    let properties = properties(&schema, options);
    let started = ArrowWriter::try_new(file, schema.clone(), Some(properties))
        .and_then(ArrowWriter::into_serialized_writer);
    let (file, factory) = started.map_err(|e| not_encoded(&location, e))?;
    Ok((file, Encoder { scene, schema, factory, location }))
}

fn append(file: &mut SerializedFileWriter<FileWriter>, group: EncodedGroup) -> Result<(), ParquetError> {
    let mut row_group = file.next_row_group()?;
    for column in group.columns {
        column.append_to_row_group(&mut row_group)?;
    }
    row_group.close()?;
    Ok(())
}

fn error_of(failed: &Failed, location: &str, error: ParquetError) -> StoreError {
    match failed.take() {
        Some(io) => StoreError::write(location, "write", io),
        None => not_encoded(location, error),
    }
}

/// What failed before anything was written.
fn not_encoded(location: &str, error: ParquetError) -> StoreError {
    let problem = error.to_string();
    match error {
        // Of the compressor, which fails for want of memory alone.
        ParquetError::External(source) if source.is::<io::Error>() => {
            StoreError::write(location, "compress", io::Error::new(io::ErrorKind::OutOfMemory, problem))
        }
        _ => StoreError::Corrupt { path: location.to_owned(), problem },
    }
}

/// Writes a table of named columns.
pub(crate) fn write_columns(file: FileWriter, columns: Vec<(&str, Column)>) -> Result<Finished, StoreError> {
    let failed = file.failed();
    let rows = columns.first().map_or(0, |(_, column)| column.len());
    let schema = convert::schema_of(columns.iter().map(|(name, column)| (*name, column)));
    let (mut file, encoder) = start(file, schema, &TableOptions::default())?;
    if rows > 0 {
        let mut group = encoder.open()?;
        encoder.fill(&mut group, columns.into_iter().map(|(_, column)| column).collect(), rows)?;
        let group = encoder.close(group)?;
        append(&mut file, group).map_err(|e| error_of(&failed, &encoder.location, e))?;
    }
    file.into_inner().map_err(|e| error_of(&failed, &encoder.location, e))?.finish(rows as u64)
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
    for Leaf { path, data_type, is_of_list } in leaves(schema) {
        let path = ColumnPath::from(path);
        if is_of_list {
            // Nobody skips a row for the least and greatest of its list.
            builder = builder.set_column_statistics_enabled(path.clone(), EnabledStatistics::None);
        }
        if matches!(data_type, DataType::Float32 | DataType::Float64) {
            builder = builder
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
        } else if matches!(data_type, DataType::Float16) {
            // Not split into streams: readers know that of 16 bits since a short time only.
            builder = builder.set_column_dictionary_enabled(path, false);
        } else if matches!(data_type, DataType::Binary) {
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

/// A column of values in the file: several make up a struct.
struct Leaf<'a> {
    path: Vec<String>,
    data_type: &'a DataType,
    is_of_list: bool,
}

fn leaves(schema: &Schema) -> Vec<Leaf<'_>> {
    let mut leaves = Vec::new();
    for field in schema.fields() {
        let name = || field.name().clone();
        match field.data_type() {
            DataType::List(item) | DataType::FixedSizeList(item, _) => leaves.push(Leaf {
                path: vec![name(), "list".into(), "item".into()],
                data_type: item.data_type(),
                is_of_list: true,
            }),
            DataType::Struct(children) => leaves.extend(children.iter().map(|child| Leaf {
                path: vec![name(), child.name().clone()],
                data_type: child.data_type(),
                is_of_list: false,
            })),
            data_type => leaves.push(Leaf { path: vec![name()], data_type, is_of_list: false }),
        }
    }
    leaves
}
