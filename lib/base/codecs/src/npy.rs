//! The NPY header, before an array's bytes.
//!
//! By hand: `npyz` brings some twenty crates (a grammar of Python's literals, big numbers) for this one line
//! of text.

use crate::dtype::{DType, Scalar};
use crate::error::NpzError;

/// Magic string and version 1.0.
const MAGIC: [u8; 8] = *b"\x93NUMPY\x01\x00";
/// Bytes before the header's text: magic, version and the length of the text.
pub(crate) const PREFIX_LEN: usize = MAGIC.len() + 2;
/// The array's bytes start at a multiple of this.
const ALIGN: usize = 64;
/// numpy leaves room for the first dimension to grow to this many digits.
const GROWTH_DIGITS: usize = 21;
/// numpy's limit on the number of dimensions.
const MAX_DIMENSIONS: usize = 64;

/// An array read from an archive, in C order, little-endian.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Array {
    /// Type of the elements.
    pub dtype: DType,
    /// Lengths of the dimensions, slowest first. Empty for a single value.
    pub shape: Vec<usize>,
    /// The elements: product of `shape` times size of `dtype` bytes.
    pub bytes: Vec<u8>,
}

/// Number of bytes of an array, if they can be counted.
pub(crate) fn array_len(dtype: &DType, shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(dtype.size(), |product, &n| product.checked_mul(n))
}

/// The header of a NPY file (version 1.0, C order), up to the array's first byte: the same bytes that numpy
/// writes, including the spaces it leaves for a growing first dimension.
///
/// # Errors
/// [`NpzError::Invalid`], naming `place`, when numpy has no such type or shape.
///
/// ```
/// let header = codecs::npy_header("grid", &codecs::Scalar::U8.into(), &[2, 3])?;
/// assert_eq!(header.len() % 64, 0);
/// assert!(header[10..].starts_with(b"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }"));
/// # Ok::<(), codecs::NpzError>(())
/// ```
pub fn npy_header(place: &str, dtype: &DType, shape: &[usize]) -> Result<Vec<u8>, NpzError> {
    if let Some(fault) = dtype.fault() {
        return Err(NpzError::invalid(place, fault));
    }
    header_of(place, &dtype.literal(), shape)
}

/// The header of a NPY file of Python objects, which follow as one pickle.
///
/// # Errors
/// As [`npy_header`].
///
/// ```
/// let header = codecs::npy_object_header("boxes", &[2])?;
/// assert!(header[10..].starts_with(b"{'descr': '|O', 'fortran_order': False, 'shape': (2,), }"));
/// # Ok::<(), codecs::NpzError>(())
/// ```
pub fn npy_object_header(place: &str, shape: &[usize]) -> Result<Vec<u8>, NpzError> {
    header_of(place, "'|O'", shape)
}

/// A header of a type in Python's words.
fn header_of(place: &str, descr: &str, shape: &[usize]) -> Result<Vec<u8>, NpzError> {
    if shape.len() > MAX_DIMENSIONS {
        let problem = format!("{} dimensions, numpy has at most {MAX_DIMENSIONS}", shape.len());
        return Err(NpzError::invalid(place, problem));
    }
    let numbers = shape.iter().map(usize::to_string).collect::<Vec<_>>();
    let tuple =
        if numbers.len() == 1 { format!("({},)", numbers[0]) } else { format!("({})", numbers.join(", ")) };
    let mut text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {tuple}, }}");
    let growth = numbers.first().map_or(0, |first| GROWTH_DIGITS.saturating_sub(first.len()));
    text.extend(std::iter::repeat_n(' ', growth));
    // The line feed is counted before padding, so 1 to 64 spaces are added.
    let padding = ALIGN - (PREFIX_LEN + text.len() + 1) % ALIGN;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let len = u16::try_from(text.len())
        .map_err(|_| NpzError::invalid(place, "the record has too many fields for a header"))?;
    let mut header = Vec::with_capacity(PREFIX_LEN + text.len());
    header.extend_from_slice(&MAGIC);
    header.extend_from_slice(&len.to_le_bytes());
    header.extend_from_slice(text.as_bytes());
    Ok(header)
}

