//! The keys that say what happens in a scene.

use crate::reader::Section;
use crate::{SceneCount, Split};

/// How many scenes on which map, and which of them are drawn anew.
pub(crate) fn scenes(root: &Section<'_>) -> (Vec<SceneCount>, Vec<(u32, u32)>) {
    let section = root.section("scenes", "how many scenes on which map");
    let mut scenes = Vec::new();
    for split in Split::ALL {
        let doc = format!("scenes of the {} split; keys are map names", split.name());
        let counts = section.section(split.name(), &doc).free_integers(
            "\"MAP\"",
            0,
            100_000,
            "scenes on a map: one of our towns (`convoy/03`), the path of a `.xodr` or `.xodr.gz` file, or the stem of one \
             in the maps folder",
        );
        scenes.extend(counts.into_iter().map(|(map, count)| SceneCount { split, map, count: count as u32 }));
    }
    if scenes.iter().all(|s| s.count == 0) {
        root.fault_at(
            "scenes",
            "no scenes: add a table such as [scenes.train] with \"convoy/demo\" = 2".into(),
        );
    }
    (scenes, redraw(&section))
}

fn redraw(scenes: &Section<'_>) -> Vec<(u32, u32)> {
    let section = scenes.section(
        "redraw",
        "scenes to replace by other ones of the same split and map; keys are scene numbers",
    );
    let doc =
        "which further draw of the scene is meant: each number gives another scene, 0 the first one again";
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
