//! Tables in Parquet.

use std::fs::File;
use std::path::{Path, PathBuf};

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float16Type, Float32Type, Float64Type, Int32Type, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch};
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use serde_json::Value;

use super::Unreadable;

/// Rows that are decoded at a time.
const BATCH_ROWS: usize = 8192;

/// A table on disk. Small ones are read whole, large ones a row group (a frame) at a time.
pub(crate) struct Table {
    path: PathBuf,
    metadata: ArrowReaderMetadata,
}

/// Some rows of a table.
pub(crate) struct Batch {
    path: PathBuf,
    rows: RecordBatch,
}

impl Table {
    pub(crate) fn open(path: &Path) -> Result<Self, Unreadable> {
        let file = File::open(path).map_err(|e| Unreadable::new(path, e))?;
        let metadata =
            ArrowReaderMetadata::load(&file, Default::default()).map_err(|e| Unreadable::new(path, e))?;
        Ok(Self { path: path.to_owned(), metadata })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What the file says of itself under a key.
    pub(crate) fn note(&self, key: &str) -> Option<&str> {
        let notes = self.metadata.metadata().file_metadata().key_value_metadata();
        notes.into_iter().flatten().find(|note| note.key == key)?.value.as_deref()
    }

    pub(crate) fn row_count(&self) -> usize {
        usize::try_from(self.metadata.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    pub(crate) fn group_count(&self) -> usize {
        self.metadata.metadata().num_row_groups()
    }

    /// Whether a column is there.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.metadata.schema().column_with_name(column).is_some()
    }

    /// All rows, some at a time.
    pub(crate) fn batches(&self) -> Result<Vec<Batch>, Unreadable> {
        self.groups((0..self.metadata.metadata().num_row_groups()).collect())
    }

    /// The row at a place. The row group that holds it is read: of sensors, one frame.
    pub(crate) fn row(&self, at: usize) -> Result<Batch, Unreadable> {
        let mut before = 0;
        for (group, about) in self.metadata.metadata().row_groups().iter().enumerate() {
            let len = usize::try_from(about.num_rows()).unwrap_or(0);
            if at < before + len {
                let mut within = at - before;
                for batch in self.groups(vec![group])? {
                    if within < batch.len() {
                        return Ok(Batch { rows: batch.rows.slice(within, 1), path: batch.path });
                    }
                    within -= batch.len();
                }
                break;
            }
            before += len;
        }
        Err(Unreadable::new(&self.path, format!("has no row {at}")))
    }

    fn groups(&self, groups: Vec<usize>) -> Result<Vec<Batch>, Unreadable> {
        let bad = |e: &dyn std::fmt::Display| Unreadable::new(&self.path, e);
        let file = File::open(&self.path).map_err(|e| bad(&e))?;
        let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(file, self.metadata.clone());
        let reader =
            builder.with_row_groups(groups).with_batch_size(BATCH_ROWS).build().map_err(|e| bad(&e))?;
        reader.map(|rows| Ok(Batch { path: self.path.clone(), rows: rows.map_err(|e| bad(&e))? })).collect()
    }
}

impl Batch {
    pub(crate) fn len(&self) -> usize {
        self.rows.num_rows()
    }

    /// Names of the columns and their values.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&str, &ArrayRef)> {
        let fields = self.rows.schema_ref().fields().iter();
        fields.map(|f| f.name().as_str()).zip(self.rows.columns())
    }

    fn column(&self, name: &str) -> Result<&ArrayRef, Unreadable> {
        self.rows.column_by_name(name).ok_or_else(|| self.fault(name, "is not there"))
    }

    fn fault(&self, column: &str, why: &str) -> Unreadable {
        Unreadable::new(&self.path, format!("column {column} {why}"))
    }

    /// Whole numbers, of any width; nulls are none.
    pub(crate) fn maybe_ints(&self, name: &str) -> Result<Vec<Option<i64>>, Unreadable> {
        ints_of(self.column(name)?).ok_or_else(|| self.fault(name, "holds no whole numbers"))
    }

    /// Whole numbers, of any width.
    pub(crate) fn ints(&self, name: &str) -> Result<Vec<i64>, Unreadable> {
        self.all(name, self.maybe_ints(name)?)
    }

    /// Real numbers, of any width; nulls are none.
    pub(crate) fn maybe_reals(&self, name: &str) -> Result<Vec<Option<f64>>, Unreadable> {
        reals_of(self.column(name)?).ok_or_else(|| self.fault(name, "holds no real numbers"))
    }

    /// Real numbers, of any width.
    pub(crate) fn reals(&self, name: &str) -> Result<Vec<f64>, Unreadable> {
        self.all(name, self.maybe_reals(name)?)
    }

    /// Texts; nulls are none.
    pub(crate) fn maybe_texts(&self, name: &str) -> Result<Vec<Option<String>>, Unreadable> {
        let texts = self.column(name)?.as_string_opt::<i32>();
        let texts = texts.ok_or_else(|| self.fault(name, "holds no text"))?;
        Ok(texts.iter().map(|text| text.map(str::to_owned)).collect())
    }

    /// Texts.
    pub(crate) fn texts(&self, name: &str) -> Result<Vec<String>, Unreadable> {
        self.all(name, self.maybe_texts(name)?)
    }

    /// Facts about objects: a struct of named values, or in format 1 a JSON object; those that are not said
    /// are left out.
    pub(crate) fn facts(&self, name: &str) -> Result<Vec<Value>, Unreadable> {
        let Some(fields) = self.column(name)?.as_struct_opt() else {
            let texts = self.texts(name)?;
            return Ok(texts.iter().map(|text| serde_json::from_str(text).unwrap_or(Value::Null)).collect());
        };
        let mut rows = vec![serde_json::Map::new(); self.len()];
        for (key, values) in fields.column_names().into_iter().zip(fields.columns()) {
            let values: Vec<Option<Value>> = if let Some(texts) = values.as_string_opt::<i32>() {
                texts.iter().map(|text| text.map(Value::from)).collect()
            } else if let Some(flags) = values.as_boolean_opt() {
                flags.iter().map(|flag| flag.map(Value::from)).collect()
            } else if let Some(numbers) = ints_of(values) {
                numbers.into_iter().map(|number| number.map(Value::from)).collect()
            } else {
                let numbers = reals_of(values).ok_or_else(|| self.fault(name, "holds no facts"))?;
                numbers.into_iter().map(|number| number.map(Value::from)).collect()
            };
            for (row, value) in rows.iter_mut().zip(values) {
                row.extend(value.map(|value| (key.to_owned(), value)));
            }
        }
        Ok(rows.into_iter().map(Value::Object).collect())
    }

    /// A column that older tables lack.
    pub(crate) fn maybe_there<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Self, &str) -> Result<T, Unreadable>,
    ) -> Result<Option<T>, Unreadable> {
        self.rows.column_by_name(name).map(|_| read(self, name)).transpose()
    }

    /// Truth values.
    pub(crate) fn flags(&self, name: &str) -> Result<Vec<bool>, Unreadable> {
        let flags = self.column(name)?.as_boolean_opt();
        let flags = flags.ok_or_else(|| self.fault(name, "holds no truth values"))?;
        self.all(name, flags.iter().collect())
    }

    /// Vectors of N numbers.
    pub(crate) fn vectors<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, Unreadable> {
        let list = self.column(name)?.as_fixed_size_list_opt();
        let list = list.ok_or_else(|| self.fault(name, "holds no vectors"))?;
        let values = reals_of(list.values()).ok_or_else(|| self.fault(name, "holds no real numbers"))?;
        let values = self.all(name, values)?;
        if list.value_length() as usize != N || values.len() != N * self.len() {
            return Err(self.fault(name, &format!("holds no vectors of {N} numbers")));
        }
        Ok(values.as_chunks::<N>().0.to_vec())
    }

    /// Lists of whole numbers.
    pub(crate) fn int_lists(&self, name: &str) -> Result<Vec<Vec<i64>>, Unreadable> {
        let lists = self.lists(name)?;
        let each = |values: ArrayRef| {
            self.all(name, ints_of(&values).ok_or_else(|| self.fault(name, "holds no whole numbers"))?)
        };
        lists.into_iter().map(each).collect()
    }

    /// Lists of real numbers.
    pub(crate) fn real_lists(&self, name: &str) -> Result<Vec<Vec<f64>>, Unreadable> {
        let each = |values: ArrayRef| {
            self.all(name, reals_of(&values).ok_or_else(|| self.fault(name, "holds no real numbers"))?)
        };
        self.lists(name)?.into_iter().map(each).collect()
    }

    /// Lists of texts.
    pub(crate) fn text_lists(&self, name: &str) -> Result<Vec<Vec<String>>, Unreadable> {
        let each = |values: ArrayRef| {
            let texts = values.as_string_opt::<i32>().ok_or_else(|| self.fault(name, "holds no text"))?;
            self.all(name, texts.iter().map(|text| text.map(str::to_owned)).collect())
        };
        self.lists(name)?.into_iter().map(each).collect()
    }

    fn lists(&self, name: &str) -> Result<Vec<ArrayRef>, Unreadable> {
        let list = self.column(name)?.as_list_opt::<i32>();
        let list = list.ok_or_else(|| self.fault(name, "holds no lists"))?;
        Ok((0..list.len()).map(|row| list.value(row)).collect())
    }

    /// The list of the first row, of numbers of a known width.
    pub(crate) fn first_list<T: ArrowPrimitiveType>(&self, name: &str) -> Result<Vec<T::Native>, Unreadable> {
        let lists = self.lists(name)?;
        let values = lists.first().and_then(|list| list.as_primitive_opt::<T>());
        let values = values.ok_or_else(|| self.fault(name, "holds no lists of such numbers"))?;
        Ok(values.values().to_vec())
    }

    /// The list of the first row, of 32-bit floats or of half floats, and whether it is of the latter.
    pub(crate) fn first_floats(&self, name: &str) -> Result<(Vec<f32>, bool), Unreadable> {
        match self.first_list::<Float16Type>(name) {
            Ok(halves) => Ok((halves.into_iter().map(f32::from).collect(), true)),
            Err(_) => Ok((self.first_list::<Float32Type>(name)?, false)),
        }
    }

    /// The bytes of the first row.
    pub(crate) fn first_bytes(&self, name: &str) -> Result<&[u8], Unreadable> {
        let bytes = self.column(name)?.as_binary_opt::<i32>().filter(|bytes| !bytes.is_empty());
        Ok(bytes.ok_or_else(|| self.fault(name, "holds no bytes"))?.value(0))
    }

    fn all<T>(&self, name: &str, values: Vec<Option<T>>) -> Result<Vec<T>, Unreadable> {
        values.into_iter().collect::<Option<_>>().ok_or_else(|| self.fault(name, "has nulls"))
    }
}

