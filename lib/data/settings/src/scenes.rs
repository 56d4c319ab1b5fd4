//! Which scenes a dataset has.

use serde::{Deserialize, Serialize};

/// Part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs)] // The names are their own documentation.
pub enum Split {
    Train,
    Val,
    Test,
}

impl Split {
    /// All splits, in planning order.
    pub const ALL: [Self; 3] = [Self::Train, Self::Val, Self::Test];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }
}

/// A wish for some scenes of a split on a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneCount {
    /// The split.
    pub split: Split,
    /// The map: `convoy/...` for our own towns, the path of an OpenDRIVE file, or the stem of one in the maps folder.
    pub map: String,
    /// Scenes wanted.
    pub count: u32,
}
