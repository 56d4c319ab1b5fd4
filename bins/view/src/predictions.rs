//! What a model found, held against the boxes of the store as `evaluate` does it.

use std::path::Path;

use evaluation::{Sample, ScenePairs, SeenBy, THRESHOLDS_M};
use scene::SceneReader;
use schema::DetectionClass;
use schema::table::Row;
use schema::tables::{AgentRow, ValidBoxRow};
use serde_json::{Value, json};

use crate::error::ViewError;
use crate::site::Site;

/// Whose sight makes a box a target: `evaluate`'s default.
const COMM_RANGE_M: f64 = 80.0;
const ELEVATION_M: f64 = 4.8;

/// What there is of predictions: the file's name, its modes and scenes; null without any.
pub(crate) fn about(site: &Site) -> Value {
    let Some(file) = site.predictions() else { return Value::Null };
    let name = Path::new(file.path()).file_name().map(|name| name.to_string_lossy().into_owned());
    json!({
        "file": name,
        "modes": file.modes().map(|mode| mode.name()).collect::<Vec<_>>(),
        "scenes": file.scenes().collect::<Vec<_>>(),
        "thresholds_m": THRESHOLDS_M,
        "comm_range_m": COMM_RANGE_M,
        "elevation_m": ELEVATION_M,
    })
}

/// The predictions of a scene with what each found.
///
/// # Errors
/// There are no predictions or no such scene; it is not finished, or something cannot be read.
pub(crate) fn of_scene(site: &Site, folder: &str) -> Result<Value, ViewError> {
    let file = site.predictions().ok_or(ViewError::NoPredictions)?;
    let number = folder.parse().map_err(|_| ViewError::NoScene)?;
    let scene = SceneReader::open(site.store(), number, &[AgentRow::STAGE, ValidBoxRow::STAGE])?;
    let seen = SeenBy::Partners { range_m: COMM_RANGE_M, elevation_m: ELEVATION_M };
    let pairs = ScenePairs::read(&scene, file, seen)?;
    Ok(json!({
        "every_n_frames": pairs.every_n_frames,
        "samples": pairs.samples.iter().map(of_sample).collect::<Vec<_>>(),
    }))
}

/// A frame of an ego: lists with an entry for each target, or for each prediction. Classes are numbers of the
/// list of names; `found` has an id for each threshold, 0 is nothing.
fn of_sample(sample: &Sample) -> Value {
    let Sample { frame, ego, mode, targets, predictions } = sample;
    let class_of = |class: DetectionClass| DetectionClass::ALL.iter().position(|c| *c == class);
    json!({
        "frame": frame,
        "agent": ego.to_string(),
        "mode": mode.name(),
        "targets": targets.iter().map(|(id, _)| *id).collect::<Vec<_>>(),
        "target_classes": targets.iter().map(|(_, class)| class_of(*class)).collect::<Vec<_>>(),
        "classes": predictions.iter().map(|p| class_of(p.class)).collect::<Vec<_>>(),
        "scores": predictions.iter().map(|p| p.score).collect::<Vec<_>>(),
        "centers_m": predictions.iter().map(|p| p.solid.center_m.map(to_millimeters)).collect::<Vec<_>>(),
        "sizes_m": predictions.iter().map(|p| p.solid.size_m.map(to_millimeters)).collect::<Vec<_>>(),
        "yaws_rad": predictions.iter().map(|p| to_millimeters(p.solid.yaw_rad)).collect::<Vec<_>>(),
        "found": predictions.iter().map(|p| p.found.map(|id| id.unwrap_or(0))).collect::<Vec<_>>(),
    })
}

/// As far as a screen shows it: the list stays half as long.
fn to_millimeters(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
