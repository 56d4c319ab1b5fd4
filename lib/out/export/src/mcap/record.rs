//! Records, of which files of this format are lists.

use std::collections::BTreeMap;

/// Which record it is.
pub(super) mod opcode {
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

/// A record: what it is, its length, its content.
pub(super) fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(9 + content.len());
    bytes.push(opcode);
    put_u64(&mut bytes, content.len() as u64);
    bytes.extend_from_slice(content);
    bytes
}

/// A number, the lowest byte first.
pub(super) fn put_u16(out: &mut Vec<u8>, value: u16) {
    out.extend_from_slice(&value.to_le_bytes());
}

/// Likewise.
pub(super) fn put_u32(out: &mut Vec<u8>, value: u32) {
    out.extend_from_slice(&value.to_le_bytes());
}

/// Likewise.
pub(super) fn put_u64(out: &mut Vec<u8>, value: u64) {
    out.extend_from_slice(&value.to_le_bytes());
}

/// Its length, then the text.
pub(super) fn put_text(out: &mut Vec<u8>, text: &str) {
    put_u32(out, text.len() as u32);
    out.extend_from_slice(text.as_bytes());
}

/// The bytes of all entries, then key and value of each.
pub(super) fn put_map(out: &mut Vec<u8>, map: &BTreeMap<String, String>) {
    let mut entries = Vec::new();
    for (key, value) in map {
        put_text(&mut entries, key);
        put_text(&mut entries, value);
    }
    put_u32(out, entries.len() as u32);
    out.extend(entries);
}
