//! Lists: what is in the store, and what its numbers mean.

use std::fs;
use std::path::Path;

use schema::{BevClass, DetectionClass, FORMAT_VERSION, FRAME_PERIOD_S, Tag};
use serde_json::{Value, json};

use crate::error::{ViewError, of_file};
use crate::paths;

/// Stages whose manifests a finished scene has, in their order.
const STAGES: [&str; 6] =
    ["simulate-and-log", "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];
/// Folders below a scene's are looked into so deep: `sensors/AGENT/FILE`.
const DEPTH: usize = 3;

/// Numbers, names and colours of tags, classes and BEV channels.
pub(crate) fn names() -> Value {
    json!({
        "format_version": FORMAT_VERSION,
        "frame_period_s": FRAME_PERIOD_S,
        "tags": Tag::ALL.map(|t| json!({"name": t.name(), "rgb": t.viewer_rgb()})),
        "classes": DetectionClass::ALL.map(|c| json!({"name": c.name(), "rgb": c.rgb()})),
        "bev": BevClass::ALL.map(|c| json!({"name": c.name(), "rgb": c.rgb()})),
    })
}

/// The scenes that have a log, and what is not made of them yet.
///
/// # Errors
/// The list of scenes cannot be read.
pub(crate) fn store(root: &Path, named: &Path) -> Result<Value, ViewError> {
    let folder = named.file_name().or_else(|| root.file_name()).unwrap_or_default().to_string_lossy();
    let name = name(root)?.unwrap_or_else(|| folder.into_owned());
    let mut folders: Vec<String> = match fs::read_dir(root.join("scenes")) {
        Ok(entries) => entries.flatten().filter_map(|e| e.file_name().into_string().ok()).collect(),
        Err(_) => Vec::new(),
    };
    folders.retain(|f| !f.is_empty() && f.bytes().all(|b| b.is_ascii_digit()));
    folders.sort();
    let scenes = folders.iter().filter_map(|folder| {
        let info = scene_info(root, folder).ok()?;
        let word = |key: &str| info[key].as_str().unwrap_or("?").to_owned();
        let missing: Vec<&str> = STAGES
            .into_iter()
            .filter(|stage| !root.join(format!("scenes/{folder}/_manifests/{stage}.json")).is_file())
            .collect();
        Some(json!({
            "folder": folder,
            "title": format!("{folder} · {} · {}", word("split"), word("map")),
            "missing": missing,
        }))
    });
    let scenes: Vec<Value> = scenes.collect();
    Ok(json!({ "name": name, "scenes": scenes, "report": root.join("stats/report.html").is_file() }))
}

/// The dataset's name, if its configuration has one.
///
/// # Errors
/// `dataset.json` cannot be read.
pub(crate) fn name(root: &Path) -> Result<Option<String>, ViewError> {
    let dataset = read_json(&root.join("dataset.json"))?;
    Ok(dataset["config"]["name"].as_str().map(str::to_owned))
}

/// Refuses a store whose files may look otherwise.
///
/// # Errors
/// It has another format than this program shows, or `dataset.json` cannot be read.
pub(crate) fn check_format(root: &Path) -> Result<(), ViewError> {
    let dataset = read_json(&root.join("dataset.json"))?;
    match dataset["format_version"].as_u64() {
        Some(found) if found != u64::from(FORMAT_VERSION) => Err(ViewError::Format(root.to_owned(), found)),
        _ => Ok(()),
    }
}

/// A scene's facts and files with their sizes.
///
/// # Errors
/// There is no such scene, or it has no log yet.
pub(crate) fn scene(root: &Path, folder: &str) -> Result<Value, ViewError> {
    let info = scene_info(root, folder)?;
    let mut files = Vec::new();
    list(&root.join("scenes").join(folder), "", DEPTH, &mut files);
    files.sort();
    let map =
        info["map"].as_str().and_then(|map| paths::file_below(root, &format!("maps/{map}.vector.parquet")));
    let map_bytes = map.and_then(|path| fs::metadata(path).ok()).map_or(0, |m| m.len());
    Ok(json!({ "info": info, "files": files, "map_bytes": map_bytes }))
}

pub(crate) fn scene_info(root: &Path, folder: &str) -> Result<Value, ViewError> {
    let path = paths::file_below(root, &format!("scenes/{folder}/log/scene.json"));
    let path = path.ok_or_else(|| ViewError::NoLog(folder.to_owned()))?;
    read_json(&path)
}

/// Regular files below a folder, without hidden ones (stages write theirs under such names). Links are not
/// followed.
fn list(folder: &Path, prefix: &str, depth: usize, files: &mut Vec<(String, u64)>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let Ok(name) = entry.file_name().into_string() else { continue };
        let Ok(metadata) = entry.metadata() else { continue };
        if name.starts_with('.') {
            continue;
        }
        let path = format!("{prefix}{name}");
        if metadata.is_dir() && depth > 1 {
            list(&entry.path(), &format!("{path}/"), depth - 1, files);
        } else if metadata.is_file() {
            files.push((path, metadata.len()));
        }
    }
}

fn read_json(path: &Path) -> Result<Value, ViewError> {
    let text = fs::read(path).map_err(of_file(path))?;
    serde_json::from_slice(&text).map_err(of_file(path))
}
