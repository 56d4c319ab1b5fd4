//! Single members out of an archive.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

use flate2::{Decompress, FlushDecompress, Status};

use super::zip::{self, Fields};
use crate::error::NpzError;
use crate::npy::{self, Array};

/// Arrays beyond this many bytes are refused unless the reader is told otherwise (1 GiB).
pub const DEFAULT_MAX_BYTES: u64 = 1 << 30;

/// DEFLATE cannot shrink further: 258 bytes in 2 bits, and a small block around them. A member that claims
/// more is refused before memory is set aside for it.
const MAX_RATIO: u64 = 1040;
/// Longest comment at the end of a zip file.
const MAX_COMMENT: usize = u16::MAX as usize;
const DIRECTORY: &str = "central directory";
const END_RECORD: &str = "end of archive";

/// Reads members of a numpy archive one by one; the rest of the archive is not touched.
///
/// Anything may be wrong with the archive: the answer is an error, and memory stays within the size of
/// the archive plus [`NpzReader::with_max_bytes`].
#[derive(Debug)]
pub struct NpzReader<R> {
    stream: R,
    entries: Vec<Entry>,
    by_name: BTreeMap<String, usize>,
    /// Where the central directory starts: members end before it.
    data_end: u64,
    max_bytes: u64,
}

#[derive(Clone, Debug)]
struct Entry {
    name: String,
    flags: u16,
    method: u16,
    crc: u32,
    data_len: u64,
    plain_len: u64,
    offset: u64,
}

/// What the last record says about the directory.
struct Directory {
    start: u64,
    len: u64,
    count: u64,
}

impl<R: Read + Seek> NpzReader<R> {
    /// Opens an archive and reads its directory.
    ///
    /// # Errors
    /// [`NpzError::Truncated`] when there is no directory at the end, [`NpzError::Corrupt`] when it makes no
    /// sense, [`NpzError::Io`] from the stream.
    pub fn new(mut stream: R) -> Result<Self, NpzError> {
        let file_len = stream.seek(SeekFrom::End(0))?;
        let directory = find_directory(&mut stream, file_len)?;
        let mut bytes = vec![0; usize::try_from(directory.len).map_err(|_| too_large(&directory))?];
        read_at(&mut stream, directory.start, &mut bytes, DIRECTORY)?;
        let mut fields = Fields(&bytes);
        let mut entries = Vec::new();
        while !fields.0.is_empty() {
            let number = entries.len();
            entries.push(
                read_entry(&mut fields, directory.start)
                    .map_err(|problem| NpzError::corrupt(DIRECTORY, format!("entry {number}: {problem}")))?,
            );
        }
        if entries.len() as u64 != directory.count {
            let problem = format!("{} entries where {} are announced", entries.len(), directory.count);
            return Err(NpzError::corrupt(DIRECTORY, problem));
        }
        let mut by_name = BTreeMap::new();
        for (i, entry) in entries.iter().enumerate() {
            if by_name.insert(entry.name.clone(), i).is_some() {
                return Err(NpzError::corrupt(DIRECTORY, format!("two members `{}`", entry.name)));
            }
        }
        Ok(Self { stream, entries, by_name, data_end: directory.start, max_bytes: DEFAULT_MAX_BYTES })
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

    /// Reads one member and checks it against its checksum.
    ///
    /// # Errors
    /// [`NpzError::NoMember`], [`NpzError::TooLarge`], or what is wrong with the member's bytes.
    pub fn read(&mut self, name: &str) -> Result<Array, NpzError> {
        let Some(&index) = self.by_name.get(name) else {
            return Err(NpzError::NoMember { member: name.to_owned() });
        };
        let entry = self.entries[index].clone();
        let packed = self.packed_bytes(&entry)?;
        match entry.method {
            zip::STORED => unpack(&entry, &mut Stored(&packed)),
            zip::DEFLATED => unpack(&entry, &mut Deflated::new(&packed)),
            other => Err(NpzError::unsupported(name, format!("compression method {other}"))),
        }
    }

    /// The member's bytes as they lie in the archive.
    fn packed_bytes(&mut self, entry: &Entry) -> Result<Vec<u8>, NpzError> {
        let name = entry.name.as_str();
        // Bits 0, 6 and 13 say encrypted in one way or another.
        if entry.flags & 0b0010_0000_0100_0001 != 0 {
            return Err(NpzError::unsupported(name, "encryption"));
        }
        let most = match entry.method {
            zip::STORED => entry.data_len,
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
        let mut local = [0; zip::LOCAL_LEN];
        read_at(&mut self.stream, entry.offset, &mut local, name)?;
        let mut fields = Fields(&local);
        if fields.u32() != Some(zip::LOCAL) {
            return Err(NpzError::corrupt(name, "wrong magic: no member starts where the directory says"));
        }
        // Sizes are the directory's; the lengths of name and extra field may differ from it.
        fields.bytes(22);
        let variable = u64::from(fields.u16().unwrap_or(0)) + u64::from(fields.u16().unwrap_or(0));
        let start = entry.offset.saturating_add(zip::LOCAL_LEN as u64 + variable);
        if start.saturating_add(entry.data_len) > self.data_end {
            return Err(NpzError::truncated(name, "its data runs into the central directory"));
        }
        let len = usize::try_from(entry.data_len)
            .map_err(|_| NpzError::unsupported(name, "members beyond the address space"))?;
        let mut packed = vec![0; len];
        read_at(&mut self.stream, start, &mut packed, name)?;
        Ok(packed)
    }
}

fn too_large(directory: &Directory) -> NpzError {
    NpzError::unsupported(DIRECTORY, format!("a directory of {} bytes", directory.len))
}

/// Fills `buffer` from a place in the stream.
fn read_at(stream: &mut (impl Read + Seek), at: u64, buffer: &mut [u8], place: &str) -> Result<(), NpzError> {
    stream.seek(SeekFrom::Start(at))?;
    stream.read_exact(buffer).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => NpzError::truncated(place, "the archive ends within it"),
        _ => NpzError::Io(error),
    })
}

