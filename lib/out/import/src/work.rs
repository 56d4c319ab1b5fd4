//! A scene that is being imported.

use std::path::Path;

use store::{MadeBy, Store};

use crate::cast::SceneObjects;
use crate::error::ImportError;
use crate::folder::Folder;
use crate::infos::{Entry, Scene};
use crate::rig::Rigs;

/// Sees how far an import is, and may stop it.
pub trait ProgressWatch: Sync {
    /// So many agent-frames more are done. Whether to stop.
    fn advance(&self, agent_frames: u64) -> bool;
}

/// How a scene is to be imported.
pub(crate) struct Order<'a> {
    pub(crate) folder: &'a Folder,
    pub(crate) store: &'a Store,
    pub(crate) rigs: &'a Rigs,
    pub(crate) entry: &'a Entry,
    /// Of the scene's part of the infos and of what they say of sensors.
    pub(crate) digest: &'a str,
    /// Size of a cell of the masks, m.
    pub(crate) bev_cell_m: f64,
    pub(crate) is_processed: bool,
    /// Again, even where it is done.
    pub(crate) force: bool,
    pub(crate) made_by: Option<&'a MadeBy>,
    pub(crate) watch: &'a dyn ProgressWatch,
}

/// A scene and all that is known of it.
pub(crate) struct Work<'a> {
    pub(crate) order: &'a Order<'a>,
    pub(crate) scene: &'a Scene,
    pub(crate) cast: &'a SceneObjects,
}

impl Work<'_> {
    /// Tells that so many agent-frames are done.
    pub(crate) fn advance(&self, agent_frames: u64) -> Result<(), ImportError> {
        if self.order.watch.advance(agent_frames) { Err(ImportError::Stopped) } else { Ok(()) }
    }

    /// Something is wrong with a file of an agent at a frame.
    pub(crate) fn wrong(&self, position: usize, frame: u32, key: &str, problem: &str) -> ImportError {
        let (agent, records) = &self.scene.agents[position];
        let said = records[frame as usize].files.get(key).map_or(key, String::as_str);
        ImportError::source(Path::new(said), problem).within(format!("{agent} frame {frame} {key}"))
    }
}
