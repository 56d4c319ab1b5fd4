//! How a row type describes its columns, so that one definition serves writing, reading and the docs.

use std::fmt;

use serde::Serialize;

use crate::text::Text;

/// Values of one column, in row order.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "one variant per column type")]
pub enum Column {
    Bool(Vec<bool>),
    U8(Vec<u8>),
    U16(Vec<u16>),
    U32(Vec<u32>),
    U64(Vec<u64>),
    I32(Vec<i32>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    Str(Vec<String>),
    Bytes(Vec<Vec<u8>>),
    OptBool(Vec<Option<bool>>),
    OptI32(Vec<Option<i32>>),
    OptF64(Vec<Option<f64>>),
    OptStr(Vec<Option<String>>),
    ListU8(Vec<Vec<u8>>),
    ListU16(Vec<Vec<u16>>),
    ListU32(Vec<Vec<u32>>),
    /// Stored as half floats: rounded to 11 binary digits.
    ListF16(Vec<Vec<f32>>),
    ListF32(Vec<Vec<f32>>),
    ListF64(Vec<Vec<f64>>),
    ListStr(Vec<Vec<String>>),
    /// Fixed number of values per row, stored flat.
    FixedF32(usize, Vec<f32>),
    /// Fixed number of values per row, stored flat.
    FixedF64(usize, Vec<f64>),
    /// Named values per row: a column each.
    Struct(Vec<(&'static str, Column)>),
}

impl Column {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Bool(v) => v.len(),
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::U64(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::I64(v) => v.len(),
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::Str(v) => v.len(),
            Self::Bytes(v) => v.len(),
            Self::OptBool(v) => v.len(),
            Self::OptI32(v) => v.len(),
            Self::OptF64(v) => v.len(),
            Self::OptStr(v) => v.len(),
            Self::ListU8(v) => v.len(),
            Self::ListU16(v) => v.len(),
            Self::ListU32(v) => v.len(),
            Self::ListF16(v) | Self::ListF32(v) => v.len(),
            Self::ListF64(v) => v.len(),
            Self::ListStr(v) => v.len(),
            Self::FixedF32(n, v) => v.len() / (*n).max(1),
            Self::FixedF64(n, v) => v.len() / (*n).max(1),
            Self::Struct(fields) => fields.first().map_or(0, |(_, column)| column.len()),
        }
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type's name in `docs/schema.md`.
    #[must_use]
    pub fn type_name(&self) -> String {
        match self {
            Self::Bool(_) => "bool".into(),
            Self::U8(_) => "u8".into(),
            Self::U16(_) => "u16".into(),
            Self::U32(_) => "u32".into(),
            Self::U64(_) => "u64".into(),
            Self::I32(_) => "i32".into(),
            Self::I64(_) => "i64".into(),
            Self::F32(_) => "f32".into(),
            Self::F64(_) => "f64".into(),
            Self::Str(_) => "string".into(),
            Self::Bytes(_) => "binary".into(),
            Self::OptBool(_) => "bool, may be null".into(),
            Self::OptI32(_) => "i32, may be null".into(),
            Self::OptF64(_) => "f64, may be null".into(),
            Self::OptStr(_) => "string, may be null".into(),
            Self::ListU8(_) => "list of u8".into(),
            Self::ListU16(_) => "list of u16".into(),
            Self::ListU32(_) => "list of u32".into(),
            Self::ListF16(_) => "list of f16".into(),
            Self::ListF32(_) => "list of f32".into(),
            Self::ListF64(_) => "list of f64".into(),
            Self::ListStr(_) => "list of string".into(),
            Self::FixedF32(n, _) => format!("f32[{n}]"),
            Self::FixedF64(n, _) => format!("f64[{n}]"),
            Self::Struct(_) => "struct".into(),
        }
    }
}

/// A column's name and meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Column name.
    pub name: &'static str,
    /// Meaning, with unit and frame.
    pub doc: &'static str,
}

/// A column read back is not what the row type expects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnError {
    /// Column name.
    pub column: String,
    /// The row at fault, from 0; none where it is the whole column.
    pub row: Option<usize>,
    /// What is wrong.
    pub problem: String,
}

impl fmt::Display for ColumnError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column `{}`", self.column)?;
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for ColumnError {}

/// A type that is one row of a table.
pub trait Row: Sized {
    /// Table name: the file's stem.
    const TABLE: &'static str;
    /// The stage that writes it.
    const STAGE: &'static str;
    /// What the table holds, for the docs.
    const DOC: &'static str;