/// Finds the last record and what it says about the directory.
fn find_directory(stream: &mut (impl Read + Seek), file_len: u64) -> Result<Directory, NpzError> {
    let tail_len = file_len.min((zip::END_LEN + MAX_COMMENT) as u64);
    let tail_at = file_len - tail_len;
    let mut tail = vec![0; tail_len as usize];
    read_at(stream, tail_at, &mut tail, END_RECORD)?;
    // The record whose comment ends exactly at the end of the file, nearest to it.
    let is_end = |at: &usize| {
        let mut fields = Fields(&tail[*at..]);
        let magic = fields.u32();
        let comment = fields.bytes(16).and_then(|_| fields.u16());
        magic == Some(zip::END)
            && comment.is_some_and(|len| at + zip::END_LEN + usize::from(len) == tail.len())
    };
    let Some(end) = (0..(tail.len() + 1).saturating_sub(zip::END_LEN)).rev().find(is_end) else {
        return Err(match tail.get(..4) {
            Some(magic) if tail_at == 0 && magic != zip::LOCAL.to_le_bytes() => {
                NpzError::corrupt("archive", "wrong magic: this is no zip file")
            }
            _ => NpzError::truncated(END_RECORD, "no record with the central directory's place"),
        });
    };
    let end_at = tail_at + end as u64;
    let missing = || NpzError::truncated(END_RECORD, "the record is incomplete");
    let mut fields = Fields(&tail[end + 4..]);
    let mut next16 = || fields.u16().ok_or_else(missing);
    let (disk, start_disk, here, count) = (next16()?, next16()?, next16()?, next16()?);
    let (len, start) = (fields.u32().ok_or_else(missing)?, fields.u32().ok_or_else(missing)?);
    let directory = match read_end64(stream, end_at)? {
        Some(directory) => directory,
        None if disk != 0 || start_disk != 0 || here != count => {
            return Err(NpzError::unsupported(END_RECORD, "an archive in several volumes"));
        }
        None => Directory { start: start.into(), len: len.into(), count: count.into() },
    };
    if directory.start.checked_add(directory.len).is_none_or(|directory_end| directory_end > end_at) {
        return Err(NpzError::truncated(DIRECTORY, "it does not end before the end record"));
    }
    Ok(directory)
}

