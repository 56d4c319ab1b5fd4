//! Members to an archive.

use std::collections::BTreeSet;
use std::io::Write;

use rawzip::path::EntryPath;
use rawzip::{DataDescriptorOutput, ZipArchiveWriter};

use super::encode::EncodedMember;
use crate::error::NpzError;

/// A plain file, readable by all.
const UNIX_MODE: u32 = 0o100_644;

/// Writes a numpy archive to a stream, front to back, without seeking.
///
/// Members and archives beyond 4 GiB or 65,535 members get 64-bit records. Members have no time, so that bytes
/// depend on data alone.
///
/// ```
/// use formats::{DEFAULT_LEVEL, NpzWriter, Scalar, encode_member, frame_member};
///
/// let mut writer = NpzWriter::new(Vec::new());
/// writer.append(encode_member(&frame_member(7), Scalar::U8, &[2], &[1, 2], DEFAULT_LEVEL)?)?;
/// let archive = writer.finish()?;
/// assert!(archive.starts_with(b"PK"));
/// # Ok::<(), formats::NpzError>(())
/// ```
// `rawzip` rather than `zip`: it takes members that are compressed already, as those are that were encoded on all
// threads, writes to a stream that cannot seek, and has no dependencies.
#[derive(Debug)]
pub struct NpzWriter<W: Write> {
    archive: ZipArchiveWriter<W>,
    names: BTreeSet<String>,
}

impl<W: Write> NpzWriter<W> {
    /// Starts an archive. The stream should be buffered.
    pub fn new(stream: W) -> Self {
        Self { archive: ZipArchiveWriter::new(stream), names: BTreeSet::new() }
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
        self.archive.finish().map_err(|error| NpzError::of_zip("central directory", error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scalar, encode_member};

    #[test]
    fn names_are_used_once() {
        let mut writer = NpzWriter::new(Vec::new());
        let member = encode_member("a.npy", Scalar::U8, &[1], &[0], 0).expect("valid");
        writer.append(member.clone()).expect("new");
        let error = writer.append(member).expect_err("used").to_string();
        assert_eq!(error, "a.npy: cannot be written: the archive has a member of that name already");
    }
}
