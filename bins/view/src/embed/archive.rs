//! Archives of arrays cut to some frames.

use std::io::Write;

use bytes::Bytes;
use rawzip::path::EntryPath;
use rawzip::{DataDescriptorOutput, ZipArchive, ZipArchiveWriter, ZipSliceArchive};
use serde_json::Value;

use crate::error::{ViewError, of_place};
use crate::object::Object;

/// Masks are small: an archive of them is read whole.
fn open(object: &Object) -> Result<ZipSliceArchive<Bytes>, ViewError> {
    ZipArchive::from_slice(object.bytes()?).map_err(of_place(&object.place))
}

/// At every how many frames an archive has a member.
pub(super) fn every_n_frames(object: &Object) -> Result<u64, ViewError> {
    let archive = open(object)?;
    let about: Option<Value> = serde_json::from_slice(archive.comment().as_bytes()).ok();
    Ok(about.and_then(|a| a["every_n_frames"].as_u64()).filter(|&n| n > 0).unwrap_or(1))
}

/// The members of some frames as an archive, named by frames counted from the first one. They are copied as
/// they are packed.
pub(super) fn frames(object: &Object, (first, last): (u32, u32)) -> Result<Vec<u8>, ViewError> {
    let archive = open(object)?;
    let mut out = Vec::new();
    let mut writer = ZipArchiveWriter::new(&mut out);
    writer.set_comment(archive.comment().as_bytes());
    let bad = of_place::<rawzip::Error>(&object.place);
    let mut entries = archive.entries();
    while let Some(record) = entries.next_entry().map_err(bad)? {
        let name = String::from_utf8_lossy(record.file_path().as_ref()).into_owned();
        let frame = name.strip_suffix(".npy").and_then(|n| n.parse::<u32>().ok());
        let Some(frame) = frame.filter(|f| (first..last).contains(f)) else { continue };
        let packed = archive.get_entry(record.wayfinder()).map_err(bad)?;
        let name = format!("{:04}.npy", frame - first);
        let file = writer
            .new_file(EntryPath::verbatim(name.as_bytes()))
            .compression_method(record.compression_method());
        let (mut entry, _) = file.start().map_err(bad)?;
        entry.write_all(packed.data()).map_err(of_place(&object.place))?;
        entry
            .finish(DataDescriptorOutput::new(record.crc32(), record.uncompressed_size_hint()))
            .map_err(bad)?;
    }
    writer.finish().map_err(bad)?;
    Ok(out)
}
