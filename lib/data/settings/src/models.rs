//! Models besides the built-in ones.

use serde::Serialize;

/// Models besides the built-in ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelSettings {
    /// Folders with models, below the folder of maps or from where the program runs.
    pub packs: Vec<String>,
}

impl ModelSettings {
    /// Whether there are only the built-in models; then nothing is written of these settings, and digests are as they were before there
    /// were packs.
    #[must_use]
    pub fn is_built_in(&self) -> bool {
        self.packs.is_empty()
    }
}