    /// Names and meanings of the columns, in file order.
    fn fields() -> Vec<Field>;
    /// Rows to columns, in [`Row::fields`] order.
    fn to_columns(rows: &[Self]) -> Vec<Column>;
    /// Columns (in [`Row::fields`] order) back to rows.
    ///
    /// # Errors
    /// A column has another type or length than the row type says, or a text is none of those that its type
    /// knows.
    fn from_columns(columns: Vec<Column>) -> Result<Vec<Self>, ColumnError>;
}

/// A Rust type that can be a cell of a table.
pub trait Cell: Sized {
    /// Values to a column.
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column
    where
        Self: 'a;
    /// A column back to values.
    ///
    /// # Errors
    /// It has another type, or holds a text that the cell's type does not know.
    fn values(column: Column) -> Result<Vec<Self>, CellError>;
}

/// Why a column holds no values of a cell's type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CellError {
    /// The column has another type.
    Type,
    /// A text of the column means nothing.
    Text {
        /// The text's row, from 0.
        row: usize,
        /// What is wrong with it.
        problem: String,
    },
}

macro_rules! cell {
    ($type:ty, $variant:ident) => {
        impl Cell for $type {
            fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
                Column::$variant(values.cloned().collect())
            }
            fn values(column: Column) -> Result<Vec<Self>, CellError> {
                match column {
                    Column::$variant(values) => Ok(values),
                    _ => Err(CellError::Type),
                }
            }
        }
    };
}

cell!(bool, Bool);
cell!(u8, U8);
cell!(u16, U16);
cell!(u32, U32);
cell!(u64, U64);
cell!(i32, I32);
cell!(i64, I64);
cell!(f32, F32);
cell!(f64, F64);
cell!(String, Str);
cell!(Option<bool>, OptBool);
cell!(Option<i32>, OptI32);
cell!(Option<f64>, OptF64);
cell!(Option<String>, OptStr);
cell!(Vec<u8>, ListU8);
cell!(Vec<u16>, ListU16);
cell!(Vec<u32>, ListU32);
cell!(Vec<f32>, ListF32);
cell!(Vec<f64>, ListF64);
cell!(Vec<String>, ListStr);

fn parse<T: Text>(row: usize, text: &str) -> Result<T, CellError> {
    text.parse().map_err(|e: T::Err| CellError::Text { row, problem: e.to_string() })
}

impl<T: Text> Cell for T {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column
    where
        Self: 'a,
    {
        Column::Str(values.map(Self::to_string).collect())
    }
    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        match column {
            Column::Str(texts) => texts.iter().enumerate().map(|(row, text)| parse(row, text)).collect(),
            _ => Err(CellError::Type),
        }
    }
}

impl<T: Text> Cell for Option<T> {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column
    where
        Self: 'a,
    {
        Column::OptStr(values.map(|value| value.as_ref().map(T::to_string)).collect())
    }
    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        match column {
            Column::OptStr(texts) => {
                let texts = texts.iter().enumerate();
                texts.map(|(row, text)| text.as_deref().map(|text| parse(row, text)).transpose()).collect()
            }
            _ => Err(CellError::Type),
        }
    }
}

/// Encoded bytes (an image, say): a binary column, where `Vec<u8>` is a list of numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Blob(
    /// The bytes.
    pub Vec<u8>,
);

impl Cell for Blob {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
        Column::Bytes(values.map(|b| b.0.clone()).collect())
    }
    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        match column {
            Column::Bytes(values) => Ok(values.into_iter().map(Blob).collect()),
            _ => Err(CellError::Type),
        }
    }
}

/// Numbers that are kept as half floats: 11 binary digits of each. Where a list of `f32` is asked for, such a
/// column is read, too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Halves(
    /// The numbers.
    pub Vec<f32>,
);

impl Cell for Halves {
    fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
        Column::ListF16(values.map(|halves| halves.0.clone()).collect())
    }
    fn values(column: Column) -> Result<Vec<Self>, CellError> {
        match column {
            Column::ListF16(values) => Ok(values.into_iter().map(Halves).collect()),
            _ => Err(CellError::Type),
        }
    }
}

macro_rules! fixed_cell {
    ($type:ty, $variant:ident) => {
        impl<const N: usize> Cell for [$type; N] {
            fn column<'a>(values: impl Iterator<Item = &'a Self>) -> Column {
                Column::$variant(N, values.flatten().copied().collect())
            }
            fn values(column: Column) -> Result<Vec<Self>, CellError> {
                match column {
                    Column::$variant(n, flat) if n == N => {
                        Ok(flat.chunks_exact(N).filter_map(|c| c.try_into().ok()).collect())
                    }
                    _ => Err(CellError::Type),
                }
            }
        }
    };
}

