//! What a file holds, track by track: each reads its part of the scene frame by frame, and makes its messages
//! of it. Tracks know nothing of one another.

pub(crate) mod clouds;
pub(crate) mod depths;
pub(crate) mod masks;
pub(crate) mod merged;
pub(crate) mod motion;
pub(crate) mod pictures;
pub(crate) mod seen;
pub(crate) mod voxels;

use super::chunk::{Compression, Messages};
use crate::ExportError;

/// A part of a scene that becomes messages.
pub(crate) trait Track: Send {
    /// Adds the messages of a frame. Frames come in ascending order.
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError>;

    /// How its chunks are kept.
    fn compression(&self) -> Compression {
        Compression::Zstd
    }
}
