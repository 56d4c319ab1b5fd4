//! MCAP files (mcap.dev/spec), as far as they are written here: schemas and channels first, then chunks with an index each, a
//! summary at the end.
//!
//! By hand: the format is a list of records with lengths. So a chunk is made by whoever has its messages, on any thread, and
//! the file holds no clock, no version of a library, and no order but ours.

use std::collections::BTreeMap;
use std::io::{self, Write};

const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

mod opcode {
    pub(crate) const HEADER: u8 = 0x01;
    pub(crate) const FOOTER: u8 = 0x02;
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const MESSAGE_INDEX: u8 = 0x07;
    pub(crate) const CHUNK_INDEX: u8 = 0x08;
    pub(crate) const ATTACHMENT: u8 = 0x09;
    pub(crate) const ATTACHMENT_INDEX: u8 = 0x0a;
    pub(crate) const STATISTICS: u8 = 0x0b;
    pub(crate) const METADATA: u8 = 0x0c;
    pub(crate) const METADATA_INDEX: u8 = 0x0d;
    pub(crate) const SUMMARY_OFFSET: u8 = 0x0e;
    pub(crate) const DATA_END: u8 = 0x0f;
}

/// Bytes of a message record before the message itself, from the record's first byte.
const MESSAGE_HEAD: usize = 9 + 2 + 4 + 8 + 8;
/// Levels above gain a percent and cost a multiple.
const ZSTD_LEVEL: i32 = 1;

/// A schema: its number is its place in the list, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Schema {
    /// `foxglove.PointCloud`.
    pub(crate) name: String,
    /// A `FileDescriptorSet`.
    pub(crate) descriptor: Vec<u8>,
}

/// A channel: its number is its place in the list, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Channel {
    /// Number of its schema.
    pub(crate) schema: u16,
    /// `/vehicle_0/LIDAR`.
    pub(crate) topic: String,
    /// What it says of itself.
    pub(crate) metadata: BTreeMap<String, String>,
}

/// How a chunk is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compression {
    /// As it is: what is compressed already.
    None,
    /// Zstandard.
    Zstd,
}

impl Compression {
    fn name(self) -> &'static str {
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
    first: u64,
    last: u64,
    plain_bytes: u64,
    crc: u32,
    compression: Compression,
    packed: Vec<u8>,
    index: BTreeMap<u16, Vec<(u64, u64)>>,
}

/// A file in hand.
pub(crate) struct McapWriter<W> {
    out: W,
    at: u64,
    crc: crc32fast::Hasher,
    schemas: Vec<u8>,
    schema_count: u16,
    channels: Vec<u8>,
    channel_count: u32,
    chunk_index: Vec<u8>,
    chunk_count: u32,
    attachment_index: Vec<u8>,
    attachment_count: u32,
    metadata_index: Vec<u8>,
    metadata_count: u32,
    counts: BTreeMap<u16, u64>,
    times: Option<(u64, u64)>,
}

impl<W: Write> McapWriter<W> {
    /// Starts a file with all its schemas and channels; `library` says who wrote it.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn new(out: W, library: &str, schemas: &[Schema], channels: &[Channel]) -> io::Result<Self> {
        let mut writer = Self {
            out,
            at: 0,
            crc: crc32fast::Hasher::new(),
            schemas: Vec::new(),
            schema_count: 0,
            channels: Vec::new(),
            channel_count: 0,
            chunk_index: Vec::new(),
            chunk_count: 0,
            attachment_index: Vec::new(),
            attachment_count: 0,
            metadata_index: Vec::new(),
            metadata_count: 0,
            counts: BTreeMap::new(),
            times: None,
        };
        writer.write(&MAGIC)?;
        let mut header = Vec::new();
        put_text(&mut header, "");
        put_text(&mut header, library);
        writer.write(&record(opcode::HEADER, &header))?;
        for schema in schemas {
            writer.schema_count += 1;
            let schema = schema_record(writer.schema_count, schema);
            writer.schemas.extend(schema);
        }
        for channel in channels {
            writer.channel_count += 1;
            let channel = channel_record(writer.channel_count as u16, channel);
            writer.channels.extend(channel);
        }
        let known = [writer.schemas.as_slice(), &writer.channels].concat();
        writer.write(&known)?;
        Ok(writer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.crc.update(bytes);
        self.at += bytes.len() as u64;
        Ok(())
    }

