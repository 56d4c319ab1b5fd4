//! Which sensors an agent of a scene has.

use schema::calibration::{Calibration, METADATA_KEY};
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, SensorKind};
use store::keys;

use crate::{SceneError, SceneReader};

/// A sensor of an agent: one table.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorEntry {
    /// Name of its table (`LIDAR`, `RGB-CAM_FRONT`), as [`crate::SensorFrames`] takes it.
    pub name: String,
    /// What its table holds.
    pub kind: SensorKind,
    /// What its table says of it: pose, rate, intrinsics.
    pub about: Calibration,
    /// Bytes of its table.
    pub bytes: u64,
}

impl SensorEntry {
    /// Name of the camera, of images.
    #[must_use]
    pub fn camera(&self) -> Option<&str> {
        match self.kind {
            SensorKind::Image(kind) => self.name.strip_prefix(kind.spec().prefix)?.strip_prefix('-'),
            _ => None,
        }
    }
}

/// The sensors of an agent that have tables, by name.
///
/// # Errors
/// The sensors' stage has not made its part, or a table cannot be read.
pub fn sensors_of(scene: &SceneReader, agent: AgentId) -> Result<Vec<SensorEntry>, SceneError> {
    let manifest = scene.manifest(CameraRow::STAGE)?;
    let folder = keys::scene(scene.scene(), &format!("sensors/{agent}/"));
    let mut sensors = Vec::new();
    for output in &manifest.outputs {
        let Some(name) = output.key.strip_prefix(&folder).and_then(|name| name.strip_suffix(".parquet"))
        else {
            continue;
        };
        // Tables that are no sensor's own (`visible`) say nothing of one.
        let head = scene.store().table_head(manifest, &output.key, METADATA_KEY)?;
        let Some(text) = head.metadata else { continue };
        let path = || scene.store().location(&output.key);
        let about: Calibration =
            serde_json::from_str(&text).map_err(|source| SceneError::Calibration { path: path(), source })?;
        if let Some(kind) = SensorKind::of_table(name, &head.columns) {
            sensors.push(SensorEntry { name: name.to_owned(), kind, about, bytes: output.bytes });
        }
    }
    sensors.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(sensors)
}
