//! Element types of arrays.

use std::fmt::Write;

/// A number in an array, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Scalar {
    /// One byte, 0 or 1.
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Scalar {
    const ALL: [(Self, &'static str, usize); 12] = [
        (Self::Bool, "|b1", 1),
        (Self::I8, "|i1", 1),
        (Self::U8, "|u1", 1),
        (Self::I16, "<i2", 2),
        (Self::U16, "<u2", 2),
        (Self::I32, "<i4", 4),
        (Self::U32, "<u4", 4),
        (Self::I64, "<i8", 8),
        (Self::U64, "<u8", 8),
        (Self::F16, "<f2", 2),
        (Self::F32, "<f4", 4),
        (Self::F64, "<f8", 8),
    ];

    /// numpy's description: `|b1`, `<f4`, ...
    #[must_use]
    pub fn descr(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// Bytes of one element.
    #[must_use]
    pub fn size(self) -> usize {
        Self::ALL[self as usize].2
    }

    /// The type of a description.
    #[must_use]
    pub fn from_descr(descr: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, d, _)| *d == descr).map(|(scalar, ..)| scalar)
    }
}

/// Type of an array's elements.
///
/// ```
/// use codecs::{DType, Scalar};
///
/// let point = DType::Record(vec![("x".into(), Scalar::F32), ("tag".into(), Scalar::U8)]);
/// assert_eq!((point.size(), DType::from(Scalar::F64).size()), (5, 8));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DType {
    /// Plain numbers.
    Scalar(Scalar),
    /// Named fields without padding between them (a numpy structured array).
    Record(Vec<(String, Scalar)>),
}

impl From<Scalar> for DType {
    fn from(scalar: Scalar) -> Self {
        Self::Scalar(scalar)
    }
}

impl DType {
    /// Bytes of one element.
    #[must_use]
    pub fn size(&self) -> usize {
        match self {
            Self::Scalar(scalar) => scalar.size(),
            Self::Record(fields) => fields.iter().map(|(_, scalar)| scalar.size()).sum(),
        }
    }

    /// What is wrong with the type, if anything: records need fields, and names that are safe and unique.
    pub(crate) fn fault(&self) -> Option<String> {
        let Self::Record(fields) = self else { return None };
        if fields.is_empty() {
            return Some("a record without fields".into());
        }
        for (i, (name, _)) in fields.iter().enumerate() {
            if name.is_empty() || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
                return Some(format!(
                    "field name `{}` is not made of letters, digits and _",
                    name.escape_debug()
                ));
            }
            if fields[..i].iter().any(|(other, _)| other == name) {
                return Some(format!("two fields are named `{name}`"));
            }
        }
        None
    }

    /// As a Python literal, spelled like numpy spells it.
    pub(crate) fn literal(&self) -> String {
        match self {
            Self::Scalar(scalar) => format!("'{}'", scalar.descr()),
            Self::Record(fields) => {
                let mut text = String::from("[");
                for (i, (name, scalar)) in fields.iter().enumerate() {
                    let comma = if i == 0 { "" } else { ", " };
                    let _ = write!(text, "{comma}('{name}', '{}')", scalar.descr());
                }
                text.push(']');
                text
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_variants() {
        for (i, (scalar, descr, size)) in Scalar::ALL.into_iter().enumerate() {
            assert_eq!(scalar as usize, i);
            assert_eq!(Scalar::from_descr(descr), Some(scalar));
            assert!(descr.ends_with(&size.to_string()));
        }
        assert_eq!(Scalar::from_descr(">f4"), None);
    }

    #[test]
    fn records_are_checked() {
        let record =
            |names: &[&str]| DType::Record(names.iter().map(|n| ((*n).into(), Scalar::F32)).collect());
        assert_eq!(record(&["x", "y"]).fault(), None);
        assert_eq!(record(&["x", "y"]).literal(), "[('x', '<f4'), ('y', '<f4')]");
        assert_eq!(record(&["x", "y"]).size(), 8);
        assert!(record(&[]).fault().is_some());
        assert!(record(&["x", "x"]).fault().is_some());
        assert!(record(&["x'"]).fault().is_some());
    }
}
