//! Members to an archive.

use std::collections::BTreeSet;
use std::io::Write;

use super::encode::EncodedMember;
use super::zip::{self, Record};
use crate::error::NpzError;

/// Version of the format that a plain archive needs.
const VERSION: u16 = 20;
/// Version that 64-bit sizes need.
const VERSION64: u16 = 45;
/// Made on Unix, so that the attributes are a Unix mode.
const MADE_BY_UNIX: u16 = 3 << 8;
/// A plain file, readable by all.
const UNIX_MODE: u32 = 0o100_644 << 16;

/// Writes a numpy archive to a stream, front to back, without seeking.
///
/// Sizes and checksums stand before each member's data. Members and archives beyond 4 GiB or 65,535 members
/// get 64-bit records.
#[derive(Debug)]
pub struct NpzWriter<W: Write> {
    stream: W,
    /// Bytes written.
    at: u64,
    /// Central directory, made while members are appended.
    directory: Vec<u8>,
    names: BTreeSet<String>,
    /// Sizes and offsets from here on need 64-bit records.
    limit32: u64,
    /// Numbers of members from here on need 64-bit records.
    limit16: u64,
}

impl<W: Write> NpzWriter<W> {
    /// Starts an archive. The stream should be buffered.
    pub fn new(stream: W) -> Self {
        let (limit32, limit16) = (u64::from(u32::MAX), u64::from(u16::MAX));
        Self { stream, at: 0, directory: Vec::new(), names: BTreeSet::new(), limit32, limit16 }
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
        let data_len = data.len() as u64;
        let offset = self.at;
        let large_sizes = plain_len >= self.limit32 || data_len >= self.limit32;
        let large_offset = offset >= self.limit32;
        // In the extra field only the numbers that don't fit, in this order; a local header has both sizes.
        let mut numbers = Vec::new();
        if large_sizes {
            numbers.extend([plain_len, data_len]);
        }
        let local_extra = extra64(&numbers);
        if large_offset {
            numbers.push(offset);
        }
        let central_extra = extra64(&numbers);
        let size32 = |size: u64| if large_sizes { u32::MAX } else { size as u32 };
        let version = |large: bool| if large { VERSION64 } else { VERSION };
        // From the flags to the length of the name the two headers agree.
        let common = Record::default()
            .u16(0)
            .u16(method)
            .u16(0)
            .u16(zip::DATE)
            .u32(crc)
            .u32(size32(data_len))
            .u32(size32(plain_len))
            .u16(name.len() as u16)
            .0;

        let local = Record::default()
            .u32(zip::LOCAL)
            .u16(version(large_sizes))
            .bytes(&common)
            .u16(local_extra.len() as u16)
            .bytes(name.as_bytes())
            .bytes(&local_extra)
            .0;
        let central = Record::default()
            .u32(zip::CENTRAL)
            .u16(MADE_BY_UNIX | VERSION64)
            .u16(version(large_sizes || large_offset))
            .bytes(&common)
            .u16(central_extra.len() as u16)
            .u16(0)
            .u16(0)
            .u16(0)
            .u32(UNIX_MODE)
            .u32(if large_offset { u32::MAX } else { offset as u32 })
            .bytes(name.as_bytes())
            .bytes(&central_extra)
            .0;

        self.put(&local)?;
        self.put(&data)?;
        self.directory.extend_from_slice(&central);
        self.names.insert(name);
        Ok(())
    }

    /// Ends the archive, flushes the stream and gives it back.
    ///
    /// # Errors
    /// [`NpzError::Io`] from the stream.
    pub fn finish(mut self) -> Result<W, NpzError> {
        let (count, start, len) = (self.names.len() as u64, self.at, self.directory.len() as u64);
        let directory = std::mem::take(&mut self.directory);
        self.put(&directory)?;
        let large_count = count >= self.limit16;
        let (large_start, large_len) = (start >= self.limit32, len >= self.limit32);
        if large_count || large_start || large_len {
            let end64_at = self.at;
            let record = Record::default()
                .u32(zip::END64)
                .u64(zip::END64_LEN as u64 - 12)
                .u16(MADE_BY_UNIX | VERSION64)
                .u16(VERSION64)
                .u32(0)
                .u32(0)
                .u64(count)
                .u64(count)
                .u64(len)
                .u64(start)
                .u32(zip::LOCATOR64)
                .u32(0)
                .u64(end64_at)
                .u32(1)
                .0;
            self.put(&record)?;
        }
        let count16 = if large_count { u16::MAX } else { count as u16 };
        let end = Record::default()
            .u32(zip::END)
            .u16(0)
            .u16(0)
            .u16(count16)
            .u16(count16)
            .u32(if large_len { u32::MAX } else { len as u32 })
            .u32(if large_start { u32::MAX } else { start as u32 })
            .u16(0)
            .0;
        self.put(&end)?;
        self.stream.flush()?;
        Ok(self.stream)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), NpzError> {
        self.stream.write_all(bytes)?;
        self.at += bytes.len() as u64;
        Ok(())
    }
}

/// The extra field with 64-bit numbers, empty without any.
fn extra64(numbers: &[u64]) -> Vec<u8> {
    if numbers.is_empty() {
        return Vec::new();
    }
    let record = Record::default().u16(zip::EXTRA64).u16(8 * numbers.len() as u16);
    numbers.iter().fold(record, |record, &n| record.u64(n)).0
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::{DEFAULT_LEVEL, NpzReader, Scalar, encode_member, frame_member};

    /// Archives too large for a test: the limits are moved instead.
    fn archive_with_limits(limit32: u64, limit16: u64) -> Vec<u8> {
        let mut writer = NpzWriter { limit32, limit16, ..NpzWriter::new(Vec::new()) };
        for k in 0..5_u8 {
            let level = if k % 2 == 0 { DEFAULT_LEVEL } else { 0 };
            let member = encode_member(&frame_member(k.into()), Scalar::U8, &[300], &[k; 300], level);
            writer.append(member.expect("valid")).expect("no faults in memory");
        }
        writer.finish().expect("no faults in memory")
    }

    #[test]
    fn records_of_64_bits_say_the_same() {
        let plain = archive_with_limits(u64::from(u32::MAX), u64::from(u16::MAX));
        // Every number 64-bit; offsets of the later members alone; the count alone.
        for (limit32, limit16) in [(0, 0), (400, 65_535), (1 << 32, 3)] {
            let large = archive_with_limits(limit32, limit16);
            assert!(large.len() > plain.len());
            let mut reader = NpzReader::new(Cursor::new(large)).expect("readable");
            assert_eq!(reader.members().count(), 5);
            for k in 0..5_u8 {
                assert_eq!(reader.read(&frame_member(k.into())).expect("readable").bytes, [k; 300]);
            }
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