fn each_as<T: ArrowPrimitiveType, U>(
    array: &ArrayRef,
    make: impl Fn(T::Native) -> U,
) -> Option<Vec<Option<U>>> {
    Some(array.as_primitive_opt::<T>()?.iter().map(|value| value.map(&make)).collect())
}

fn ints_of(array: &ArrayRef) -> Option<Vec<Option<i64>>> {
    each_as::<UInt8Type, _>(array, i64::from)
        .or_else(|| each_as::<UInt16Type, _>(array, i64::from))
        .or_else(|| each_as::<UInt32Type, _>(array, i64::from))
        .or_else(|| each_as::<Int32Type, _>(array, i64::from))
        .or_else(|| each_as::<UInt64Type, _>(array, |v| i64::try_from(v).unwrap_or(i64::MAX)))
}

fn reals_of(array: &ArrayRef) -> Option<Vec<Option<f64>>> {
    each_as::<Float64Type, _>(array, |v| v)
        .or_else(|| each_as::<Float32Type, _>(array, f64::from))
        .or_else(|| each_as::<Float16Type, _>(array, f64::from))
}

/// Values of a column of real numbers (or of lists or structs of them) that are no numbers: how many of how
/// many; none for other columns.
pub(crate) fn unreal(array: &ArrayRef) -> Option<(usize, usize)> {
    if let Some(values) = array.as_primitive_opt::<Float64Type>() {
        return Some((values.iter().flatten().filter(|v| !v.is_finite()).count(), values.len()));
    }
    if let Some(values) = array.as_primitive_opt::<Float32Type>() {
        return Some((values.iter().flatten().filter(|v| !v.is_finite()).count(), values.len()));
    }
    if let Some(values) = array.as_primitive_opt::<Float16Type>() {
        return Some((values.iter().flatten().filter(|v| !v.is_finite()).count(), values.len()));
    }
    if let Some(fields) = array.as_struct_opt() {
        let counts = fields.columns().iter().filter_map(unreal);
        return counts.reduce(|(bad, all), (more_bad, more)| (bad + more_bad, all + more));
    }
    let list = array.as_list_opt::<i32>().map(|list| list.values().clone());
    let list = list.or_else(|| array.as_fixed_size_list_opt().map(|list| list.values().clone()))?;
    unreal(&list)
}

/// Least and greatest value of a column of numbers (or of lists of them); none for other columns and where
/// there is none.
pub(crate) fn extent(array: &ArrayRef) -> Option<(f64, f64)> {
    let reals = |values: &mut dyn Iterator<Item = f64>| {
        values.filter(|v| v.is_finite()).fold(None, |ends: Option<(f64, f64)>, v| {
            Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
        })
    };
    if let Some(values) = array.as_primitive_opt::<Float64Type>() {
        return reals(&mut values.iter().flatten());
    }
    if let Some(values) = array.as_primitive_opt::<Float32Type>() {
        return reals(&mut values.iter().flatten().map(f64::from));
    }
    if let Some(values) = array.as_primitive_opt::<Float16Type>() {
        return reals(&mut values.iter().flatten().map(f64::from));
    }
    if let Some(values) = ints_of(array) {
        return reals(&mut values.into_iter().flatten().map(|v| v as f64));
    }
    let list = array.as_list_opt::<i32>().map(|list| list.values().clone());
    extent(&list.or_else(|| array.as_fixed_size_list_opt().map(|list| list.values().clone()))?)
}
