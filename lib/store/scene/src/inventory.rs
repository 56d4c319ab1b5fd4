//! Which sensors an agent of a scene has.

use schema::calibration::{Calibration, METADATA_KEY};
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, ImageKind, SensorKind};
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
        if let Some(kind) = kind_of(name, &head.columns) {
            sensors.push(SensorEntry { name: name.to_owned(), kind, about, bytes: output.bytes });
        }
    }
    sensors.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(sensors)
}

/// The kind of a table by its columns; names tell only what has the same columns apart.
fn kind_of(name: &str, columns: &[String]) -> Option<SensorKind> {
    let has = |column: &str| columns.iter().any(|c| c == column);
    if has("image") || has("dx") {
        let kind = ImageKind::ALL
            .iter()
            .find(|kind| name.strip_prefix(kind.spec().prefix).is_some_and(|camera| camera.starts_with('-')));
        return kind.copied().map(SensorKind::Image);
    }
    let kinds = [
        ("depth", SensorKind::Radar),
        ("latitude_deg", SensorKind::Gnss),
        ("compass_rad", SensorKind::Imu),
        ("ring", if name.starts_with("SEG-") { SensorKind::SemanticLidar } else { SensorKind::Lidar }),
    ];
    kinds.into_iter().find(|(column, _)| has(column)).map(|(_, kind)| kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_tell_the_kind() {
        let kind = |name: &str, columns: &[&str]| {
            kind_of(name, &columns.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>())
        };
        assert_eq!(kind("SEG-CAM", &["frame", "image"]), Some(SensorKind::Image(ImageKind::Semantic)));
        assert_eq!(kind("FLW-CAM", &["frame", "dx", "dy"]), Some(SensorKind::Image(ImageKind::Flow)));
        assert_eq!(kind("SEG-CAM", &["x", "ring"]), Some(SensorKind::SemanticLidar));
        assert_eq!(kind("TOP", &["x", "ring"]), Some(SensorKind::Lidar));
        assert_eq!(kind("FRONT", &["depth", "azimuth"]), Some(SensorKind::Radar));
        assert_eq!(kind("boxes_2d", &["frame", "pixels"]), None);
    }
}