/// The 64-bit end record, if there is a locator for it.
fn read_end64(stream: &mut (impl Read + Seek), end_at: u64) -> Result<Option<Directory>, NpzError> {
    let Some(locator_at) = end_at.checked_sub(zip::LOCATOR64_LEN as u64) else { return Ok(None) };
    let mut locator = [0; zip::LOCATOR64_LEN];
    read_at(stream, locator_at, &mut locator, END_RECORD)?;
    let mut fields = Fields(&locator);
    if fields.u32() != Some(zip::LOCATOR64) {
        return Ok(None);
    }
    let missing = || NpzError::corrupt(END_RECORD, "the 64-bit end record is not where its locator says");
    fields.bytes(4);
    let end64_at = fields.u64().ok_or_else(missing)?;
    if end64_at.checked_add(zip::END64_LEN as u64).is_none_or(|end64_end| end64_end > locator_at) {
        return Err(missing());
    }
    let mut record = [0; zip::END64_LEN];
    read_at(stream, end64_at, &mut record, END_RECORD)?;
    let mut fields = Fields(&record);
    if fields.u32() != Some(zip::END64) {
        return Err(missing());
    }
    // Length of the record, versions, disks; then the number of entries on this disk and in all.
    fields.bytes(28);
    let mut next = || fields.u64().ok_or_else(missing);
    let (count, len, start) = (next()?, next()?, next()?);
    Ok(Some(Directory { start, len, count }))
}

/// Reads one entry of the central directory, which starts at `data_end`.
fn read_entry(fields: &mut Fields<'_>, data_end: u64) -> Result<Entry, String> {
    let cut = || "it runs out of the directory".to_owned();
    if fields.u32().ok_or_else(cut)? != zip::CENTRAL {
        return Err("wrong magic".into());
    }
    let mut fixed = Fields(fields.bytes(zip::CENTRAL_LEN - 4).ok_or_else(cut)?);
    fixed.bytes(4);
    let mut next16 = || fixed.u16().ok_or_else(cut);
    let (flags, method, _time, _date) = (next16()?, next16()?, next16()?, next16()?);
    let mut next32 = || fixed.u32().ok_or_else(cut);
    let (crc, data_len, plain_len) = (next32()?, next32()?, next32()?);
    let mut next16 = || fixed.u16().ok_or_else(cut);
    let (name_len, extra_len, comment_len) = (next16()?, next16()?, next16()?);
    fixed.bytes(8);
    let offset = fixed.u32().ok_or_else(cut)?;
    let name = fields.bytes(name_len.into()).ok_or_else(cut)?;
    let mut extra = Fields(fields.bytes(extra_len.into()).ok_or_else(cut)?);
    fields.bytes(comment_len.into()).ok_or_else(cut)?;

    let name = std::str::from_utf8(name).map_err(|_| "its name is not UTF-8".to_owned())?.to_owned();
    let mut large = find_extra64(&mut extra);
    let mut widen = |value: u32| match value {
        u32::MAX => large.u64().ok_or_else(|| format!("`{name}` lacks its 64-bit sizes")),
        _ => Ok(u64::from(value)),
    };
    let (plain_len, data_len, offset) = (widen(plain_len)?, widen(data_len)?, widen(offset)?);
    // Nothing that memory is set aside for may be larger than the file.
    if offset.checked_add(data_len).is_none_or(|end| end > data_end) {
        return Err(format!("`{name}` lies beyond the members"));
    }
    Ok(Entry { name, flags, method, crc, data_len, plain_len, offset })
}

