//! Files that stock tools read: numpy archives here, PNG and JPEG in [`images`].
//!
//! An [`NpzWriter`] makes a numpy archive with one array per frame, `0000.npy`, `0001.npy`, ...: a zip, so
//! that one frame is read without the others. Encoding a member ([`encode_member`]) needs nothing but its
//! data, so callers encode many at once and append them in order:
//!
//! ```
//! use std::io::Cursor;
//! use codecs::{DEFAULT_LEVEL, NpzReader, NpzWriter, Scalar, encode_member, frame_member};
//!
//! let mut writer = NpzWriter::new(Vec::new());
//! for frame in 0..3_u8 {
//!     let cells = [frame; 6];
//!     let name = frame_member(u32::from(frame));
//!     writer.append(encode_member(&name, Scalar::U8, &[2, 3], &cells, DEFAULT_LEVEL)?)?;
//! }
//! let archive = writer.finish()?;
//!
//! let mut reader = NpzReader::new(Cursor::new(archive))?;
//! let array = reader.read(&frame_member(1))?;
//! assert_eq!((array.shape, array.bytes), (vec![2, 3], vec![1; 6]));
//! # Ok::<(), codecs::NpzError>(())
//! ```
//!
//! The bytes of an archive depend on names, arrays and level alone: no clock, no machine.

mod deflate;
mod dtype;
mod error;
pub mod images;
mod npy;
mod npz;

pub use deflate::Repeats;
pub use dtype::{DType, Scalar};
pub use error::NpzError;
pub use npy::{Array, npy_header, npy_object_header};
pub use npz::{
    DEFAULT_LEVEL, DEFAULT_MAX_BYTES, EncodedMember, NpzReader, NpzWriter, PackedArray, archive_of,
    encode_member, encode_records, frame_member,
};