/// Length of the header's text, from the first [`PREFIX_LEN`] bytes.
pub(crate) fn text_len(member: &str, prefix: &[u8; PREFIX_LEN]) -> Result<usize, NpzError> {
    if prefix[..6] != MAGIC[..6] {
        return Err(NpzError::corrupt(member, "wrong magic: the member is not a NPY array"));
    }
    if prefix[6..8] != MAGIC[6..8] {
        return Err(NpzError::unsupported(member, format!("NPY version {}.{}", prefix[6], prefix[7])));
    }
    Ok(usize::from(u16::from_le_bytes([prefix[8], prefix[9]])))
}

/// Reads the header's text: a Python dictionary.
pub(crate) fn parse_text(member: &str, text: &[u8]) -> Result<(DType, Vec<usize>), NpzError> {
    let mut parser = Parser { member, text, at: 0 };
    let (mut dtype, mut fortran, mut shape) = (None, None, None);
    parser.expect(b'{')?;
    while !parser.accept(b'}') {
        let key = parser.string()?;
        parser.expect(b':')?;
        match key {
            "descr" => dtype = Some(parser.dtype()?),
            "fortran_order" => fortran = Some(parser.boolean()?),
            "shape" => shape = Some(parser.shape()?),
            other => return Err(parser.fault(&format!("unknown key `{}`", other.escape_debug()))),
        }
        if !parser.accept(b',') {
            parser.expect(b'}')?;
            break;
        }
    }
    parser.skip_spaces();
    if parser.at != text.len() {
        return Err(parser.fault("text after the dictionary"));
    }
    match (dtype, fortran, shape) {
        (Some(_), Some(true), Some(_)) => Err(NpzError::unsupported(member, "Fortran order")),
        (Some(dtype), Some(false), Some(shape)) => Ok((dtype, shape)),
        _ => Err(parser.fault("descr, fortran_order or shape is missing")),
    }
}

/// Reads the few Python literals that a header holds. It never recurses, so its depth is bounded.
struct Parser<'a> {
    member: &'a str,
    text: &'a [u8],
    at: usize,
}

impl<'a> Parser<'a> {
    fn fault(&self, problem: &str) -> NpzError {
        NpzError::corrupt(self.member, format!("NPY header, byte {}: {problem}", self.at))
    }

    fn skip_spaces(&mut self) {
        while matches!(self.text.get(self.at), Some(b' ' | b'\n')) {
            self.at += 1;
        }
    }

    fn accept(&mut self, byte: u8) -> bool {
        self.skip_spaces();
        let found = self.text.get(self.at) == Some(&byte);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, byte: u8) -> Result<(), NpzError> {
        if self.accept(byte) { Ok(()) } else { Err(self.fault(&format!("`{}` expected", char::from(byte)))) }
    }

