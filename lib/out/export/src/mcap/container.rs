//! MCAP files (mcap.dev/spec), as far as they are written here: schemas and channels first, then chunks with
//! an index each, a summary at the end.
//!
//! By hand: the format is a list of records with lengths. So any thread that has the messages of a
//! chunk makes it, and the file holds no clock, no version of a library, and no order but ours.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::chunk::Chunk;
use super::record::{opcode, put_map, put_text, put_u16, put_u32, put_u64, record};

const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

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
    /// Starts a file with all its schemas and channels; `library` names the program that wrote it.
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

#[cfg(test)]
mod tests {
    use super::super::chunk::{Compression, MESSAGE_HEAD, Messages};
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
