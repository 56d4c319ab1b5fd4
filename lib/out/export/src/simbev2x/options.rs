//! What may be chosen of the layout.

use super::masks::Palette;

/// Before or after the original's post-processing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// What its generator writes.
    Raw,
    /// With points, validity and difficulty of boxes, the boxes of all agents in one list, filled grids.
    #[default]
    Processed,
}

/// What may be chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Before or after post-processing.
    pub state: State,
    /// Colours of the pictures of masks.
    pub palette: Palette,
    /// What stands before `/simbev2x/...` in the paths of infos: the folder that readers are given.
    pub path_prefix: String,
}

impl Options {
    /// A path of infos.
    pub(super) fn path(&self, below: &str) -> String {
        match self.path_prefix.trim_end_matches('/') {
            "" if self.path_prefix.is_empty() => below.to_owned(),
            prefix => format!("{prefix}/{below}"),
        }
    }
}
