//! Single members out of an archive.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom};

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, MAX_CENTRAL_DIRECTORY_RECORD_SIZE, ReaderAt, ZipArchive, ZipLocator};
use rawzip::{ZipArchiveEntryWayfinder, ZipFileHeaderRecord};

use super::encode::EncodedMember;
use crate::dtype::DType;
use crate::error::NpzError;
use crate::npy::{self, Array};

/// Arrays beyond this many bytes are refused unless the reader is told otherwise (1 GiB).
pub const DEFAULT_MAX_BYTES: u64 = 1 << 30;

/// DEFLATE cannot shrink further: 258 bytes in 2 bits, and a small block around them. A member that claims
/// more is refused before memory is set aside for it.
const MAX_RATIO: u64 = 1040;
const DIRECTORY: &str = "central directory";

/// A member as it lies in an archive, with what its header says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedArray {
    /// Type of the elements.
    pub dtype: DType,
    /// Lengths of the dimensions, slowest first.
    pub shape: Vec<usize>,
    /// The member, still compressed: for another archive, under its name or another one.
    pub member: EncodedMember,
}

/// Reads members of a numpy archive one by one; the rest of the archive is not touched.
///
/// Anything may be wrong with the archive: the answer is an error, and memory stays within the size of
/// the archive plus [`NpzReader::with_max_bytes`].
///
/// ```
/// use std::io::Cursor;
/// use codecs::{NpzError, NpzReader, NpzWriter, Scalar, encode_member};
///
/// let mut writer = NpzWriter::new(Vec::new());
/// writer.append(encode_member("points.npy", Scalar::U16, &[2], &[1, 0, 2, 0], 0)?)?;
/// let mut reader = NpzReader::new(Cursor::new(writer.finish()?))?.with_max_bytes(1 << 20);
/// assert_eq!(reader.members().collect::<Vec<_>>(), ["points.npy"]);
/// assert_eq!(reader.read("points.npy")?.shape, [2]);
/// assert!(matches!(reader.read("other.npy"), Err(NpzError::NoMember { .. })));
/// # Ok::<(), NpzError>(())
/// ```
#[derive(Debug)]
pub struct NpzReader<R> {
    archive: ZipArchive<Places<R>>,
    entries: Vec<Entry>,
    by_name: BTreeMap<String, usize>,
    max_bytes: u64,
}

/// A stream, read from any place.
#[derive(Debug)]
struct Places<R>(RefCell<R>);

impl<R: Read + Seek> ReaderAt for Places<R> {
    fn read_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
        let mut stream = self.0.borrow_mut();
        stream.seek(SeekFrom::Start(offset))?;
        stream.read(buffer)
    }
}

#[derive(Clone, Debug)]
struct Entry {
    name: String,
    place: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
    encrypted: bool,
    crc: u32,
    data_len: u64,
    plain_len: u64,
}

impl Entry {
    /// An entry of the central directory, which starts at `data_end`; or what is wrong with it.
    fn of(record: &ZipFileHeaderRecord<'_>, data_end: u64) -> Result<Self, String> {
        let name = std::str::from_utf8(record.file_path().as_ref())
            .map_err(|_| "its name is not UTF-8".to_owned())?
            .to_owned();
        let data_len = record.compressed_size_hint();
        // Nothing that memory is set aside for may be larger than the file.
        if record.local_header_offset().checked_add(data_len).is_none_or(|end| end > data_end) {
            return Err(format!("`{name}` lies beyond the members"));
        }
        let flags = record.flags();
        Ok(Self {
            name,
            place: record.wayfinder(),
            method: record.compression_method(),
            encrypted: flags.is_encrypted() || flags.has_strong_encryption() || flags.is_masked(),
            crc: record.crc32(),
            data_len,
            plain_len: record.uncompressed_size_hint(),
        })
    }
}