fixed_cell!(f32, FixedF32);
fixed_cell!(f64, FixedF64);

/// Takes the next column off a list, as values of a cell type.
///
/// # Errors
/// The list is at its end, or the column holds no values of the type.
pub fn take_values<T: Cell>(
    columns: &mut std::vec::IntoIter<Column>,
    name: &str,
) -> Result<Vec<T>, ColumnError> {
    let error = |row, problem: String| ColumnError { column: name.to_owned(), row, problem };
    let column = columns.next().ok_or_else(|| error(None, "is missing".into()))?;
    let found = column.type_name();
    T::values(column).map_err(|e| match e {
        CellError::Type => error(None, format!("has type {found}, another was expected")),
        CellError::Text { row, problem } => error(Some(row), problem),
    })
}

/// A row of one frame, in a table that is sorted by frame.
pub trait Framed {
    /// Number of the frame.
    fn frame(&self) -> i64;
}

/// Says that rows are of one frame: the one in their column `frame`.
#[macro_export]
macro_rules! framed {
    ($($row:ty),+ $(,)?) => {
        $(impl $crate::table::Framed for $row {
            fn frame(&self) -> i64 {
                i64::from(self.frame)
            }
        })+
    };
}

/// Defines a row type and its [`Row`] implementation.
#[macro_export]
macro_rules! table {
    (
        $(#[doc = $doc:literal])+
        $name:ident in $table:literal by $stage:literal {
            $( $(#[doc = $field_doc:literal])+ $field:ident : $type:ty, )+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name {
            $( $(#[doc = $field_doc])+ pub $field: $type, )+
        }

        $crate::impl_row! {
            $name in $table; by $stage; concat!($($doc),+);
            $( $field: $type = concat!($($field_doc),+); )+
        }
    };
}

/// Defines a row type of some columns of a table, for readers that need no others: these alone are read.
///
/// ```
/// use schema::table::Row;
/// use schema::tables::LidarRow;
///
/// schema::columns! {
///     /// How far away returns are, along the sensor's axis.
///     Ahead of LidarRow { frame: u32, x: Vec<f32> }
/// }
/// assert_eq!((Ahead::TABLE, Ahead::fields().len()), (LidarRow::TABLE, 2));
/// ```
#[macro_export]
macro_rules! columns {
    ($(#[doc = $doc:literal])+ $name:ident of $row:ty { $( $field:ident : $type:ty ),+ $(,)? }) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, Default, PartialEq)]
        pub(crate) struct $name {
            $( pub(crate) $field: $type, )+
        }

        $crate::impl_row! {
            $name in <$row as $crate::table::Row>::TABLE; by <$row as $crate::table::Row>::STAGE;
            concat!($($doc),+);
            $( $field: $type = ""; )+
        }
    };
}

/// Makes a struct a [`Row`].
#[doc(hidden)]
#[macro_export]
macro_rules! impl_row {
    (
        $name:ident in $table:expr; by $stage:expr; $doc:expr;
        $( $field:ident : $type:ty = $field_doc:expr; )+
    ) => {
        impl $crate::table::Row for $name {
            const TABLE: &'static str = $table;
            const STAGE: &'static str = $stage;
            const DOC: &'static str = $doc;

            fn fields() -> Vec<$crate::table::Field> {
                vec![$( $crate::table::Field { name: stringify!($field), doc: $field_doc } ),+]
            }

            fn to_columns(rows: &[Self]) -> Vec<$crate::table::Column> {
                vec![$( <$type as $crate::table::Cell>::column(rows.iter().map(|r| &r.$field)) ),+]
            }

            fn from_columns(
                columns: Vec<$crate::table::Column>,
            ) -> Result<Vec<Self>, $crate::table::ColumnError> {
                let mut columns = columns.into_iter();
                $( let mut $field = $crate::table::take_values::<$type>(
                    &mut columns, stringify!($field),
                )?.into_iter(); )+
                let mut rows = Vec::new();
                // All columns of a file have as many rows; the first to end ends the table.
                while let ($( Some($field), )+) = ($( $field.next(), )+) {
                    rows.push(Self { $( $field ),+ });
                }
                Ok(rows)
            }
        }
    };
}
