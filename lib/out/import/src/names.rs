//! What sensors are called, and which agents have them.

use schema::{AgentKind, ImageKind, SensorKind};

pub(crate) const LIDAR: &str = "LIDAR";
pub(crate) const SEMANTIC_LIDAR: &str = "SEG-LIDAR";
pub(crate) const VOXELS: &str = "VOXEL-GRID";
pub(crate) const FILLED_VOXELS: &str = "VOXEL-GRID-FILLED";
pub(crate) const MASKS: &str = "GT_SEG";
pub(crate) const BOXES: &str = "GT_DET";
pub(crate) const LANES: &str = "HD_MAP";
pub(crate) const COMBINED: &str = "GT_DET_COMBINED";
pub(crate) const GNSS: &str = "GNSS";
pub(crate) const IMU: &str = "IMU";
const CAMERAS: [&str; 6] =
    ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT", "CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT"];
const RADARS: [&str; 4] = ["RAD_LEFT", "RAD_FRONT", "RAD_RIGHT", "RAD_BACK"];

/// Cameras of agents of a kind.
pub(crate) fn cameras(kind: AgentKind) -> &'static [&'static str] {
    match kind {
        AgentKind::Vehicle => &CAMERAS,
        AgentKind::Rsu => &CAMERAS[..3],
    }
}

/// Radars of agents of a kind.
pub(crate) fn radars(kind: AgentKind) -> &'static [&'static str] {
    match kind {
        AgentKind::Vehicle => &RADARS,
        AgentKind::Rsu => &RADARS[1..2],
    }
}

/// The sensor of an agent of a kind that a key names; none where it names no sensor that the layout has.
pub(crate) fn sensor_of(kind: AgentKind, key: &str) -> Option<SensorKind> {
    match key {
        LIDAR => return Some(SensorKind::Lidar),
        SEMANTIC_LIDAR => return Some(SensorKind::SemanticLidar),
        GNSS => return Some(SensorKind::Gnss),
        IMU => return Some(SensorKind::Imu),
        _ if radars(kind).contains(&key) => return Some(SensorKind::Radar),
        _ => {}
    }
    let (prefix, camera) = key.split_once('-')?;
    if !cameras(kind).contains(&camera) {
        return None;
    }
    ImageKind::ALL.iter().copied().find(|image| image.spec().prefix == prefix).map(SensorKind::Image)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_tell_sensors() {
        use AgentKind::{Rsu, Vehicle};
        assert_eq!(sensor_of(Vehicle, "RGB-CAM_BACK"), Some(SensorKind::Image(ImageKind::Rgb)));
        assert_eq!(sensor_of(Rsu, "RGB-CAM_BACK"), None, "RSUs look ahead");
        assert_eq!(sensor_of(Vehicle, "SEG-LIDAR"), Some(SensorKind::SemanticLidar));
        assert_eq!(sensor_of(Vehicle, "SEG-CAM_FRONT"), Some(SensorKind::Image(ImageKind::Semantic)));
        assert_eq!(
            (sensor_of(Rsu, "RAD_FRONT"), sensor_of(Rsu, "RAD_BACK")),
            (Some(SensorKind::Radar), None)
        );
        for key in ["GT_SEG", "GT_DET", "VOXEL-GRID", "HD_MAP", "RGB-CAM_SIDE", "LIDAR-2"] {
            assert_eq!(sensor_of(Vehicle, key), None, "{key}");
        }
    }
}