impl<R: Read + Seek> NpzReader<R> {
    /// Opens an archive and reads its directory.
    ///
    /// # Errors
    /// [`NpzError::Truncated`] when there is no directory at the end, [`NpzError::Corrupt`] when it makes no
    /// sense, [`NpzError::Io`] from the stream.
    pub fn new(mut stream: R) -> Result<Self, NpzError> {
        let file_len = stream.seek(SeekFrom::End(0))?;
        let mut buffer = vec![0; MAX_CENTRAL_DIRECTORY_RECORD_SIZE];
        let archive = ZipLocator::new()
            .locate_in_reader(Places(RefCell::new(stream)), &mut buffer, file_len)
            .map_err(|(_, error)| NpzError::of_zip("end of archive", error))?;
        let mut entries: Vec<Entry> = Vec::new();
        let mut by_name = BTreeMap::new();
        let mut records = archive.entries(&mut buffer);
        while let Some(record) = records.next_entry().map_err(|error| NpzError::of_zip(DIRECTORY, error))? {
            let number = entries.len();
            let entry = Entry::of(&record, archive.directory_offset())
                .map_err(|problem| NpzError::corrupt(DIRECTORY, format!("entry {number}: {problem}")))?;
            if by_name.insert(entry.name.clone(), number).is_some() {
                return Err(NpzError::corrupt(DIRECTORY, format!("two members `{}`", entry.name)));
            }
            entries.push(entry);
        }
        if entries.len() as u64 != archive.entries_hint() {
            let problem = format!("{} entries where {} are announced", entries.len(), archive.entries_hint());
            return Err(NpzError::corrupt(DIRECTORY, problem));
        }
        Ok(Self { archive, entries, by_name, max_bytes: DEFAULT_MAX_BYTES })
    }

    /// Changes the size from which arrays are refused, bytes.
    #[must_use]
    pub fn with_max_bytes(self, max_bytes: u64) -> Self {
        Self { max_bytes, ..self }
    }

    /// Names of the members, in the archive's order.
    pub fn members(&self) -> impl ExactSizeIterator<Item = &str> {
        self.entries.iter().map(|entry| entry.name.as_str())
    }

    fn entry(&self, name: &str) -> Result<&Entry, NpzError> {
        match self.by_name.get(name) {
            Some(&index) => Ok(&self.entries[index]),
            None => Err(NpzError::NoMember { member: name.to_owned() }),
        }
    }

    /// Takes one member out without decompressing more than its header: to be appended to another archive.
    /// Its checksum goes with it and is not checked.
    ///
    /// # Errors
    /// As [`NpzReader::read`], as far as sizes and the header show it.
    ///
    /// ```
    /// use std::io::Cursor;
    /// use codecs::{NpzReader, NpzWriter, Scalar, encode_member};
    ///
    /// let mut many = NpzWriter::new(Vec::new());
    /// many.append(encode_member("0007.npy", Scalar::U8, &[3], &[1, 2, 3], 2)?)?;
    /// let packed = NpzReader::new(Cursor::new(many.finish()?))?.read_packed("0007.npy")?;
    /// assert_eq!(packed.shape, [3]);
    /// let mut one = NpzWriter::new(Vec::new());
    /// one.append(packed.member.renamed("data.npy")?)?;
    /// let array = NpzReader::new(Cursor::new(one.finish()?))?.read("data.npy")?;
    /// assert_eq!(array.bytes, [1, 2, 3]);
    /// # Ok::<(), codecs::NpzError>(())
    /// ```
    pub fn read_packed(&mut self, name: &str) -> Result<PackedArray, NpzError> {
        let entry = self.entry(name)?;
        let data = self.packed_bytes(entry)?;
        let header = match entry.method {
            CompressionMethod::STORE => unpack_header(entry, &mut data.as_slice())?,
            CompressionMethod::DEFLATE => unpack_header(entry, &mut DeflateDecoder::new(data.as_slice()))?,
            other => {
                return Err(NpzError::unsupported(name, format!("compression method {}", other.as_u16())));
            }
        };
        let Entry { method, crc, plain_len, .. } = *entry;
        let member = EncodedMember { name: name.to_owned(), method, crc, plain_len, data };
        Ok(PackedArray { dtype: header.dtype, shape: header.shape, member })
    }

    /// Reads one member and checks it against its checksum.
    ///
    /// # Errors
    /// [`NpzError::NoMember`], [`NpzError::TooLarge`], or what is wrong with the member's bytes.
    pub fn read(&mut self, name: &str) -> Result<Array, NpzError> {
        self.read_into(name, Vec::new())
    }

