//! Between our columns and arrow's arrays.
//!
//! By hand, not by `serde_arrow`: the row types lie in `schema`, which knows no Arrow and makes the docs from
//! the same definition, and a lidar's lists are moved here as whole slices where serde would visit each
//! number.

use std::sync::Arc;

use arrow_array::types::{
    ArrowPrimitiveType, Float16Type, Float32Type, Float64Type, UInt8Type, UInt16Type, UInt32Type,
};
use arrow_array::{
    Array, ArrayRef, BinaryArray, BooleanArray, FixedSizeListArray, Float32Array, Float64Array,
    GenericListArray, Int32Array, Int64Array, ListArray, PrimitiveArray, StringArray, StructArray,
    UInt8Array, UInt16Array, UInt32Array, UInt64Array,
};
use arrow_buffer::OffsetBuffer;
use arrow_schema::{DataType, Field, Fields, Schema};
use schema::table::{Column, ColumnError, Row};

type Half = <Float16Type as ArrowPrimitiveType>::Native;

/// The arrow schema of a row type.
pub(crate) fn arrow_schema<R: Row>() -> Schema {
    let types = R::to_columns(&[]);
    schema_of(R::fields().into_iter().map(|field| field.name).zip(&types))
}

/// The arrow schema of some named columns.
pub(crate) fn schema_of<'a>(columns: impl Iterator<Item = (&'a str, &'a Column)>) -> Schema {
    Schema::new(columns.map(|(name, column)| field_of(name, column)).collect::<Vec<_>>())
}

fn field_of(name: &str, column: &Column) -> Field {
    let (data_type, nullable) = arrow_type(column);
    Field::new(name, data_type, nullable)
}

