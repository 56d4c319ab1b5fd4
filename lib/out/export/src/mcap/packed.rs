//! Elements of several numbers one after another, as clouds and grids hold them.

use super::messages::{NumericType, PackedElementField};

/// Values of a number of all elements.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Values<'a> {
    F32(&'a [f32]),
    U16(&'a [u16]),
    U8(&'a [u8]),
}

impl Values<'_> {
    fn len(self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::U8(values) => values.len(),
        }
    }

    fn kind(self) -> (NumericType, usize) {
        match self {
            Self::F32(_) => (NumericType::Float32, 4),
            Self::U16(_) => (NumericType::Uint16, 2),
            Self::U8(_) => (NumericType::Uint8, 1),
        }
    }
}

/// Packed elements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Packed {
    pub(crate) fields: Vec<PackedElementField>,
    pub(crate) stride: u32,
    pub(crate) data: Vec<u8>,
}

/// Packs named columns, in their order, each element on a multiple of four bytes; none if they are not of one
/// length.
pub(crate) fn pack(columns: &[(&str, Values<'_>)]) -> Option<Packed> {
    let count = columns.first().map_or(0, |(_, values)| values.len());
    if columns.iter().any(|(_, values)| values.len() != count) {
        return None;
    }
    let (mut fields, mut offset) = (Vec::new(), 0);
    for (name, values) in columns {
        let (kind, bytes) = values.kind();
        fields.push(PackedElementField { name: (*name).to_owned(), offset: offset as u32, r#type: kind });
        offset += bytes;
    }
    let stride = offset.next_multiple_of(4);
    let mut data = vec![0; stride * count];
    for (field, (_, values)) in fields.iter().zip(columns) {
        let elements = data.chunks_exact_mut(stride).map(|element| &mut element[field.offset as usize..]);
        match values {
            Values::F32(values) => {
                elements.zip(*values).for_each(|(to, value)| to[..4].copy_from_slice(&value.to_le_bytes()));
            }
            Values::U16(values) => {
                elements.zip(*values).for_each(|(to, value)| to[..2].copy_from_slice(&value.to_le_bytes()));
            }
            Values::U8(values) => elements.zip(*values).for_each(|(to, value)| to[0] = *value),
        }
    }
    Some(Packed { fields, stride: stride as u32, data })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_stand_one_after_another() {
        let columns = [
            ("x", Values::F32(&[1.0, 2.0])),
            ("id", Values::U16(&[0x0102, 3])),
            ("tag", Values::U8(&[7, 8])),
        ];
        let packed = pack(&columns).expect("are of one length");
        assert_eq!(packed.stride, 8);
        let offsets: Vec<_> = packed.fields.iter().map(|f| (f.name.as_str(), f.offset, f.r#type)).collect();
        let (float, short, byte) = (NumericType::Float32, NumericType::Uint16, NumericType::Uint8);
        assert_eq!(offsets, [("x", 0, float), ("id", 4, short), ("tag", 6, byte)]);
        assert_eq!(packed.data, [0, 0, 0x80, 0x3f, 2, 1, 7, 0, 0, 0, 0, 0x40, 3, 0, 8, 0]);
        assert_eq!(pack(&[("x", Values::F32(&[])), ("y", Values::F32(&[1.0]))]), None);
        assert!(pack(&[("x", Values::F32(&[]))]).expect("is one").data.is_empty());
    }
}