    /// As [`NpzReader::read`], with the memory of an array that is no longer needed: large ones cost as much
    /// to set aside as to read.
    ///
    /// # Errors
    /// As [`NpzReader::read`].
    pub fn read_into(&mut self, name: &str, memory: Vec<u8>) -> Result<Array, NpzError> {
        let entry = self.entry(name)?;
        let packed = self.packed_bytes(entry)?;
        let (array, rest) = match entry.method {
            CompressionMethod::STORE => {
                let mut plain = packed.as_slice();
                (unpack(entry, &mut plain, memory)?, plain)
            }
            CompressionMethod::DEFLATE => {
                let mut plain = DeflateDecoder::new(packed.as_slice());
                (unpack(entry, &mut plain, memory)?, plain.into_inner())
            }
            other => {
                return Err(NpzError::unsupported(name, format!("compression method {}", other.as_u16())));
            }
        };
        if rest.is_empty() { Ok(array) } else { Err(NpzError::corrupt(name, "bytes after the array")) }
    }

    /// The member's bytes as they lie in the archive.
    fn packed_bytes(&self, entry: &Entry) -> Result<Vec<u8>, NpzError> {
        let name = entry.name.as_str();
        if entry.encrypted {
            return Err(NpzError::unsupported(name, "encryption"));
        }
        let most = match entry.method {
            CompressionMethod::STORE => entry.data_len,
            _ => entry.data_len.saturating_mul(MAX_RATIO),
        };
        if entry.plain_len > most {
            let problem = format!("{} bytes cannot come out of {}", entry.plain_len, entry.data_len);
            return Err(NpzError::corrupt(name, problem));
        }
        if entry.plain_len > self.max_bytes {
            let (member, bytes, limit) = (name.to_owned(), entry.plain_len, self.max_bytes);
            return Err(NpzError::TooLarge { member, bytes, limit });
        }
        let data = self.archive.get_entry(entry.place).map_err(|error| NpzError::of_zip(name, error))?;
        if data.compressed_data_range().1 > self.archive.directory_offset() {
            return Err(NpzError::truncated(name, "its data runs into the central directory"));
        }
        let len = usize::try_from(entry.data_len)
            .map_err(|_| NpzError::unsupported(name, "members beyond the address space"))?;
        let mut packed = vec![0; len];
        data.reader().read_exact(&mut packed).map_err(|error| NpzError::of_stream(name, error))?;
        Ok(packed)
    }
}

/// The header before a member's elements.
struct Header {
    dtype: DType,
    shape: Vec<usize>,
    /// Bytes of the elements.
    len: usize,
    /// Checksum of the header.
    crc: crc32fast::Hasher,
}

/// All bytes are in memory: whatever fails, it is they that are wrong.
fn corrupt(name: &str, error: &io::Error) -> NpzError {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => NpzError::corrupt(name, "its data ends early"),
        _ => NpzError::corrupt(name, format!("its data cannot be decompressed: {error}")),
    }
}

/// The header of a member.
fn unpack_header(entry: &Entry, plain: &mut impl Read) -> Result<Header, NpzError> {
    let name = entry.name.as_str();
    let mut prefix = [0; npy::PREFIX_LEN];
    plain.read_exact(&mut prefix).map_err(|e| corrupt(name, &e))?;
    let mut text = vec![0; npy::text_len(name, &prefix)?];
    plain.read_exact(&mut text).map_err(|e| corrupt(name, &e))?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(&prefix);
    crc.update(&text);
    let (dtype, shape) = npy::parse_text(name, &text)?;
    // Equal to the size in the directory, which is within the limits: what is set aside is bounded.
    let len = npy::array_len(&dtype, &shape)
        .filter(|&len| (prefix.len() + text.len()) as u64 + len as u64 == entry.plain_len)
        .ok_or_else(|| {
            NpzError::corrupt(name, format!("shape {shape:?} does not make {} bytes", entry.plain_len))
        })?;
    Ok(Header { dtype, shape, len, crc })
}

/// Header and elements of a member, these in memory that is given.
fn unpack(entry: &Entry, plain: &mut impl Read, memory: Vec<u8>) -> Result<Array, NpzError> {
    let name = entry.name.as_str();
    let Header { dtype, shape, len, mut crc } = unpack_header(entry, plain)?;
    let mut bytes = memory;
    bytes.resize(len, 0);
    plain.read_exact(&mut bytes).map_err(|e| corrupt(name, &e))?;
    // The end-of-block code may still be unread.
    if plain.read(&mut [0]).map_err(|e| corrupt(name, &e))? != 0 {
        return Err(NpzError::corrupt(name, "bytes after the array"));
    }
    crc.update(&bytes);
    let computed = crc.finalize();
    if computed != entry.crc {
        return Err(NpzError::Checksum { member: name.to_owned(), stored: entry.crc, computed });
    }
    Ok(Array { dtype, shape, bytes })
}
