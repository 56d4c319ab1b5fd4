//! What a file holds, track by track: each reads its part of the scene frame by frame, and makes its messages of it. Tracks
//! know nothing of one another.

pub(super) mod clouds;
pub(super) mod depths;
pub(super) mod masks;
pub(super) mod merged;
pub(super) mod motion;
pub(super) mod pictures;
pub(super) mod seen;
pub(super) mod voxels;

use super::container::{Compression, Messages};
use crate::ExportError;

/// A part of a scene that becomes messages.
pub(super) trait Track: Send {
    /// Adds the messages of a frame. Frames come in ascending order.
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError>;

    /// How its chunks are kept.
    fn compression(&self) -> Compression {
        Compression::Zstd
    }
}