    /// Writes facts about the file under a name.
    ///
    /// # Errors
    /// They cannot be written.
    pub(crate) fn metadata(&mut self, name: &str, facts: &BTreeMap<String, String>) -> io::Result<()> {
        let mut content = Vec::new();
        put_text(&mut content, name);
        put_map(&mut content, facts);
        let (at, bytes) = (self.at, record(opcode::METADATA, &content));
        let mut index = Vec::new();
        put_u64(&mut index, at);
        put_u64(&mut index, bytes.len() as u64);
        put_text(&mut index, name);
        self.metadata_index.extend(record(opcode::METADATA_INDEX, &index));
        self.metadata_count += 1;
        self.write(&bytes)
    }

    /// Writes a file into the file.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn attachment(
        &mut self,
        name: &str,
        media_type: &str,
        time_ns: u64,
        data: &[u8],
    ) -> io::Result<()> {
        let mut content = Vec::new();
        put_u64(&mut content, time_ns);
        put_u64(&mut content, 0);
        put_text(&mut content, name);
        put_text(&mut content, media_type);
        put_u64(&mut content, data.len() as u64);
        content.extend_from_slice(data);
        let crc = crc32fast::hash(&content);
        put_u32(&mut content, crc);
        let (at, bytes) = (self.at, record(opcode::ATTACHMENT, &content));
        let mut index = Vec::new();
        for number in [at, bytes.len() as u64, time_ns, 0, data.len() as u64] {
            put_u64(&mut index, number);
        }
        put_text(&mut index, name);
        put_text(&mut index, media_type);
        self.attachment_index.extend(record(opcode::ATTACHMENT_INDEX, &index));
        self.attachment_count += 1;
        self.write(&bytes)
    }

    /// Writes a chunk and its index.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn chunk(&mut self, chunk: &Chunk) -> io::Result<()> {
        let start = self.at;
        let mut head = Vec::new();
        put_u64(&mut head, chunk.first);
        put_u64(&mut head, chunk.last);
        put_u64(&mut head, chunk.plain_bytes);
        put_u32(&mut head, chunk.crc);
        put_text(&mut head, chunk.compression.name());
        put_u64(&mut head, chunk.packed.len() as u64);
        let mut front = vec![opcode::CHUNK];
        put_u64(&mut front, (head.len() + chunk.packed.len()) as u64);
        front.extend(head);
        self.write(&front)?;
        self.write(&chunk.packed)?;
        let end = self.at;
        let mut offsets = Vec::new();
        let mut indexes = Vec::new();
        for (channel, messages) in &chunk.index {
            put_u16(&mut offsets, *channel);
            put_u64(&mut offsets, end + indexes.len() as u64);
            let mut content = Vec::new();
            put_u16(&mut content, *channel);
            put_u32(&mut content, 16 * messages.len() as u32);
            for (time, place) in messages {
                put_u64(&mut content, *time);
                put_u64(&mut content, *place);
            }
            indexes.extend(record(opcode::MESSAGE_INDEX, &content));
            *self.counts.entry(*channel).or_default() += messages.len() as u64;
        }
        self.write(&indexes)?;
        let mut index = Vec::new();
        for number in [chunk.first, chunk.last, start, end - start] {
            put_u64(&mut index, number);
        }
        put_u32(&mut index, offsets.len() as u32);
        index.extend(offsets);
        put_u64(&mut index, indexes.len() as u64);
        put_text(&mut index, chunk.compression.name());
        put_u64(&mut index, chunk.packed.len() as u64);
        put_u64(&mut index, chunk.plain_bytes);
        self.chunk_index.extend(record(opcode::CHUNK_INDEX, &index));
        self.chunk_count += 1;
        let (first, last) = self.times.unwrap_or((chunk.first, chunk.last));
        self.times = Some((first.min(chunk.first), last.max(chunk.last)));
        Ok(())
    }

    /// Writes the summary and ends the file.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn finish(mut self) -> io::Result<W> {
        let mut end = Vec::new();
        put_u32(&mut end, self.crc.clone().finalize());
        self.write(&record(opcode::DATA_END, &end))?;
        let statistics = record(opcode::STATISTICS, &self.statistics());
        let summary_start = self.at;
        let groups = [
            (opcode::SCHEMA, std::mem::take(&mut self.schemas)),
            (opcode::CHANNEL, std::mem::take(&mut self.channels)),
            (opcode::STATISTICS, statistics),
            (opcode::CHUNK_INDEX, std::mem::take(&mut self.chunk_index)),
            (opcode::ATTACHMENT_INDEX, std::mem::take(&mut self.attachment_index)),
            (opcode::METADATA_INDEX, std::mem::take(&mut self.metadata_index)),
        ];
        self.crc = crc32fast::Hasher::new();
        let mut offsets = Vec::new();
        for (opcode, group) in groups.iter().filter(|(_, group)| !group.is_empty()) {
            let mut content = vec![*opcode];
            put_u64(&mut content, self.at);
            put_u64(&mut content, group.len() as u64);
            offsets.extend(record(opcode::SUMMARY_OFFSET, &content));
            self.write(group)?;
        }
        let offsets_start = self.at;
        self.write(&offsets)?;
        let mut footer = vec![opcode::FOOTER];
        put_u64(&mut footer, 20);
        put_u64(&mut footer, summary_start);
        put_u64(&mut footer, offsets_start);
        self.write(&footer)?;
        let crc = self.crc.clone().finalize();
        self.write(&crc.to_le_bytes())?;
        self.write(&MAGIC)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn statistics(&self) -> Vec<u8> {
        let mut content = Vec::new();
        put_u64(&mut content, self.counts.values().sum());
        put_u16(&mut content, self.schema_count);
        for count in [self.channel_count, self.attachment_count, self.metadata_count, self.chunk_count] {
            put_u32(&mut content, count);
        }
        let (first, last) = self.times.unwrap_or_default();
        put_u64(&mut content, first);
        put_u64(&mut content, last);
        put_u32(&mut content, 10 * self.counts.len() as u32);
        for (channel, count) in &self.counts {
            put_u16(&mut content, *channel);
            put_u64(&mut content, *count);
        }
        content
    }
}

