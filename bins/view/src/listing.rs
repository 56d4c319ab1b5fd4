//! Lists: what is in the store, and what its numbers mean.

use schema::{BevClass, DetectionClass, FORMAT_VERSION, FRAME_PERIOD_S, Tag};
use serde_json::{Value, json};
use store::{Scope, keys, side_by_side};

use crate::error::ViewError;
use crate::predictions;
use crate::site::Site;

/// Stages whose manifests a finished scene has, in their order.
const STAGES: [&str; 6] =
    ["simulate-and-log", "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];
/// Objects of a scene lie so deep: `sensors/AGENT/FILE`.
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
pub(crate) fn store(site: &Site) -> Result<Value, ViewError> {
    let name = name(site)?.unwrap_or_else(|| site.folder());
    let mut folders = site.backend().folders("scenes")?;
    folders.retain(|folder| is_number(folder));
    let scenes = side_by_side(&folders, site.backend().at_once(), |folder| of_scene(site, folder))?;
    let scenes: Vec<Value> = scenes.into_iter().flatten().collect();
    let report = site.object("stats/report.html")?.is_some();
    Ok(json!({ "name": name, "scenes": scenes, "report": report, "predictions": predictions::about(site) }))
}

/// A scene of the list, if it has a log.
fn of_scene(site: &Site, folder: &str) -> Result<Option<Value>, ViewError> {
    let info = match scene_info(site, folder) {
        // A place that is away has no list.
        Err(ViewError::Store(error)) if error.is_transient() => return Err(error.into()),
        Err(_) => return Ok(None),
        Ok(info) => info,
    };
    let word = |key: &str| info[key].as_str().unwrap_or("?").to_owned();
    let manifests = format!("scenes/{folder}/_manifests/");
    let there = site.backend().keys(manifests.trim_end_matches('/'))?;
    let missing: Vec<&str> =
        STAGES.into_iter().filter(|stage| !there.contains(&format!("{manifests}{stage}.json"))).collect();
    Ok(Some(json!({
        "folder": folder,
        "title": format!("{folder} · {} · {}", word("split"), word("map")),
        "missing": missing,
    })))
}

/// Whether a folder is that of a scene.
pub(crate) fn is_number(folder: &str) -> bool {
    !folder.is_empty() && folder.bytes().all(|byte| byte.is_ascii_digit())
}

/// The dataset's name, if its configuration has one.
///
/// # Errors
/// `dataset.json` cannot be read.
pub(crate) fn name(site: &Site) -> Result<Option<String>, ViewError> {
    let dataset = site.json(keys::DATASET)?.unwrap_or_default();
    Ok(dataset["config"]["name"].as_str().map(str::to_owned))
}

/// A scene's facts and objects with their sizes.
///
/// # Errors
/// There is no such scene, or it has no log yet.
pub(crate) fn scene(site: &Site, folder: &str) -> Result<Value, ViewError> {
    let info = scene_info(site, folder)?;
    let start = format!("scenes/{folder}");
    let objects = site.backend().list(&start)?.objects;
    let files: Vec<Value> = objects
        .iter()
        .filter_map(|object| Some((object.key.strip_prefix(&start)?.strip_prefix('/')?, object.bytes)))
        .filter(|(path, _)| {
            path.split('/').count() <= DEPTH && !path.split('/').any(|name| name.starts_with('.'))
        })
        .map(|(path, bytes)| json!([path, bytes]))
        .collect();
    let map =
        info["map"].as_str().map(|map| site.object(&format!("maps/{map}.vector.parquet"))).transpose()?;
    let map_bytes = map.flatten().map_or(0, |map| map.size());
    let stale = made_from_another_log(site, folder);
    Ok(json!({ "info": info, "files": files, "map_bytes": map_bytes, "stale": stale }))
}

/// Stages that were made from another log than the one that is there: what they made may not fit it.
fn made_from_another_log(site: &Site, folder: &str) -> Vec<&'static str> {
    let Ok(number) = folder.parse() else { return Vec::new() };
    // A manifest that cannot be read says nothing here: `verify` names it.
    let manifest = |stage: &str| site.store().manifest(Scope::Scene(number), stage).ok().flatten();
    let [first, later @ ..] = STAGES;
    let Some(log) = manifest(first).map(|log| log.digest()) else { return Vec::new() };
    let is_stale = |stage: &&str| {
        manifest(stage).and_then(|made| made.inputs.get(first).cloned()).is_some_and(|from| from != log)
    };
    later.into_iter().filter(is_stale).collect()
}

pub(crate) fn scene_info(site: &Site, folder: &str) -> Result<Value, ViewError> {
    let info = site.json(&format!("scenes/{folder}/log/scene.json"))?;
    info.ok_or_else(|| ViewError::NoLog(folder.to_owned()))
}
