//! The rows of a table, some at a time.

use std::collections::BTreeSet;
use std::marker::PhantomData;
use std::ops::Range;

use arrow_array::RecordBatch;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder,
    RowSelection,
};
use parquet::errors::ParquetError;
use schema::older::of_format_1;
use schema::table::{Column, ColumnError, Row};

use crate::shard::Chunks;
use crate::{StoreError, convert};

/// So many bytes ahead the place is told of what is read, and the most that is read in one go because of
/// that.
const TOLD_AHEAD: u64 = 8 << 20;
const TOLD_AT_ONCE: u64 = 1 << 20;

/// Rows of a table, some at a time.
pub struct RowGroups<R> {
    reader: ParquetRecordBatchReader,
    table: Table,
    /// Which rows are still to be handed out.
    wanted: Vec<Range<usize>>,
    /// The first group that nobody was told of yet.
    untold: usize,
    row: PhantomData<fn() -> R>,
}

impl<R: Row> RowGroups<R> {
    /// Opens a table; all rows are wanted where none are named.
    pub(crate) fn open(chunks: Chunks, wanted: Option<Vec<Range<usize>>>) -> Result<Self, StoreError> {
        let loaded = ArrowReaderMetadata::load(&chunks, ArrowReaderOptions::new());
        let about = loaded.map_err(|e| chunks.error(&e))?;
        let parquet_schema = about.parquet_schema();
        let columns = parquet_schema.root_schema().get_fields();
        let named: BTreeSet<&str> = R::fields()
            .iter()
            .map(|field| match of_format_1(R::TABLE, field.name) {
                Some(older) if columns.iter().all(|column| column.name() != field.name) => older.from,
                _ => field.name,
            })
            .collect();
        let own: Vec<usize> = (0..columns.len()).filter(|i| named.contains(columns[*i].name())).collect();
        let columns = ProjectionMask::roots(parquet_schema, own);
        let table = Table { chunks, about, columns };
        let all = table.groups().last().map_or(0, |group| group.end);
        let wanted = wanted.map_or_else(
            || std::iter::once(0..all).collect::<Vec<_>>(),
            |wanted| wanted.into_iter().map(|range| range.start.min(all)..range.end.min(all)).collect(),
        );
        Ok(Self { reader: table.reader(&wanted)?, table, wanted, untold: 0, row: PhantomData })
    }

    /// Passes over so many of the rows that come next.
    ///
    /// # Errors
    /// The table cannot be decoded.
    pub fn pass(&mut self, rows: usize) -> Result<(), StoreError> {
        if rows > 0 {
            self.take(rows);
            self.reader = self.table.reader(&self.wanted)?;
        }
        Ok(())
    }

    /// Tells the place which groups are read now and next: many small ones in one go.
    fn announce(&mut self) {
        let Some(first) = self.wanted.first().map(|range| range.start) else { return };
        let is_wanted = |group: &Range<usize>| {
            self.wanted.iter().any(|range| range.start < group.end && group.start < range.end)
        };
        let groups = self.table.groups().enumerate().skip_while(|(_, group)| group.end <= first);
        let groups = groups.filter(|(_, group)| is_wanted(group));
        let mut coming = groups.filter_map(|(i, _)| Some((i, self.table.bytes_of(i)?))).peekable();
        let (mut ahead, mut number) = (0, 0);
        while let Some((_, bytes)) = coming.next_if(|(i, _)| *i < self.untold) {
            ahead += bytes.end - bytes.start;
            number += 1;
        }
        if number > 1 && ahead > TOLD_AHEAD / 2 {
            return;
        }
        let mut told: Vec<Range<u64>> = Vec::new();
        for (i, bytes) in coming {
            if number > 1 && ahead > TOLD_AHEAD {
                break;
            }
            ahead += bytes.end - bytes.start;
            number += 1;
            self.untold = i + 1;
            match told.last_mut() {
                Some(last) if last.end <= bytes.start && bytes.end - last.start <= TOLD_AT_ONCE => {
                    last.end = bytes.end;
                }
                _ => told.push(bytes),
            }
        }
        told.into_iter().for_each(|bytes| self.table.chunks.will_read(bytes));
    }

    /// Takes so many rows off those that are wanted.
    fn take(&mut self, rows: usize) {
        let mut left = rows;
        self.wanted.retain_mut(|range| {
            let taken = left.min(range.len());
            range.start += taken;
            left -= taken;
            range.start < range.end
        });
    }
}

