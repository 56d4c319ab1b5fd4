//! A scene that is being imported.

use std::path::Path;

use store::Store;

use crate::cast::Cast;
use crate::error::ImportError;
use crate::folder::Folder;
use crate::infos::{Entry, Scene};
use crate::rig::Rigs;

/// Sees how far an import is, and may stop it.
pub trait Watch: Sync {
    /// So many agent-frames more are done. Whether to stop.
    fn advance(&self, agent_frames: u64) -> bool;
}

/// A scene and all that is known of it.
pub(crate) struct Work<'a> {
    pub(crate) folder: &'a Folder,
    pub(crate) store: &'a Store,
    pub(crate) rigs: &'a Rigs,
    pub(crate) entry: &'a Entry,
    pub(crate) scene: &'a Scene,
    pub(crate) cast: &'a Cast,
    pub(crate) is_processed: bool,
    /// Size of a cell of the masks, m.
    pub(crate) bev_cell_m: f64,
    pub(crate) watch: &'a dyn Watch,
}

impl Work<'_> {
    /// Tells that so many agent-frames are done.
    pub(crate) fn advance(&self, agent_frames: u64) -> Result<(), ImportError> {
        if self.watch.advance(agent_frames) { Err(ImportError::Stopped) } else { Ok(()) }
    }

    /// Something is wrong with a file of an agent at a frame.
    pub(crate) fn wrong(&self, position: usize, frame: u32, key: &str, problem: &str) -> ImportError {
        let (agent, records) = &self.scene.agents[position];
        let said = records[frame as usize].files.get(key).map_or(key, String::as_str);
        ImportError::source(Path::new(said), problem).within(format!("{agent} frame {frame} {key}"))
    }
}
