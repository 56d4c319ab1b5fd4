//! Members of numpy archives.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::DeflateDecoder;
use rawzip::{CompressionMethod, FileReader, RECOMMENDED_BUFFER_SIZE, ZipArchive, ZipArchiveEntryWayfinder};

use super::Unreadable;

/// Longest header of an array that is believed, bytes.
const HEADER_LIMIT: usize = 1 << 16;

/// An archive of arrays, read member by member.
pub(crate) struct Npz {
    path: PathBuf,
    archive: ZipArchive<FileReader>,
    members: BTreeMap<String, (ZipArchiveEntryWayfinder, CompressionMethod)>,
}

/// An array in C order.
#[derive(Debug, PartialEq)]
pub(crate) struct Array {
    /// As in the file: one of [`ELEMENTS`].
    pub(crate) descr: String,
    pub(crate) shape: Vec<usize>,
    /// Those of all elements.
    pub(crate) bytes: Vec<u8>,
}

/// Elements that are read, and how many bytes each has: `u8`, `bool`, `u16`, `f32`.
const ELEMENTS: [(&str, usize); 4] = [("|u1", 1), ("|b1", 1), ("<u2", 2), ("<f4", 4)];

impl Array {
    /// The elements of an array of 16-bit whole numbers.
    pub(crate) fn words(&self) -> Vec<u16> {
        self.bytes.as_chunks::<2>().0.iter().map(|bytes| u16::from_le_bytes(*bytes)).collect()
    }

    /// The elements of an array of 32-bit floats.
    pub(crate) fn floats(&self) -> Vec<f32> {
        self.bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
    }
}

impl Npz {
    pub(crate) fn open(path: &Path) -> Result<Self, Unreadable> {
        let bad = |e: &dyn std::fmt::Display| Unreadable::new(path, e);
        let file = File::open(path).map_err(|e| bad(&e))?;
        let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
        let archive = ZipArchive::from_file(file, &mut buffer).map_err(|e| bad(&e))?;
        let mut members = BTreeMap::new();
        let mut entries = archive.entries(&mut buffer);
        while let Some(entry) = entries.next_entry().map_err(|e| bad(&e))? {
            let name = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
            members.insert(name, (entry.wayfinder(), entry.compression_method()));
        }
        Ok(Self { path: path.to_owned(), archive, members })
    }

    /// Names of the members, in order.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.members.keys().map(String::as_str)
    }

    /// The array of a frame, if it has these elements and this shape. A side of 0 stands for any length.
    pub(crate) fn frame_of(&self, frame: u32, descr: &str, shape: &[usize]) -> Result<Array, Unreadable> {
        let array = self.frame(frame)?;
        let fits = array.shape.len() == shape.len()
            && array.shape.iter().zip(shape).all(|(side, wanted)| *wanted == 0 || side == wanted);
        if array.descr == descr && fits {
            return Ok(array);
        }
        let why = format!("frame {frame}: is {:?} of {}, not {shape:?} of {descr}", array.shape, array.descr);
        Err(Unreadable::new(&self.path, why))
    }

    /// The array of a frame.
    pub(crate) fn frame(&self, frame: u32) -> Result<Array, Unreadable> {
        let name = format!("{frame:04}.npy");
        let bad = |why: &dyn std::fmt::Display| Unreadable::new(&self.path, format!("{name}: {why}"));
        let (place, method) = self.members.get(&name).ok_or_else(|| bad(&"is not there"))?;
        let entry = self.archive.get_entry(*place).map_err(|e| bad(&e))?;
        let mut plain = Vec::new();
        match *method {
            CompressionMethod::STORE => entry.reader().read_to_end(&mut plain).map_err(|e| bad(&e))?,
            CompressionMethod::DEFLATE => entry
                .verifying_reader(DeflateDecoder::new(entry.reader()))
                .read_to_end(&mut plain)
                .map_err(|e| bad(&e))?,
            other => return Err(bad(&format!("compressed by {other:?}"))),
        };
        parse(plain).map_err(|why| bad(&why))
    }
}

/// Header and bytes of a `.npy` file.
fn parse(mut plain: Vec<u8>) -> Result<Array, String> {
    let (version, rest) = match plain.get(..8) {
        Some([0x93, b'N', b'U', b'M', b'P', b'Y', major, _]) => (*major, &plain[8..]),
        _ => return Err("is no numpy array".into()),
    };
    let (digits, len) = match (version, rest) {
        (1, [a, b, ..]) => (2, usize::from(u16::from_le_bytes([*a, *b]))),
        (2 | 3, [a, b, c, d, ..]) => (4, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
        _ => return Err(format!("has a header of version {version}")),
    };
    let start = 8 + digits;
    let header = plain.get(start..start + len.min(HEADER_LIMIT)).ok_or("ends within its header")?;
    let header = std::str::from_utf8(header).map_err(|e| e.to_string())?;
    let descr = quoted(header, "descr").ok_or("has no descr")?.to_owned();
    let known = ELEMENTS.iter().find(|(name, _)| *name == descr);
    let (_, width) = known.ok_or_else(|| format!("has elements {descr}"))?;
    if !header.contains("'fortran_order': False") {
        return Err("is not in C order".into());
    }
    let shape = header.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(')'));
    let (shape, _) = shape.ok_or("has no shape")?;
    let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: Vec<usize> =
        sides.map(|s| s.parse().map_err(|_| format!("side {s}"))).collect::<Result<_, _>>()?;
    let size = shape.iter().try_fold(*width, |a, &b| a.checked_mul(b)).ok_or("is too large")?;
    let bytes = plain.split_off(start + len);
    if bytes.len() != size {
        return Err(format!("has {} bytes, {size} make its shape", bytes.len()));
    }
    Ok(Array { descr, shape, bytes })
}

/// The text in quotes that a key has.
fn quoted<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}':"))?;
    rest.split('\'').nth(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, bytes: &[u8]) -> Vec<u8> {
        let len = (header.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00".as_slice(), &len, header.as_bytes(), bytes].concat()
    }

    #[test]
    fn arrays_are_read_as_numpy_writes_them() {
        let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }  \n";
        let array = parse(file(header, &[1, 2, 3, 4, 5, 6])).expect("reads");
        assert_eq!((array.descr.as_str(), array.shape.as_slice()), ("|u1", [2, 3].as_slice()));
        assert_eq!(array.bytes, [1, 2, 3, 4, 5, 6]);
        let flat = parse(file("{'descr': '|b1', 'fortran_order': False, 'shape': (2,), }", &[0, 1]));
        assert_eq!(flat.expect("reads").shape, [2]);
        let words = parse(file("{'descr': '<u2', 'fortran_order': False, 'shape': (2,), }", &[1, 2, 0, 1]));
        assert_eq!(words.expect("reads").words(), [513, 256]);
        let floats =
            parse(file("{'descr': '<f4', 'fortran_order': False, 'shape': (1,), }", &[0, 0, 0xc0, 0x3f]));
        assert_eq!(floats.expect("reads").floats(), [1.5]);
    }

    #[test]
    fn what_is_no_such_array_is_refused() {
        let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";
        for (broken, why) in [
            (b"PK".to_vec(), "no numpy array"),
            (file(header, &[1]), "has 1 bytes, 6 make its shape"),
            (file(&header.replace("|u1", "<f8"), &[0; 6]), "elements <f8"),
            (file(&header.replace("False", "True"), &[0; 6]), "C order"),
            (file("{'descr': '|u1', 'fortran_order': False}", &[]), "no shape"),
        ] {
            let fault = parse(broken).expect_err("is broken");
            assert!(fault.contains(why), "{fault}");
        }
    }
}