impl<R: Row> Iterator for RowGroups<R> {
    type Item = Result<Vec<R>, StoreError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.announce();
        let batch = self.reader.next()?;
        let batch = batch.map_err(|e| self.table.chunks.error(&e));
        Some(batch.and_then(|batch| {
            let in_file = |row: usize| self.wanted.iter().cloned().flatten().nth(row).unwrap_or(row);
            let rows = rows_of(&batch)
                .map_err(|e| self.table.chunks.error(&ColumnError { row: e.row.map(in_file), ..e }));
            self.take(batch.num_rows());
            rows
        }))
    }
}

/// An open table.
struct Table {
    chunks: Chunks,
    about: ArrowReaderMetadata,
    columns: ProjectionMask,
}

impl Table {
    /// The rows of each group.
    fn groups(&self) -> impl Iterator<Item = Range<usize>> {
        self.about.metadata().row_groups().iter().scan(0, |end, group| {
            let start = *end;
            *end += usize::try_from(group.num_rows()).unwrap_or(0);
            Some(start..*end)
        })
    }

    /// Where the columns of a group lie that are read, if not far from each other.
    fn bytes_of(&self, group: usize) -> Option<Range<u64>> {
        let group = self.about.metadata().row_groups().get(group)?;
        let columns = group.columns().iter().enumerate();
        let read =
            columns.filter(|(i, _)| self.columns.leaf_included(*i)).map(|(_, column)| column.byte_range());
        let (mut first, mut end, mut needed) = (u64::MAX, 0, 0);
        for (start, bytes) in read {
            (first, end) = (first.min(start), end.max(start.saturating_add(bytes)));
            needed += bytes;
        }
        (first < end && end - first <= 2 * needed).then_some(first..end)
    }

    /// Reads some rows, in ascending ranges.
    fn reader(&self, wanted: &[Range<usize>]) -> Result<ParquetRecordBatchReader, StoreError> {
        // A batch never spans more than a few thousand rows, nor several frames of a sensor.
        let batch = self.groups().map(|group| group.len()).max().unwrap_or(0).clamp(1, 8192);
        let (mut groups, mut selected, mut before) = (Vec::new(), Vec::new(), 0);
        let mut rest = wanted;
        for (i, group) in self.groups().enumerate() {
            while rest.first().is_some_and(|range| range.end <= group.start) {
                rest = &rest[1..];
            }
            let mut is_wanted = false;
            for range in rest.iter().take_while(|range| range.start < group.end) {
                let (start, end) = (range.start.max(group.start), range.end.min(group.end));
                is_wanted |= start < end;
                selected.push(before + start - group.start..before + end - group.start);
            }
            if is_wanted {
                groups.push(i);
                before += group.len();
            }
        }
        let selection = RowSelection::from_consecutive_ranges(selected.into_iter(), before);
        self.build(groups, selection, batch).map_err(|e| self.chunks.error(&e))
    }

    fn build(
        &self,
        groups: Vec<usize>,
        selection: RowSelection,
        batch: usize,
    ) -> Result<ParquetRecordBatchReader, ParquetError> {
        ParquetRecordBatchReaderBuilder::new_with_metadata(self.chunks.clone(), self.about.clone())
            .with_projection(self.columns.clone())
            .with_batch_size(batch)
            .with_row_groups(groups)
            .with_row_selection(selection)
            .build()
    }
}

fn rows_of<R: Row>(batch: &RecordBatch) -> Result<Vec<R>, ColumnError> {
    let wanted: Vec<Column> = R::to_columns(&[]);
    let mut columns = Vec::with_capacity(wanted.len());
    let of_batch = |name: &'static str, wanted: &Column| match batch.column_by_name(name) {
        Some(array) => convert::from_arrow(name, wanted, array.as_ref()),
        None => Err(ColumnError { column: name.to_owned(), row: None, problem: "is missing".into() }),
    };
    for (field, column) in R::fields().into_iter().zip(&wanted) {
        let older = of_format_1(R::TABLE, field.name).filter(|_| batch.column_by_name(field.name).is_none());
        columns.push(match older {
            Some(older) => older.column(of_batch)?,
            None => of_batch(field.name, column)?,
        });
    }
    R::from_columns(columns)
}
