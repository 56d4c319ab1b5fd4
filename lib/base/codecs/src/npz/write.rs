//! Members to an archive.

use std::collections::BTreeSet;
use std::io::{self, Write};

use rawzip::path::EntryPath;
use rawzip::{DataDescriptorOutput, ZipArchiveWriter};

use super::encode::EncodedMember;
use crate::error::NpzError;

/// A plain file, readable by all.
const UNIX_MODE: u32 = 0o100_644;

/// Writes a numpy archive to a stream, front to back, without seeking.
///
/// Members and archives beyond 4 GiB or 65,535 members get 64-bit records. Members have no time, so that
/// bytes depend on data alone.
///
/// ```
/// use codecs::{DEFAULT_LEVEL, NpzWriter, Scalar, encode_member, frame_member};
///
/// let mut writer = NpzWriter::new(Vec::new());
/// writer.append(encode_member(&frame_member(7), Scalar::U8, &[2], &[1, 2], DEFAULT_LEVEL)?)?;
/// let archive = writer.finish()?;
/// assert!(archive.starts_with(b"PK"));
/// # Ok::<(), codecs::NpzError>(())
/// ```
// `rawzip` rather than `zip`: it takes members that are compressed already, as those are that were encoded on
// all threads, writes to a stream that cannot seek, and has no dependencies.
#[derive(Debug)]
pub struct NpzWriter<W: Write> {
    archive: ZipArchiveWriter<Tail<W>>,
    names: BTreeSet<String>,
    comment: String,
}

impl<W: Write> NpzWriter<W> {
    /// Starts an archive. The stream should be buffered.
    pub fn new(stream: W) -> Self {
        let archive = ZipArchiveWriter::new(Tail { stream, held: Vec::new() });
        Self { archive, names: BTreeSet::new(), comment: String::new() }
    }

    /// Gives the archive a comment: what it says of itself. `zipfile.ZipFile(...).comment` shows it, numpy
    /// passes over it.
    ///
    /// # Errors
    /// [`NpzError::Invalid`] when it is longer than 65,535 bytes.
    pub fn set_comment(&mut self, comment: &str) -> Result<(), NpzError> {
        if u16::try_from(comment.len()).is_err() {
            return Err(NpzError::invalid("comment", "it is longer than 65,535 bytes"));
        }
        comment.clone_into(&mut self.comment);
        Ok(())
    }

    /// Appends a member.
    ///
    /// # Errors
    /// [`NpzError::Invalid`] when there is a member of that name already, [`NpzError::Io`] from the stream
    /// (the archive is then of no use).
    pub fn append(&mut self, member: EncodedMember) -> Result<(), NpzError> {
        let EncodedMember { name, method, crc, plain_len, data } = member;
        if self.names.contains(&name) {
            return Err(NpzError::invalid(&name, "the archive has a member of that name already"));
        }
        let in_zip = |error| NpzError::of_zip(&name, error);
        let path = EntryPath::verbatim(name.as_bytes());
        let file = self.archive.new_file(path).compression_method(method).unix_permissions(UNIX_MODE);
        let (mut entry, _) = file.start().map_err(in_zip)?;
        entry.write_all(&data)?;
        entry.finish(DataDescriptorOutput::new(crc, plain_len)).map_err(in_zip)?;
        self.names.insert(name);
        Ok(())
    }

    /// Ends the archive, flushes the stream and gives it back.
    ///
    /// # Errors
    /// [`NpzError::Io`] from the stream.
    pub fn finish(self) -> Result<W, NpzError> {
        let tail = self.archive.finish().map_err(|error| NpzError::of_zip("central directory", error))?;
        let mut stream = tail.stream;
        // `set_comment` has seen to it that the length fits.
        stream.write_all(&(self.comment.len() as u16).to_le_bytes())?;
        stream.write_all(self.comment.as_bytes())?;
        stream.flush()?;
        Ok(stream)
    }
}

/// An archive of one member, in memory.
///
/// # Errors
/// The container refuses it.
pub fn archive_of(member: EncodedMember) -> Result<Vec<u8>, NpzError> {
    // Records of the container: some 200 bytes with such names.
    let mut writer = NpzWriter::new(Vec::with_capacity(member.compressed_len() + 512));
    writer.append(member)?;
    writer.finish()
}

/// Holds back the last two bytes of what is written: of an archive they are the length of its comment, for
/// which `rawzip` writes 0.
#[derive(Debug)]
struct Tail<W> {
    stream: W,
    held: Vec<u8>,
}

impl<W: Write> Write for Tail<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let kept = bytes.len().min(2);
        let (front, back) = bytes.split_at(bytes.len() - kept);
        let leaves = (self.held.len() + kept).saturating_sub(2);
        self.stream.write_all(&self.held[..leaves])?;
        self.held.drain(..leaves);
        self.stream.write_all(front)?;
        self.held.extend_from_slice(back);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NpzReader, Scalar, encode_member};

    #[test]
    fn an_archive_ends_with_its_comment() {
        let archive = |comment: &str| {
            let mut writer = NpzWriter::new(Vec::new());
            writer.append(encode_member("a.npy", Scalar::U8, &[1], &[7], 0).expect("valid")).expect("new");
            writer.set_comment(comment).expect("is short");
            writer.finish().expect("memory")
        };
        let (plain, told) = (archive(""), archive("{\"a\": 1}"));
        // The end record: its length is the last thing before the comment.
        assert_eq!(&plain[plain.len() - 22..][..4], b"PK\x05\x06");
        assert_eq!(plain[..plain.len() - 2], told[..plain.len() - 2]);
        assert_eq!(told[plain.len() - 2..], *b"\x08\0{\"a\": 1}");
        let mut reader = NpzReader::new(std::io::Cursor::new(told)).expect("is an archive");
        assert_eq!(reader.read("a.npy").expect("reads").bytes, [7]);
        let long = "x".repeat(65_536);
        assert!(NpzWriter::new(Vec::new()).set_comment(&long).is_err());
    }

    #[test]
    fn bytes_pass_in_any_portions() {
        for size in 1..7 {
            let bytes: Vec<u8> = (0..20).collect();
            let mut tail = Tail { stream: Vec::new(), held: Vec::new() };
            bytes.chunks(size).for_each(|part| tail.write_all(part).expect("memory"));
            assert_eq!((tail.stream.as_slice(), tail.held.as_slice()), bytes.split_at(18));
        }
    }

    #[test]
    fn names_are_used_once() {
        let mut writer = NpzWriter::new(Vec::new());
        let member = encode_member("a.npy", Scalar::U8, &[1], &[0], 0).expect("valid");
        writer.append(member.clone()).expect("new");
        let error = writer.append(member).expect_err("used").to_string();
        assert_eq!(error, "a.npy: cannot be written: the archive has a member of that name already");
    }
}
