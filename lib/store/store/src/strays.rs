//! Files that belong to nothing: left by processes that were killed, or that wrote after their time.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, SystemTime};

use crate::known::known;
use crate::{Store, StoreError, keys};

/// What was done about files that no manifest names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Strays {
    /// So many were removed.
    pub removed: usize,
    /// Their bytes.
    pub bytes: u64,
    /// So many were left: they are young, lie where something is not done, or are none of ours.
    pub left: usize,
}

/// Removes files that no manifest names and no try has in hand, once they are of some age; for who holds the
/// store alone. Only where all is done: in a scene that has every stage that other scenes have, and beside
/// the manifests of plan and statistics. What lies outside the store's own folders is somebody else's.
///
/// # Errors
/// The store cannot be read or changed, or a record in it is damaged: then nobody knows what it named, and
/// nothing is removed.
pub fn remove_strays(store: &Store, age: Duration) -> Result<Strays, StoreError> {
    let listing = store.backend().list("")?;
    let sizes: BTreeMap<String, u64> = listing.objects.into_iter().map(|o| (o.key, o.bytes)).collect();
    let files: Vec<String> = sizes.keys().filter(|key| !keys::is_lock(key)).cloned().collect();
    let mut damage = Vec::new();
    let known = known(store, &files, &mut damage, |_, _, _, _| Ok(()))?;
    if let Some(finding) = damage.first() {
        let path = store.location(&finding.key);
        return Err(StoreError::Corrupt { path, problem: finding.problem.to_string() });
    }
    let done = Done::of(&files);
    let now = SystemTime::now();
    let mut strays = Strays::default();
    let is_stray = |key: &&String| !known.committed.contains(*key) && !known.in_hand.contains(*key);
    for key in files.iter().filter(is_stray) {
        let put = if done.covers(key) { store.backend().modified(key)? } else { None };
        // One of tomorrow is not old.
        if put.and_then(|put| now.duration_since(put).ok()).is_some_and(|found| found >= age) {
            store.backend().remove(key)?;
            strays.removed += 1;
            strays.bytes += sizes.get(key).copied().unwrap_or(0);
        } else {
            strays.left += 1;
        }
    }
    Ok(strays)
}

/// Where all is done.
struct Done<'k> {
    folders: BTreeSet<&'k str>,
}

impl<'k> Done<'k> {
    fn of(files: &'k [String]) -> Self {
        let mut stages: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut folders = BTreeSet::new();
        for key in files {
            if let Some((scene, stage)) = stage_of(key) {
                stages.entry(scene).or_default().insert(stage);
            }
            if let Some(folder) = key.strip_suffix("/_manifest.json") {
                folders.insert(folder);
            }
        }
        let most: BTreeSet<&str> = stages.values().flatten().copied().collect();
        folders.extend(stages.into_iter().filter(|(_, has)| *has == most).map(|(scene, _)| scene));
        Self { folders }
    }

    fn covers(&self, key: &str) -> bool {
        let has = |folder: &str| self.folders.contains(folder);
        match key.split('/').next() {
            Some("scenes") => scene_of(key).is_some_and(has),
            Some("plan" | "maps" | "models") => has("plan"),
            Some("stats") => has("stats"),
            // Tiles that no scene names go as a whole.
            _ => false,
        }
    }
}

/// The folder of the scene in which a file lies.
fn scene_of(key: &str) -> Option<&str> {
    let end = key.match_indices('/').nth(1)?.0;
    key.starts_with("scenes/").then(|| &key[..end])
}

/// The scene and the stage whose manifest a key is.
fn stage_of(key: &str) -> Option<(&str, &str)> {
    let scene = scene_of(key)?;
    let name = key.strip_prefix(scene)?.strip_prefix("/_manifests/")?.strip_suffix(".json")?;
    (!name.contains(['/', '.'])).then_some((scene, name))
}