fn schema_record(number: u16, schema: &Schema) -> Vec<u8> {
    let mut content = Vec::new();
    put_u16(&mut content, number);
    put_text(&mut content, &schema.name);
    put_text(&mut content, "protobuf");
    put_u32(&mut content, schema.descriptor.len() as u32);
    content.extend_from_slice(&schema.descriptor);
    record(opcode::SCHEMA, &content)
}

fn channel_record(number: u16, channel: &Channel) -> Vec<u8> {
    let mut content = Vec::new();
    put_u16(&mut content, number);
    put_u16(&mut content, channel.schema);
    put_text(&mut content, &channel.topic);
    put_text(&mut content, "protobuf");
    put_map(&mut content, &channel.metadata);
    record(opcode::CHANNEL, &content)
}

fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(9 + content.len());
    bytes.push(opcode);
    put_u64(&mut bytes, content.len() as u64);
    bytes.extend_from_slice(content);
    bytes
}

fn put_u16(out: &mut Vec<u8>, value: u16) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn put_u32(out: &mut Vec<u8>, value: u32) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn put_u64(out: &mut Vec<u8>, value: u64) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn put_text(out: &mut Vec<u8>, text: &str) {
    put_u32(out, text.len() as u32);
    out.extend_from_slice(text.as_bytes());
}

