//! Columns of a batch as plain values.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, PrimitiveArray};
use arrow_schema::DataType;

/// What a column holds, as far as predictions go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Whole numbers of any width.
    Integer,
    /// Numbers with a fraction, of either width.
    Float,
    /// Texts.
    Text,
    /// Lists of so many numbers with a fraction.
    Floats(usize),
}

impl Kind {
    /// In words.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Integer => "integer".into(),
            Self::Float => "float".into(),
            Self::Text => "string".into(),
            Self::Floats(n) => format!("list of {n} floats"),
        }
    }

    /// Whether a column of a type holds it.
    pub(crate) fn is(self, found: &DataType) -> bool {
        match (self, found) {
            (Self::Integer, found) => found.is_integer(),
            (Self::Float, DataType::Float32 | DataType::Float64) => true,
            (Self::Text, DataType::Utf8) => true,
            (Self::Floats(_), DataType::List(item)) => Self::Float.is(item.data_type()),
            _ => false,
        }
    }
}

fn all<T: ArrowPrimitiveType, V>(array: &dyn Array, of: impl Fn(T::Native) -> V) -> Vec<V> {
    let array: &PrimitiveArray<T> = array.as_primitive();
    array.values().iter().map(|value| of(*value)).collect()
}

/// Whole numbers; those that are none of the kind wanted as none. Nothing where the column has another type.
pub(crate) fn integers(array: &ArrayRef) -> Option<Vec<Option<u32>>> {
    let array = array.as_ref();
    Some(match array.data_type() {
        DataType::Int8 => all::<Int8Type, _>(array, |v| v.try_into().ok()),
        DataType::Int16 => all::<Int16Type, _>(array, |v| v.try_into().ok()),
        DataType::Int32 => all::<Int32Type, _>(array, |v| v.try_into().ok()),
        DataType::Int64 => all::<Int64Type, _>(array, |v| v.try_into().ok()),
        DataType::UInt8 => all::<UInt8Type, _>(array, |v| Some(v.into())),
        DataType::UInt16 => all::<UInt16Type, _>(array, |v| Some(v.into())),
        DataType::UInt32 => all::<UInt32Type, _>(array, Some),
        DataType::UInt64 => all::<UInt64Type, _>(array, |v| v.try_into().ok()),
        _ => return None,
    })
}

/// Numbers, NaN where there is none.
pub(crate) fn floats(array: &dyn Array) -> Option<Vec<f64>> {
    let mut values = match array.data_type() {
        DataType::Float32 => all::<Float32Type, _>(array, f64::from),
        DataType::Float64 => all::<Float64Type, _>(array, |v| v),
        _ => return None,
    };
    if array.null_count() > 0 {
        values.iter_mut().enumerate().filter(|(i, _)| array.is_null(*i)).for_each(|(_, v)| *v = f64::NAN);
    }
    Some(values)
}

/// Lists of N numbers; `Err` with the first row whose list has not N. Null lists are all NaN.
pub(crate) fn lists<const N: usize>(array: &ArrayRef) -> Option<Result<Vec<[f64; N]>, usize>> {
    let lists = array.as_list_opt::<i32>()?;
    let items = floats(lists.values().as_ref())?;
    let offsets = lists.value_offsets();
    let row = |i: usize| {
        if lists.is_null(i) {
            return Ok([f64::NAN; N]);
        }
        let (start, end) = (offsets[i] as usize, offsets[i + 1] as usize);
        items.get(start..end).and_then(|list| list.try_into().ok()).ok_or(i)
    };
    Some((0..lists.len()).map(row).collect())
}
