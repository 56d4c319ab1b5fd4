//! Numpy archives: zip files of NPY arrays.

mod encode;
mod read;
mod write;

pub use encode::{DEFAULT_LEVEL, EncodedMember, encode_member, encode_records};
pub use read::{DEFAULT_MAX_BYTES, NpzReader, PackedArray};
pub use write::{NpzWriter, archive_of};

/// Name of a frame's member: `0000.npy`, `0001.npy`, ..., `10000.npy`.
#[must_use]
pub fn frame_member(frame: u32) -> String {
    format!("{frame:04}.npy")
}
