//! One array to the compressed bytes of a member.

use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::CompressionMethod;

use crate::deflate::{Repeats, deflate};
use crate::dtype::DType;
use crate::error::NpzError;
use crate::npy;

/// Compression level for grids and masks: close to the smallest, at a fraction of the time of zlib's usual 6.
pub const DEFAULT_LEVEL: u32 = 2;

/// Input is checksummed and compressed in pieces of this size, so that the second reads what the first left
/// in the processor's cache.
const PIECE: usize = 256 << 10;

/// A member ready to be appended: compressed, with its sizes and checksum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedMember {
    pub(super) name: String,
    pub(super) method: CompressionMethod,
    pub(super) crc: u32,
    pub(super) plain_len: u64,
    pub(super) data: Vec<u8>,
}

impl EncodedMember {
    /// Bytes that are no array, as a member that is stored as it is.
    ///
    /// # Errors
    /// [`NpzError::Invalid`] when the name is no plain file name.
    pub fn stored(name: &str, bytes: Vec<u8>) -> Result<Self, NpzError> {
        check_name(name)?;
        let (crc, plain_len) = (crc32fast::hash(&bytes), bytes.len() as u64);
        Ok(Self { name: name.to_owned(), method: CompressionMethod::STORE, crc, plain_len, data: bytes })
    }

    /// The same under another name: what a member is called stands outside of its compressed bytes.
    ///
    /// # Errors
    /// [`NpzError::Invalid`] when the name is no plain file name.
    pub fn renamed(self, name: &str) -> Result<Self, NpzError> {
        check_name(name)?;
        Ok(Self { name: name.to_owned(), ..self })
    }

    /// The member's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Bytes that the member's data takes in the archive.
    #[must_use]
    pub fn compressed_len(&self) -> usize {
        self.data.len()
    }
}

/// Encodes an array as a member of an archive.
///
/// `bytes` are the elements in C order, little-endian; booleans are bytes 0 and 1. `level` 0 stores, 1 is
/// fastest, 9 (and above) smallest. Members don't depend on each other, so many can be encoded at once.
///
/// # Errors
/// [`NpzError::Invalid`] when the name is no plain file name or the bytes don't fill the shape.
///
/// ```
/// let member = codecs::encode_member("0000.npy", codecs::Scalar::F32, &[2, 1], &[0; 8], 2)?;
/// assert_eq!(member.name(), "0000.npy");
/// # Ok::<(), codecs::NpzError>(())
/// ```
pub fn encode_member(
    name: &str,
    dtype: impl Into<DType>,
    shape: &[usize],
    bytes: &[u8],
    level: u32,
) -> Result<EncodedMember, NpzError> {
    let header = header_of(name, &dtype.into(), shape, bytes)?;
    let mut crc = crc32fast::Hasher::new();
    let (method, data) = if level == 0 {
        let data = [header.as_slice(), bytes].concat();
        crc.update(&data);
        (CompressionMethod::STORE, data)
    } else {
        let mut deflater = DeflateEncoder::new(Vec::with_capacity(64 << 10), Compression::new(level.min(9)));
        for piece in std::iter::once(header.as_slice()).chain(bytes.chunks(PIECE)) {
            crc.update(piece);
            deflater.write_all(piece)?;
        }
        let mut data = deflater.finish()?;
        data.shrink_to_fit();
        (CompressionMethod::DEFLATE, data)
    };
    let plain_len = header.len() as u64 + bytes.len() as u64;
    Ok(EncodedMember { name: name.to_owned(), method, crc: crc.finalize(), plain_len, data })
}

/// Encodes an array of measurements as a member of an archive, faster and smaller than [`encode_member`] at
/// its fastest: it shortens bytes by how often they occur, and looks for repeats only where it is told.
///
/// # Errors
/// As [`encode_member`].
///
/// ```
/// // Three records of 12 bytes, of which the last eight are often the same.
/// let bytes: Vec<u8> = (0..3_u8).flat_map(|i| [i, 7, 9, 3, 1, 0, 0, 0, 5, 0, 0, 0]).collect();
/// let repeats = codecs::Repeats { distances: &[12], step: 4 };
/// let member = codecs::encode_records("points.npy", codecs::Scalar::U8, &[3, 12], &bytes, repeats)?;
/// # Ok::<(), codecs::NpzError>(())
/// ```
pub fn encode_records(
    name: &str,
    dtype: impl Into<DType>,
    shape: &[usize],
    bytes: &[u8],
    repeats: Repeats<'_>,
) -> Result<EncodedMember, NpzError> {
    let header = header_of(name, &dtype.into(), shape, bytes)?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(&header);
    crc.update(bytes);
    let plain_len = header.len() as u64 + bytes.len() as u64;
    let (method, data) = (CompressionMethod::DEFLATE, deflate(&header, bytes, repeats));
    Ok(EncodedMember { name: name.to_owned(), method, crc: crc.finalize(), plain_len, data })
}

/// The header of an array that fills its shape.
fn header_of(name: &str, dtype: &DType, shape: &[usize], bytes: &[u8]) -> Result<Vec<u8>, NpzError> {
    check_name(name)?;
    if npy::array_len(dtype, shape) != Some(bytes.len()) {
        let problem = format!("{} bytes don't fill the shape {shape:?} of {}", bytes.len(), dtype.literal());
        return Err(NpzError::invalid(name, problem));
    }
    npy::npy_header(name, dtype, shape)
}

fn check_name(name: &str) -> Result<(), NpzError> {
    let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.');
    if name.is_empty() || name.len() > 255 || !name.bytes().all(plain) {
        return Err(NpzError::invalid(name, "a name is 1 to 255 letters, digits, `_`, `-` and `.`"));
    }
    Ok(())
}
