//! Models besides the built-in ones.

use crate::key::settings;
use crate::reader::Section;

settings! {
    /// Models besides the built-in ones.
    pub struct ModelSettings {
        /// Folders with glTF models (docs/packs.md), below the maps folder or from where the program runs.
        packs: Vec<String> = Vec::new();
    }
    rule named_once;
}

fn named_once(s: &Section<'_>, read: &ModelSettings) {
    for (i, pack) in read.packs.iter().enumerate() {
        if pack.is_empty() || read.packs[..i].contains(pack) {
            let problem = if pack.is_empty() { "is empty" } else { "is named twice" };
            s.fault_at("packs", format!("`models.packs`: folder `{pack}` {problem}"));
        }
    }
}

impl ModelSettings {
    /// Whether there are only the built-in models; then nothing is written of these settings, and digests are
    /// as they were before there were packs.
    #[must_use]
    pub fn is_built_in(&self) -> bool {
        self.packs.is_empty()
    }
}