    fn string(&mut self) -> Result<&'a str, NpzError> {
        self.skip_spaces();
        let quote = match self.text.get(self.at) {
            Some(&quote @ (b'\'' | b'"')) => quote,
            _ => return Err(self.fault("a string expected")),
        };
        let rest = &self.text[self.at + 1..];
        let len = rest.iter().position(|&b| b == quote).ok_or_else(|| self.fault("a string without end"))?;
        let string =
            std::str::from_utf8(&rest[..len]).map_err(|_| self.fault("a string that is not UTF-8"))?;
        self.at += len + 2;
        Ok(string)
    }

    fn boolean(&mut self) -> Result<bool, NpzError> {
        self.skip_spaces();
        for (word, value) in [("True", true), ("False", false)] {
            if self.text[self.at..].starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.fault("True or False expected"))
    }

    fn scalar(&mut self) -> Result<Scalar, NpzError> {
        let descr = self.string()?;
        Scalar::from_descr(descr).ok_or_else(|| {
            NpzError::unsupported(self.member, format!("element type `{}`", descr.escape_debug()))
        })
    }

    fn dtype(&mut self) -> Result<DType, NpzError> {
        if !self.accept(b'[') {
            return self.scalar().map(DType::Scalar);
        }
        let mut fields = Vec::new();
        while !self.accept(b']') {
            self.expect(b'(')?;
            let name = self.string()?.to_owned();
            self.expect(b',')?;
            let scalar = self.scalar()?;
            self.expect(b')')?;
            fields.push((name, scalar));
            if !self.accept(b',') {
                self.expect(b']')?;
                break;
            }
        }
        let dtype = DType::Record(fields);
        match dtype.fault() {
            Some(fault) => Err(self.fault(&fault)),
            None => Ok(dtype),
        }
    }

    fn shape(&mut self) -> Result<Vec<usize>, NpzError> {
        self.expect(b'(')?;
        let mut shape = Vec::new();
        while !self.accept(b')') {
            if shape.len() == MAX_DIMENSIONS {
                return Err(self.fault("too many dimensions"));
            }
            shape.push(self.length()?);
            if !self.accept(b',') {
                self.expect(b')')?;
                break;
            }
        }
        Ok(shape)
    }

    fn length(&mut self) -> Result<usize, NpzError> {
        self.skip_spaces();
        let digits = self.text[self.at..].iter().take_while(|b| b.is_ascii_digit()).count();
        let number = std::str::from_utf8(&self.text[self.at..self.at + digits])
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.fault("the length of a dimension expected"))?;
        self.at += digits;
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(header: &[u8]) -> &[u8] {
        &header[PREFIX_LEN..]
    }

    #[test]
    fn the_header_is_numpys() {
        let header = npy_header("m", &Scalar::Bool.into(), &[14, 400, 400]).expect("valid");
        assert_eq!(header.len(), 128);
        assert_eq!(&header[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let text = std::str::from_utf8(text_of(&header)).expect("ASCII");
        assert!(text.starts_with("{'descr': '|b1', 'fortran_order': False, 'shape': (14, 400, 400), }  "));
        assert!(text.ends_with(" \n"));
    }

    #[test]
    fn headers_read_back() {
        let record = DType::Record(vec![("x".into(), Scalar::F32), ("ObjIdx".into(), Scalar::U32)]);
        for dtype in [Scalar::F64.into(), Scalar::U8.into(), record] {
            for shape in [vec![], vec![0], vec![7], vec![3, 4], vec![1280, 1280, 80], vec![1; 40]] {
                let header = npy_header("m", &dtype, &shape).expect("valid");
                assert_eq!(header.len() % ALIGN, 0);
                let prefix = header[..PREFIX_LEN].try_into().expect("long enough");
                assert_eq!(text_len("m", &prefix).expect("magic"), header.len() - PREFIX_LEN);
                assert_eq!(parse_text("m", text_of(&header)).expect("valid"), (dtype.clone(), shape));
            }
        }
    }

    #[test]
    fn other_spellings_of_the_dictionary_read_too() {
        let text = br#"{"shape":(2,3),"fortran_order":False,"descr":"<i2"}"#;
        assert_eq!(parse_text("m", text).expect("valid"), (Scalar::I16.into(), vec![2, 3]));
    }

    #[test]
    fn faults_are_named() {
        let cases: [(&[u8], &str); 7] = [
            (b"{'descr': '>f4', 'fortran_order': False, 'shape': (), }", "unsupported: element type `>f4`"),
            (b"{'descr': '<f4', 'fortran_order': True, 'shape': (), }", "unsupported: Fortran order"),
            (b"{'descr': '<f4', 'shape': (), }", "fortran_order or shape is missing"),
            (b"{'descr': '<f4', 'fortran_order': 0, 'shape': (), }", "True or False expected"),
            (b"{'shape': (99999999999999999999999,), }", "the length of a dimension expected"),
            (b"{'shape': (-1,), }", "the length of a dimension expected"),
            (b"{'shape", "a string without end"),
        ];
        for (text, want) in cases {
            let error = parse_text("0003.npy", text).expect_err("invalid").to_string();
            assert!(error.starts_with("0003.npy: ") && error.contains(want), "{error}");
        }
    }
}
