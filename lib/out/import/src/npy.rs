//! Arrays in files of their own (`numpy.save`), those of Python objects among them.

use crate::pickle;
use crate::value::Value;

/// Most elements of an array that is not in an archive: readings have seven, lists of boxes hundreds.
const MAX_ELEMENTS: usize = 1 << 20;

/// A file is no array, or none that can be here.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("byte {offset}: {problem}")]
pub struct NpyError {
    /// Where in the file.
    pub offset: usize,
    /// What is wrong.
    pub problem: String,
}

fn fault(offset: usize, problem: impl Into<String>) -> NpyError {
    NpyError { offset, problem: problem.into() }
}

/// Reads a file: an array of `f8` or `f4` as [`Value::Numbers`], one of objects as the list of what its
/// pickle says.
///
/// # Errors
/// It is truncated, too large, of another type, or its pickle is not one of plain values ([`pickle::parse`]).
pub fn parse(file: &[u8]) -> Result<Value, NpyError> {
    if !file.starts_with(b"\x93NUMPY") {
        return Err(fault(0, "no NPY file"));
    }
    let (start, length): (usize, usize) = match (file.get(6), file.get(8..12)) {
        (Some(1), Some([a, b, ..])) => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        (Some(2 | 3), Some([a, b, c, d])) => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
        _ => return Err(fault(6, "a version of NPY that is not known, or no header")),
    };
    let text = start.checked_add(length).and_then(|end| file.get(start..end));
    let text = text.ok_or_else(|| fault(8, "the header runs beyond the file"))?;
    let text = std::str::from_utf8(text).map_err(|_| fault(start, "the header is no text"))?;
    let descr = entry(text, "descr").ok_or_else(|| fault(start, "the header says no `descr`"))?;
    let shape =
        entry(text, "shape").and_then(shape_of).ok_or_else(|| fault(start, "the header says no `shape`"))?;
    let count = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let count = count.filter(|&n| n <= MAX_ELEMENTS).ok_or_else(|| {
        fault(start, format!("an array of shape {shape:?}: at most {MAX_ELEMENTS} elements are possible"))
    })?;
    if shape.len() > 1 && entry(text, "fortran_order") != Some("False") {
        return Err(fault(start, "Fortran order is not known here"));
    }
    let at = start + length;
    let body = &file[at..];
    match descr.trim_matches(['\'', '"']) {
        "|O" => objects(body, at, &shape),
        "<f8" => {
            floats::<8>(body, at, count, f64::from_le_bytes).map(|values| Value::Numbers { shape, values })
        }
        "<f4" => {
            let wide = |bytes| f64::from(f32::from_le_bytes(bytes));
            floats::<4>(body, at, count, wide).map(|values| Value::Numbers { shape, values })
        }
        other => Err(fault(start, format!("elements of type `{}` are not known here", other.escape_debug()))),
    }
}

fn floats<const N: usize>(
    body: &[u8],
    at: usize,
    count: usize,
    number: impl Fn([u8; N]) -> f64,
) -> Result<Vec<f64>, NpyError> {
    if body.len() != N * count {
        return Err(fault(at, format!("{} bytes where {} are announced", body.len(), N * count)));
    }
    Ok(body.chunks_exact(N).map(|bytes| number(std::array::from_fn(|i| bytes[i]))).collect())
}

fn objects(body: &[u8], at: usize, shape: &[usize]) -> Result<Value, NpyError> {
    let value = pickle::parse(body).map_err(|e| fault(at + e.offset, e.problem))?;
    match &value {
        Value::List(list) if shape == [list.len()] => Ok(value),
        _ => Err(fault(at, format!("the pickle is no list of the shape {shape:?} that the header says"))),
    }
}

/// What stands behind a key of the header's dictionary, up to the comma or bracket that ends it.
fn entry<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let behind = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|quoted| {
        let at = text.find(quoted.as_str())?;
        text[at + quoted.len()..].trim_start().strip_prefix(':')
    })?;
    let behind = behind.trim_start();
    let end = match behind.as_bytes().first()? {
        b'(' => behind.find(')')? + 1,
        _ => behind.find([',', '}'])?,
    };
    Some(behind[..end].trim())
}

/// `(3,)`, `(8, 3)`, `()`.
fn shape_of(text: &str) -> Option<Vec<usize>> {
    let inside = text.strip_prefix('(')?.strip_suffix(')')?.trim();
    let inside = inside.strip_suffix(',').unwrap_or(inside);
    if inside.is_empty() {
        return Some(Vec::new());
    }
    inside.split(',').map(|number| number.trim().parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use codecs::{Scalar, npy_header};

    use super::*;

    fn file(shape: &[usize], scalar: Scalar, body: &[u8]) -> Vec<u8> {
        [npy_header("a", &scalar.into(), shape).expect("fits"), body.to_vec()].concat()
    }

    #[test]
    fn plain_arrays_are_read() {
        let body: Vec<u8> = [1.5_f64, -2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        let found = parse(&file(&[3], Scalar::F64, &body)).expect("an array");
        assert_eq!(found, Value::Numbers { shape: vec![3], values: vec![1.5, -2.0, 3.0] });
        let none = parse(&file(&[0], Scalar::F64, &[])).expect("an array");
        assert_eq!(none, Value::Numbers { shape: vec![0], values: vec![] });
    }

    #[test]
    fn broken_files_say_where() {
        let whole = file(&[3], Scalar::F64, &[0; 24]);
        for (bytes, want) in [
            (whole[..whole.len() - 1].to_vec(), "byte 128: 23 bytes where 24 are announced"),
            (whole[..100].to_vec(), "byte 8: the header runs beyond the file"),
            (b"PK\x03\x04".to_vec(), "byte 0: no NPY file"),
            (file(&[1 << 40], Scalar::F64, &[]), "at most 1048576 elements are possible"),
            (file(&[usize::MAX, 2], Scalar::F64, &[]), "at most 1048576 elements are possible"),
            (file(&[3], Scalar::U8, &[0; 3]), "elements of type `|u1` are not known here"),
        ] {
            let error = parse(&bytes).expect_err("is broken").to_string();
            assert!(error.contains(want), "{error}");
        }
    }
}