/// The body of the extra field with 64-bit numbers, empty without one.
fn find_extra64<'a>(extra: &mut Fields<'a>) -> Fields<'a> {
    while let (Some(id), Some(len)) = (extra.u16(), extra.u16()) {
        let Some(body) = extra.bytes(len.into()) else { break };
        if id == zip::EXTRA64 {
            return Fields(body);
        }
    }
    Fields(&[])
}

/// Where a member's plain bytes come from.
trait Plain {
    /// Fills the buffer; `Err` says why it cannot.
    fn fill(&mut self, buffer: &mut [u8]) -> Result<(), String>;
    /// Nothing is left over.
    fn end(&mut self) -> Result<(), String>;
}

struct Stored<'a>(&'a [u8]);

impl Plain for Stored<'_> {
    fn fill(&mut self, buffer: &mut [u8]) -> Result<(), String> {
        let (head, rest) = self.0.split_at_checked(buffer.len()).ok_or("its data ends early")?;
        buffer.copy_from_slice(head);
        self.0 = rest;
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        if self.0.is_empty() { Ok(()) } else { Err("bytes after the array".into()) }
    }
}

struct Deflated<'a> {
    packed: &'a [u8],
    state: Decompress,
    ended: bool,
}

impl<'a> Deflated<'a> {
    fn new(packed: &'a [u8]) -> Self {
        Self { packed, state: Decompress::new(false), ended: false }
    }

    /// Inflates once and says how many bytes came out.
    fn step(&mut self, buffer: &mut [u8]) -> Result<usize, String> {
        let (in_before, out_before) = (self.state.total_in(), self.state.total_out());
        let status = self
            .state
            .decompress(self.packed, buffer, FlushDecompress::None)
            .map_err(|error| format!("its data cannot be decompressed: {error}"))?;
        self.packed = &self.packed[(self.state.total_in() - in_before) as usize..];
        self.ended = status == Status::StreamEnd;
        Ok((self.state.total_out() - out_before) as usize)
    }
}

impl Plain for Deflated<'_> {
    fn fill(&mut self, buffer: &mut [u8]) -> Result<(), String> {
        let mut filled = 0;
        while filled < buffer.len() {
            let made = if self.ended { 0 } else { self.step(&mut buffer[filled..])? };
            if made == 0 {
                return Err("its data ends early".into());
            }
            filled += made;
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        // The end-of-block code may still be unread.
        if !self.ended && self.step(&mut [0])? != 0 {
            return Err("bytes after the array".into());
        }
        match (self.ended, self.packed.is_empty()) {
            (true, true) => Ok(()),
            (true, false) => Err("bytes after the compressed data".into()),
            (false, _) => Err("its compressed data has no end".into()),
        }
    }
}

/// Header and elements of a member.
fn unpack(entry: &Entry, plain: &mut impl Plain) -> Result<Array, NpzError> {
    let name = entry.name.as_str();
    let corrupt = |problem: String| NpzError::corrupt(name, problem);
    let mut prefix = [0; npy::PREFIX_LEN];
    plain.fill(&mut prefix).map_err(corrupt)?;
    let mut text = vec![0; npy::text_len(name, &prefix)?];
    plain.fill(&mut text).map_err(corrupt)?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(&prefix);
    crc.update(&text);
    let (dtype, shape) = npy::parse_text(name, &text)?;
    // Equal to the size in the directory, which is within the limits: what is set aside is bounded.
    let len = npy::array_len(&dtype, &shape)
        .filter(|&len| (prefix.len() + text.len()) as u64 + len as u64 == entry.plain_len)
        .ok_or_else(|| corrupt(format!("shape {shape:?} does not make {} bytes", entry.plain_len)))?;
    let mut bytes = vec![0; len];
    plain.fill(&mut bytes).map_err(corrupt)?;
    plain.end().map_err(corrupt)?;
    crc.update(&bytes);
    let computed = crc.finalize();
    if computed != entry.crc {
        return Err(NpzError::Checksum { member: name.to_owned(), stored: entry.crc, computed });
    }
    Ok(Array { dtype, shape, bytes })
}
