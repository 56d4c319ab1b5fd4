//! Messages that are kept together.

use std::collections::BTreeMap;
use std::io;

use super::record::{opcode, put_u16, put_u32, put_u64};

/// Bytes of a message record before the message itself, from the record's first byte.
pub(super) const MESSAGE_HEAD: usize = 9 + 2 + 4 + 8 + 8;
/// Levels above gain a percent and cost a multiple.
const ZSTD_LEVEL: i32 = 1;

/// How a chunk is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compression {
    /// As it is: what is compressed already.
    None,
    /// Zstandard.
    Zstd,
}

impl Compression {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Zstd => "zstd",
        }
    }
}

/// Messages that are kept together.
#[derive(Debug, Default)]
pub(crate) struct Messages {
    records: Vec<u8>,
    /// Of each channel time and place of its messages.
    index: BTreeMap<u16, Vec<(u64, u64)>>,
}

impl Messages {
    /// Adds a message of a channel, which `encode` appends to what it is handed.
    pub(crate) fn add(
        &mut self,
        channel: u16,
        sequence: u32,
        time_ns: u64,
        encode: impl FnOnce(&mut Vec<u8>),
    ) {
        let start = self.records.len();
        self.records.push(opcode::MESSAGE);
        self.records.extend_from_slice(&[0; 8]);
        put_u16(&mut self.records, channel);
        put_u32(&mut self.records, sequence);
        put_u64(&mut self.records, time_ns);
        put_u64(&mut self.records, time_ns);
        debug_assert_eq!(self.records.len() - start, MESSAGE_HEAD);
        encode(&mut self.records);
        let length = (self.records.len() - start - 9) as u64;
        self.records[start + 1..start + 9].copy_from_slice(&length.to_le_bytes());
        self.index.entry(channel).or_default().push((time_ns, start as u64));
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Closes them into a chunk.
    ///
    /// # Errors
    /// The compressor fails.
    pub(crate) fn into_chunk(self, compression: Compression) -> io::Result<Chunk> {
        let Self { records, index } = self;
        let crc = crc32fast::hash(&records);
        let plain_bytes = records.len() as u64;
        let packed = match compression {
            Compression::None => records,
            Compression::Zstd => zstd::bulk::compress(&records, ZSTD_LEVEL)?,
        };
        let times = || index.values().flatten().map(|(time, _)| *time);
        let (first, last) = (times().min().unwrap_or(0), times().max().unwrap_or(0));
        Ok(Chunk { first, last, plain_bytes, crc, compression, packed, index })
    }
}

/// A finished chunk.
#[derive(Debug)]
pub(crate) struct Chunk {
    /// Times of the first and the last message.
    pub(super) first: u64,
    pub(super) last: u64,
    pub(super) plain_bytes: u64,
    pub(super) crc: u32,
    pub(super) compression: Compression,
    pub(super) packed: Vec<u8>,
    pub(super) index: BTreeMap<u16, Vec<(u64, u64)>>,
}
