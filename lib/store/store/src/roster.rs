//! Which scenes a store has, and of which kind they are.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::error::sound;
use crate::{Store, StoreError, keys};

/// The folder of all scenes.
const SCENES: &str = "scenes";

/// By which configuration a scene is made.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct SceneKind {
    /// The edition of the configuration: `dataset.json` has them all.
    pub edition: u32,
    /// The group in it; empty: the scene is of no group.
    pub group: String,
}

/// What the roster says of a scene, as far as it is told here.
#[derive(Deserialize)]
struct Slot {
    scene: u32,
    #[serde(default)]
    edition: u32,
    #[serde(default)]
    group: String,
}

/// The kinds of the scenes of a store, by scene; none where it has no roster, or it is damaged.
///
/// # Errors
/// The store cannot be read.
pub fn scene_kinds(store: &Store) -> Result<BTreeMap<u32, SceneKind>, StoreError> {
    let slots: Vec<Slot> = sound(store.read_json(keys::ROSTER))?.unwrap_or_default();
    let kind = |Slot { scene, edition, group }: Slot| (scene, SceneKind { edition, group });
    Ok(slots.into_iter().map(kind).collect())
}

/// Names of the kinds of scenes, by scene, for people; none where all are of one kind.
#[must_use]
pub fn kind_names(kinds: &BTreeMap<u32, SceneKind>) -> BTreeMap<u32, String> {
    let editions: BTreeSet<u32> = kinds.values().map(|kind| kind.edition).collect();
    let groups: BTreeSet<&str> = kinds.values().map(|kind| kind.group.as_str()).collect();
    if editions.len() < 2 && groups.len() < 2 {
        return BTreeMap::new();
    }
    let name = |kind: &SceneKind| {
        let edition = (editions.len() > 1).then(|| format!("edition {}", kind.edition));
        let group = match kind.group.as_str() {
            "" => (groups.len() > 1).then(|| "no group".to_owned()),
            group => Some(group.to_owned()),
        };
        edition.into_iter().chain(group).collect::<Vec<_>>().join(", ")
    };
    kinds.iter().map(|(scene, kind)| (*scene, name(kind))).collect()
}

/// Scenes of which something is done, whether a plan has them or not.
///
/// # Errors
/// The store cannot be read.
pub fn scenes_begun(store: &Store) -> Result<BTreeSet<u32>, StoreError> {
    let mut begun = BTreeSet::new();
    for name in store.backend().folders(SCENES)? {
        let Ok(scene) = name.parse() else { continue };
        if !store.backend().keys(&format!("{SCENES}/{name}/_manifests"))?.is_empty() {
            begun.insert(scene);
        }
    }
    Ok(begun)
}

/// Whether a store has the folder of any scene.
///
/// # Errors
/// The store cannot be read.
pub fn has_scenes(store: &Store) -> Result<bool, StoreError> {
    Ok(!store.backend().folders(SCENES)?.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_named_where_there_are_several() {
        let named = |kinds: &[(u32, &str)]| -> Vec<String> {
            let kind = |(scene, (edition, group)): (usize, &(u32, &str))| {
                (scene as u32, SceneKind { edition: *edition, group: (*group).into() })
            };
            kind_names(&kinds.iter().enumerate().map(kind).collect()).into_values().collect()
        };
        assert_eq!(named(&[(0, ""), (0, "")]), [""; 0]);
        assert_eq!(named(&[(0, "rain"), (0, "rain")]), [""; 0]);
        assert_eq!(named(&[(0, ""), (0, "rain")]), ["no group", "rain"]);
        assert_eq!(named(&[(0, ""), (1, "")]), ["edition 0", "edition 1"]);
        assert_eq!(named(&[(0, "rain"), (1, "")]), ["edition 0, rain", "edition 1, no group"]);
    }

    #[test]
    fn rosters_of_before_have_one_kind() {
        let store = Store::open("memory:").expect("opens");
        assert_eq!(scene_kinds(&store).expect("reads"), BTreeMap::new());
        let old = serde_json::json!([{"scene": 3, "split": "val", "map": "m"}]);
        store.write_json(keys::ROSTER, "spawn-planner", &old).expect("is written");
        let kinds = scene_kinds(&store).expect("reads");
        assert_eq!(kinds, BTreeMap::from([(3, SceneKind::default())]));
    }
}