fn put_map(out: &mut Vec<u8>, map: &BTreeMap<String, String>) {
    let mut entries = Vec::new();
    for (key, value) in map {
        put_text(&mut entries, key);
        put_text(&mut entries, value);
    }
    put_u32(out, entries.len() as u32);
    out.extend(entries);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn u64_at(bytes: &[u8], at: usize) -> u64 {
        u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"))
    }

    /// Opcodes and contents of the records between two places.
    fn records(mut bytes: &[u8]) -> Vec<(u8, Vec<u8>)> {
        let mut found = Vec::new();
        while !bytes.is_empty() {
            let length = u64_at(bytes, 1) as usize;
            found.push((bytes[0], bytes[9..9 + length].to_vec()));
            bytes = &bytes[9 + length..];
        }
        found
    }

    fn small() -> Vec<u8> {
        let schemas = [Schema { name: "t.A".into(), descriptor: vec![7; 5] }];
        let channel = |topic: &str| Channel {
            schema: 1,
            topic: topic.into(),
            metadata: BTreeMap::from([("k".into(), "v".into())]),
        };
        let mut file = McapWriter::new(Vec::new(), "us", &schemas, &[channel("/a"), channel("/b")])
            .expect("memory takes it");
        file.metadata("m", &BTreeMap::new()).expect("memory takes it");
        file.attachment("f", "text/plain", 5, b"abc").expect("memory takes it");
        for (time, compression) in [(10, Compression::Zstd), (20, Compression::None)] {
            let mut messages = Messages::default();
            messages.add(2, 0, time, |out| out.extend_from_slice(b"hello"));
            messages.add(1, 1, time + 1, |out| out.extend_from_slice(&[0; 100]));
            messages.add(2, 2, time + 2, |_| ());
            file.chunk(&messages.into_chunk(compression).expect("compresses")).expect("memory takes it");
        }
        file.finish().expect("memory takes it")
    }

    #[test]
    fn every_offset_points_at_its_record() {
        let file = small();
        assert_eq!((&file[..8], &file[file.len() - 8..]), (&MAGIC[..], &MAGIC[..]));
        let all = records(&file[8..file.len() - 8]);
        let opcodes: Vec<u8> = all.iter().map(|(opcode, _)| *opcode).collect();
        let want =
            [1, 3, 4, 4, 12, 9, 6, 7, 7, 6, 7, 7, 15, 3, 4, 4, 11, 8, 8, 10, 13, 14, 14, 14, 14, 14, 14, 2];
        assert_eq!(opcodes, want);
        let footer = &all[all.len() - 1].1;
        let (summary, offsets) = (u64_at(footer, 0) as usize, u64_at(footer, 8) as usize);
        assert_eq!((file[summary], file[offsets]), (opcode::SCHEMA, opcode::SUMMARY_OFFSET));
        let crc = u32::from_le_bytes(footer[16..].try_into().expect("four bytes"));
        assert_eq!(crc, crc32fast::hash(&file[summary..file.len() - 12]));
        for (_, group) in all.iter().filter(|(opcode, _)| *opcode == opcode::SUMMARY_OFFSET) {
            assert_eq!(file[u64_at(group, 1) as usize], group[0]);
        }
        // Statistics: 6 messages, 1 schema, 2 channels, 1 attachment, 1 metadata, 2 chunks, from 10 to 22.
        let statistics = &all.iter().find(|(opcode, _)| *opcode == opcode::STATISTICS).expect("has them").1;
        assert_eq!(u64_at(statistics, 0), 6);
        assert_eq!(statistics[8..26], [1, 0, 2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
        assert_eq!((u64_at(statistics, 26), u64_at(statistics, 34)), (10, 22));
        let data_end = all.iter().position(|(opcode, _)| *opcode == opcode::DATA_END).expect("has one");
        let crc = u32::from_le_bytes(all[data_end].1[..4].try_into().expect("four bytes"));
        assert_eq!(crc, crc32fast::hash(&file[..summary - 13]));
    }

    #[test]
    fn messages_are_found_by_their_index() {
        let file = small();
        let all = records(&file[8..file.len() - 8]);
        let indexes: Vec<_> = all.iter().filter(|(opcode, _)| *opcode == opcode::CHUNK_INDEX).collect();
        for (index, time) in indexes.into_iter().map(|(_, index)| index).zip([10, 20]) {
            assert_eq!((u64_at(index, 0), u64_at(index, 8)), (time, time + 2));
            let start = u64_at(index, 16) as usize;
            assert_eq!(file[start], opcode::CHUNK);
            let chunk = &records(&file[start..start + u64_at(index, 24) as usize])[0].1;
            let name = u32::from_le_bytes(chunk[28..32].try_into().expect("four bytes")) as usize;
            let packed = &chunk[32 + name + 8..];
            let plain_bytes = u64_at(chunk, 16) as usize;
            let plain = match name {
                0 => packed.to_vec(),
                _ => zstd::bulk::decompress(packed, plain_bytes).expect("is zstd"),
            };
            assert_eq!(plain.len(), plain_bytes);
            // Two channels of ten bytes in the map; that of channel 2 is the second.
            assert_eq!(index[32..36], [20, 0, 0, 0]);
            let second = u64_at(index, 36 + 10 + 2) as usize;
            let of_two = &records(&file[second..second + 9 + 2 + 4 + 32])[0].1;
            assert_eq!((of_two[0], u64_at(of_two, 6)), (2, time));
            let message = &plain[u64_at(of_two, 14) as usize..];
            assert_eq!(
                (message[0], &message[MESSAGE_HEAD..MESSAGE_HEAD + 5]),
                (opcode::MESSAGE, &b"hello"[..])
            );
        }
    }
}