fn fields_of(columns: &[(&'static str, Column)]) -> Fields {
    columns.iter().map(|(name, column)| field_of(name, column)).collect()
}

fn item(data_type: DataType) -> Arc<Field> {
    Arc::new(Field::new("item", data_type, false))
}

fn arrow_type(column: &Column) -> (DataType, bool) {
    let data_type = match column {
        Column::Bool(_) | Column::OptBool(_) => DataType::Boolean,
        Column::U8(_) => DataType::UInt8,
        Column::U16(_) => DataType::UInt16,
        Column::U32(_) => DataType::UInt32,
        Column::U64(_) => DataType::UInt64,
        Column::I32(_) | Column::OptI32(_) => DataType::Int32,
        Column::I64(_) => DataType::Int64,
        Column::F32(_) => DataType::Float32,
        Column::F64(_) | Column::OptF64(_) => DataType::Float64,
        Column::Str(_) | Column::OptStr(_) => DataType::Utf8,
        Column::Bytes(_) => DataType::Binary,
        Column::ListU8(_) => DataType::List(item(DataType::UInt8)),
        Column::ListU16(_) => DataType::List(item(DataType::UInt16)),
        Column::ListU32(_) => DataType::List(item(DataType::UInt32)),
        Column::ListF16(_) => DataType::List(item(DataType::Float16)),
        Column::ListF32(_) => DataType::List(item(DataType::Float32)),
        Column::ListF64(_) => DataType::List(item(DataType::Float64)),
        Column::ListStr(_) => DataType::List(item(DataType::Utf8)),
        Column::FixedF32(n, _) => DataType::FixedSizeList(item(DataType::Float32), *n as i32),
        Column::FixedF64(n, _) => DataType::FixedSizeList(item(DataType::Float64), *n as i32),
        Column::Struct(fields) => DataType::Struct(fields_of(fields)),
    };
    let nullable =
        matches!(column, Column::OptBool(_) | Column::OptI32(_) | Column::OptF64(_) | Column::OptStr(_));
    (data_type, nullable)
}

/// Our column as an arrow array.
pub(crate) fn to_arrow(column: Column) -> ArrayRef {
    match column {
        Column::Bool(v) => Arc::new(BooleanArray::from(v)),
        Column::U8(v) => Arc::new(UInt8Array::from(v)),
        Column::U16(v) => Arc::new(UInt16Array::from(v)),
        Column::U32(v) => Arc::new(UInt32Array::from(v)),
        Column::U64(v) => Arc::new(UInt64Array::from(v)),
        Column::I32(v) => Arc::new(Int32Array::from(v)),
        Column::I64(v) => Arc::new(Int64Array::from(v)),
        Column::F32(v) => Arc::new(Float32Array::from(v)),
        Column::F64(v) => Arc::new(Float64Array::from(v)),
        Column::Str(v) => Arc::new(StringArray::from(v)),
        Column::Bytes(v) => Arc::new(BinaryArray::from_iter_values(v)),
        Column::OptBool(v) => Arc::new(BooleanArray::from(v)),
        Column::OptI32(v) => Arc::new(Int32Array::from(v)),
        Column::OptF64(v) => Arc::new(Float64Array::from(v)),
        Column::OptStr(v) => Arc::new(StringArray::from(v)),
        Column::ListU8(v) => primitive_list::<UInt8Type>(v),
        Column::ListU16(v) => primitive_list::<UInt16Type>(v),
        Column::ListU32(v) => primitive_list::<UInt32Type>(v),
        Column::ListF16(v) => {
            let halves = |row: Vec<f32>| row.into_iter().map(Half::from_f32).collect();
            primitive_list::<Float16Type>(v.into_iter().map(halves).collect())
        }
        Column::ListF32(v) => primitive_list::<Float32Type>(v),
        Column::ListF64(v) => primitive_list::<Float64Type>(v),
        Column::ListStr(v) => {
            let offsets = OffsetBuffer::from_lengths(v.iter().map(Vec::len));
            let values = StringArray::from_iter_values(v.into_iter().flatten());
            Arc::new(ListArray::new(item(DataType::Utf8), offsets, Arc::new(values), None))
        }
        Column::FixedF32(n, v) => Arc::new(FixedSizeListArray::new(
            item(DataType::Float32),
            n as i32,
            Arc::new(Float32Array::from(v)),
            None,
        )),
        Column::FixedF64(n, v) => Arc::new(FixedSizeListArray::new(
            item(DataType::Float64),
            n as i32,
            Arc::new(Float64Array::from(v)),
            None,
        )),
        Column::Struct(columns) => {
            let fields = fields_of(&columns);
            let arrays = columns.into_iter().map(|(_, column)| to_arrow(column)).collect();
            Arc::new(StructArray::new(fields, arrays, None))
        }
    }
}

fn primitive_list<T: ArrowPrimitiveType>(rows: Vec<Vec<T::Native>>) -> ArrayRef {
    let offsets = OffsetBuffer::from_lengths(rows.iter().map(Vec::len));
    let values: Vec<T::Native> = rows.concat();
    Arc::new(ListArray::new(
        item(T::DATA_TYPE),
        offsets,
        Arc::new(PrimitiveArray::<T>::from_iter_values(values)),
        None,
    ))
}

/// An arrow array as our column, of the type that `wanted` has.
pub(crate) fn from_arrow(name: &str, wanted: &Column, array: &dyn Array) -> Result<Column, ColumnError> {
    let wrong = || ColumnError {
        column: name.to_owned(),
        row: None,
        problem: format!("has type {}, {} was expected", array.data_type(), wanted.type_name()),
    };
    macro_rules! primitive {
        ($array:ty) => {
            array.as_any().downcast_ref::<$array>().ok_or_else(wrong)?
        };
    }
    Ok(match wanted {
        Column::Bool(_) => Column::Bool(primitive!(BooleanArray).values().iter().collect()),
        Column::U8(_) => Column::U8(primitive!(UInt8Array).values().to_vec()),
        Column::U16(_) => Column::U16(primitive!(UInt16Array).values().to_vec()),
        Column::U32(_) => Column::U32(primitive!(UInt32Array).values().to_vec()),
        Column::U64(_) => Column::U64(primitive!(UInt64Array).values().to_vec()),
        Column::I32(_) => Column::I32(primitive!(Int32Array).values().to_vec()),
        Column::I64(_) => Column::I64(primitive!(Int64Array).values().to_vec()),
        Column::F32(_) => Column::F32(primitive!(Float32Array).values().to_vec()),
        Column::F64(_) => Column::F64(primitive!(Float64Array).values().to_vec()),
        Column::OptBool(_) => Column::OptBool(primitive!(BooleanArray).iter().collect()),
        Column::OptI32(_) => Column::OptI32(primitive!(Int32Array).iter().collect()),
        Column::OptF64(_) => Column::OptF64(primitive!(Float64Array).iter().collect()),
        Column::Str(_) => {
            Column::Str(primitive!(StringArray).iter().map(|s| s.unwrap_or_default().to_owned()).collect())
        }
        Column::OptStr(_) => {
            Column::OptStr(primitive!(StringArray).iter().map(|s| s.map(str::to_owned)).collect())
        }
        Column::Bytes(_) => {
            Column::Bytes(primitive!(BinaryArray).iter().map(|b| b.unwrap_or_default().to_vec()).collect())
        }
        Column::ListU8(_) => {
            Column::ListU8(list_values::<UInt8Type>(primitive!(ListArray)).ok_or_else(wrong)?)
        }
        Column::ListU16(_) => {
            Column::ListU16(list_values::<UInt16Type>(primitive!(ListArray)).ok_or_else(wrong)?)
        }
        Column::ListU32(_) => {
            Column::ListU32(list_values::<UInt32Type>(primitive!(ListArray)).ok_or_else(wrong)?)
        }
        Column::ListF16(_) => Column::ListF16(halves(primitive!(ListArray)).ok_or_else(wrong)?),
        // Half floats are such numbers, too.
        Column::ListF32(_) => {
            let list = primitive!(ListArray);
            let values = list_values::<Float32Type>(list).or_else(|| halves(list));
            Column::ListF32(values.ok_or_else(wrong)?)
        }
        Column::ListF64(_) => {
            Column::ListF64(list_values::<Float64Type>(primitive!(ListArray)).ok_or_else(wrong)?)
        }
        Column::ListStr(_) => {
            let list = primitive!(ListArray);
            let values = list.values().as_any().downcast_ref::<StringArray>().ok_or_else(wrong)?;
            let rows = list
                .offsets()
                .windows(2)
                .map(|w| (w[0]..w[1]).map(|i| values.value(i as usize).to_owned()).collect());
            Column::ListStr(rows.collect())
        }
        Column::FixedF32(n, _) => {
            let list = primitive!(FixedSizeListArray);
            let values = list.values().as_any().downcast_ref::<Float32Array>().ok_or_else(wrong)?;
            if list.value_length() as usize != *n {
                return Err(wrong());
            }
            Column::FixedF32(*n, values.values().to_vec())
        }
        Column::FixedF64(n, _) => {
            let list = primitive!(FixedSizeListArray);
            let values = list.values().as_any().downcast_ref::<Float64Array>().ok_or_else(wrong)?;
            if list.value_length() as usize != *n {
                return Err(wrong());
            }
            Column::FixedF64(*n, values.values().to_vec())
        }
        // What stands in its place in tables of format 1: the cell's type knows its meaning.
        Column::Struct(fields) if !matches!(array.data_type(), DataType::Struct(_)) => {
            match array.data_type() {
                DataType::Utf8 => from_arrow(name, &Column::Str(Vec::new()), array)?,
                DataType::FixedSizeList(..) => {
                    from_arrow(name, &Column::FixedF64(fields.len(), Vec::new()), array)?
                }
                _ => return Err(wrong()),
            }
        }
        Column::Struct(fields) => {
            let array = primitive!(StructArray);
            let field = |(field, wanted): &(&'static str, Column)| {
                let name = format!("{name}.{field}");
                let lacks = || ColumnError { column: name.clone(), row: None, problem: "is missing".into() };
                let values = array.column_by_name(field).ok_or_else(lacks)?;
                Ok((*field, from_arrow(&name, wanted, values.as_ref())?))
            };
            Column::Struct(fields.iter().map(field).collect::<Result<_, _>>()?)
        }
    })
}

fn list_values<T: ArrowPrimitiveType>(list: &GenericListArray<i32>) -> Option<Vec<Vec<T::Native>>> {
    let values = list.values().as_any().downcast_ref::<PrimitiveArray<T>>()?;
    Some(list.offsets().windows(2).map(|w| values.values()[w[0] as usize..w[1] as usize].to_vec()).collect())
}

fn halves(list: &GenericListArray<i32>) -> Option<Vec<Vec<f32>>> {
    let rows = list_values::<Float16Type>(list)?;
    Some(rows.into_iter().map(|row| row.into_iter().map(Half::to_f32).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_keep_eleven_digits_and_read_as_floats() {
        let sent = vec![vec![0.0, 1.0, -2.0, 1.0 + 1.0 / 4096.0, 0.1], vec![]];
        let array = to_arrow(Column::ListF16(sent));
        // The third number after 1 is 1 + 1/512: 1 + 1/4096 is nearer to 1. Of 0.1 the nearest half is 1638 /
        // 2^14.
        let kept = vec![vec![0.0, 1.0, -2.0, 1.0, 1638.0 / 16_384.0], vec![]];
        for wanted in [Column::ListF32(Vec::new()), Column::ListF16(Vec::new())] {
            let read = from_arrow("dx", &wanted, &array).expect("is one");
            let (Column::ListF32(values) | Column::ListF16(values)) = read else { panic!("{read:?}") };
            assert_eq!(values, kept);
        }
        let floats = to_arrow(Column::ListF32(vec![vec![0.1]]));
        let wrong = from_arrow("dx", &Column::ListF16(Vec::new()), &floats).expect_err("has more digits");
        assert!(wrong.to_string().contains("list of f16 was expected"), "{wrong}");
    }
}
