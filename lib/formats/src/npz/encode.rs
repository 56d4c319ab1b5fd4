//! One array to the compressed bytes of a member.

use flate2::{Compress, Compression, FlushCompress, Status};

use super::zip;
use crate::dtype::DType;
use crate::error::NpzError;
use crate::npy;

/// Compression level for grids and masks: close to the smallest, at a fraction of the time of zlib's usual 6.
pub const DEFAULT_LEVEL: u32 = 2;

/// Input is checksummed and compressed in pieces of this size, so that the second reads what the first left in
/// the processor's cache.
const PIECE: usize = 256 << 10;

/// A member ready to be appended: compressed, with its sizes and checksum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedMember {
    pub(super) name: String,
    pub(super) method: u16,
    pub(super) crc: u32,
    pub(super) plain_len: u64,
    pub(super) data: Vec<u8>,
}

impl EncodedMember {
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
pub fn encode_member(
    name: &str,
    dtype: impl Into<DType>,
    shape: &[usize],
    bytes: &[u8],
    level: u32,
) -> Result<EncodedMember, NpzError> {
    let dtype = dtype.into();
    let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.');
    if name.is_empty() || name.len() > 255 || !name.bytes().all(plain) {
        return Err(NpzError::invalid(name, "a name is 1 to 255 letters, digits, `_`, `-` and `.`"));
    }
    if npy::array_len(&dtype, shape) != Some(bytes.len()) {
        let problem = format!("{} bytes don't fill the shape {shape:?} of {}", bytes.len(), dtype.literal());
        return Err(NpzError::invalid(name, problem));
    }
    let header = npy::npy_header(name, &dtype, shape)?;
    let mut crc = crc32fast::Hasher::new();
    let (method, data) = if level == 0 {
        let data = [header.as_slice(), bytes].concat();
        crc.update(&data);
        (zip::STORED, data)
    } else {
        let mut deflater = Deflater::new(level.min(9));
        for piece in std::iter::once(header.as_slice()).chain(bytes.chunks(PIECE)) {
            crc.update(piece);
            deflater.push(name, piece)?;
        }
        (zip::DEFLATED, deflater.finish(name)?)
    };
    let plain_len = header.len() as u64 + bytes.len() as u64;
    Ok(EncodedMember { name: name.to_owned(), method, crc: crc.finalize(), plain_len, data })
}

/// A raw DEFLATE stream in memory.
struct Deflater {
    state: Compress,
    out: Vec<u8>,
}

impl Deflater {
    fn new(level: u32) -> Self {
        Self { state: Compress::new(Compression::new(level), false), out: Vec::with_capacity(64 << 10) }
    }

    fn push(&mut self, name: &str, mut piece: &[u8]) -> Result<(), NpzError> {
        while !piece.is_empty() {
            let taken = self.step(name, piece, FlushCompress::None)?.0;
            piece = &piece[taken..];
        }
        Ok(())
    }

    fn finish(mut self, name: &str) -> Result<Vec<u8>, NpzError> {
        while self.step(name, &[], FlushCompress::Finish)?.1 != Status::StreamEnd {}
        self.out.shrink_to_fit();
        Ok(self.out)
    }

    /// Compresses once; how many bytes it took and where the stream stands.
    fn step(&mut self, name: &str, input: &[u8], flush: FlushCompress) -> Result<(usize, Status), NpzError> {
        // Doubling: a stuck compressor is impossible while there is room to write.
        if self.out.capacity() - self.out.len() < 1024 {
            self.out.reserve(self.out.capacity());
        }
        let before = self.state.total_in();
        let status = self
            .state
            .compress_vec(input, &mut self.out, flush)
            .map_err(|error| NpzError::invalid(name, format!("compression failed: {error}")))?;
        Ok(((self.state.total_in() - before) as usize, status))
    }
}
