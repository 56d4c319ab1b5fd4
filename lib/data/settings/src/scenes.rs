//! Which scenes a dataset has.

use serde::{Deserialize, Serialize};

use crate::key::Name;
use crate::reader::Section;

/// Part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it all")]
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneCount {
    /// The split.
    pub split: Split,
    /// The map: `convoy/...` for our own towns, the path of an OpenDRIVE file, or the stem of one in the maps
    /// folder.
    pub map: String,
    /// Scenes wanted.
    pub count: u32,
}

/// How many scenes on which map, in split order.
pub(crate) fn counts(root: &Section<'_>, name: &Name, _: Vec<SceneCount>) -> Vec<SceneCount> {
    let section = root.section(name.key, name.doc);
    let mut scenes = Vec::new();
    for split in Split::ALL {
        let doc = format!("Scenes of the {} split; keys are map names.", split.name());
        let counts = section.section(split.name(), &doc).free_integers(
            "\"MAP\"",
            0,
            100_000,
            "Scenes on a map: one of our towns (`convoy/03`), the path of a `.xodr` or `.xodr.gz` file, or the stem of one \
             in the maps folder.",
        );
        scenes.extend(counts.into_iter().map(|(map, count)| SceneCount { split, map, count: count as u32 }));
    }
    scenes
}

/// Whether a number is not written down: records are as they were before there was the key.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
pub(crate) fn is_zero(number: &u32) -> bool {
    *number == 0
}

/// Which scenes are drawn anew.
pub(crate) fn redraw(root: &Section<'_>, name: &Name, _: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
    let section = root.section("scenes", "").section(name.key, name.doc);
    let doc =
        "Which further draw of the scene is meant: each number gives another scene, 0 the first one again.";
    let draws = section.free_integers("\"SCENE\"", 0, u32::MAX.into(), doc);
    let read = |(key, draw): (String, i64)| match key.parse::<u32>() {
        Ok(scene) => Some((scene, draw as u32)),
        Err(_) => {
            section.fault_at(&key, format!("`{}`: `{key}` is no scene number", section.path()));
            None
        }
    };
    draws.into_iter().filter_map(read).collect()
}
