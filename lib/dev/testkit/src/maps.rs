//! Real maps, where they are at hand.

use std::path::{Path, PathBuf};

use opendrive::Map;

use crate::need::{Need, skip};

fn place() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/maps");
    std::env::var_os("CONVOY_TEST_MAPS").map_or_else(beside, PathBuf::from)
}

/// The folder of real maps: `CONVOY_TEST_MAPS`, else `../shared/maps` beside the workspace. Where there is
/// none, a note that the test is skipped, and `None`.
///
/// # Panics
/// There is none, and `CONVOY_REQUIRE` names `maps`.
#[must_use]
#[track_caller]
pub fn maps_folder() -> Option<PathBuf> {
    let folder = place();
    if folder.is_dir() {
        return Some(folder);
    }
    skip(Need::Maps, &format!("there is no folder {}", folder.display()));
    None
}

/// Every `.xodr` and `.xodr.gz` of [`maps_folder`] and the folders in it, in order of their paths; none where
/// there is no such folder.
///
/// # Panics
/// As [`maps_folder`], or a folder is there and holds no map.
#[must_use]
#[track_caller]
pub fn map_files() -> Vec<PathBuf> {
    let Some(folder) = maps_folder() else { return Vec::new() };
    let mut found = Vec::new();
    find(&folder, &mut found);
    found.sort();
    assert!(!found.is_empty(), "{} holds no map", folder.display());
    found
}

fn find(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let name = path.to_string_lossy();
        if path.is_dir() {
            find(&path, found);
        } else if name.ends_with(".xodr") || name.ends_with(".xodr.gz") {
            found.push(path);
        }
    }
}

/// A CARLA town by its name (`Town03`), or `None` and a note that the test is skipped.
///
/// # Panics
/// It is not at hand and `CONVOY_REQUIRE` names `maps`, or it cannot be read.
#[must_use]
#[track_caller]
pub fn real_map(name: &str) -> Option<Map> {
    let folder = maps_folder()?.join("carla");
    let path = ["xodr", "xodr.gz"].map(|ending| folder.join(format!("{name}.{ending}")));
    let Some(path) = path.into_iter().find(|path| path.is_file()) else {
        skip(Need::Maps, &format!("there is no {name} in {}", folder.display()));
        return None;
    };
    let network = std::fs::read(&path).map_err(|e| e.to_string());
    let network = network.and_then(|bytes| opendrive::read_bytes(&bytes).map_err(|e| e.to_string()));
    Some(Map::new(network.unwrap_or_else(|e| panic!("{}: {e}", path.display()))))
}

/// Those of some CARLA towns that are at hand, with their names.
///
/// # Panics
/// As [`real_map`].
#[track_caller]
pub fn real_maps<'a>(names: &[&'a str]) -> impl Iterator<Item = (&'a str, Map)> {
    names.iter().filter_map(|name| Some((*name, real_map(name)?)))
}
