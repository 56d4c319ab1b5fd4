//! What files and folders are called.

use schema::{AgentId, AgentKind};

/// Cameras of vehicles in the order of writing; RSUs have the first three.
pub(super) const CAMERAS: [&str; 6] =
    ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT", "CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT"];
/// Radars of vehicles in the order of writing; RSUs have the second one.
pub(super) const RADARS: [&str; 4] = ["RAD_LEFT", "RAD_FRONT", "RAD_RIGHT", "RAD_BACK"];
pub(super) const LIDAR: &str = "LIDAR";
pub(super) const SEMANTIC_LIDAR: &str = "SEG-LIDAR";
pub(super) const VOXELS: &str = "VOXEL-GRID";
pub(super) const FILLED_VOXELS: &str = "VOXEL-GRID-FILLED";

/// Cameras that agents of a kind have here.
pub(super) fn cameras(kind: AgentKind) -> &'static [&'static str] {
    match kind {
        AgentKind::Vehicle => &CAMERAS,
        AgentKind::Rsu => &CAMERAS[..3],
    }
}

/// Radars that agents of a kind have here.
pub(super) fn radars(kind: AgentKind) -> &'static [&'static str] {
    match kind {
        AgentKind::Vehicle => &RADARS,
        AgentKind::Rsu => &RADARS[1..2],
    }
}

/// `vehicle` or `rsu`.
pub(super) fn word(kind: AgentKind) -> &'static str {
    match kind {
        AgentKind::Vehicle => "vehicle",
        AgentKind::Rsu => "rsu",
    }
}

/// What an agent's folders are called.
pub(super) fn folder(agent: AgentId) -> String {
    format!("{}-{}", word(agent.kind), agent.index)
}

fn stem(scene: u32, frame: u32) -> String {
    format!("SimBEV2X-scene-{scene:04}-frame-{frame:04}")
}

fn of_agent(scene: u32, frame: u32, agent: AgentId) -> String {
    format!("{}-{}-{:04}", stem(scene, frame), word(agent.kind), agent.index)
}

/// Ending of a sensor's files.
fn extension(sensor: &str) -> &'static str {
    match sensor.split('-').next().unwrap_or_default() {
        "RGB" => "jpg",
        "SEG" if sensor == SEMANTIC_LIDAR => "npz",
        "SEG" | "IST" | "DPT" => "png",
        "GNSS" | "IMU" => "bin",
        _ => "npz",
    }
}

/// A sensor's file, below the dataset's folder.
pub(super) fn sweep(scene: u32, frame: u32, agent: AgentId, sensor: &str) -> String {
    let (folder, stem, ext) = (folder(agent), of_agent(scene, frame, agent), extension(sensor));
    format!("simbev2x/sweeps/{folder}/{sensor}/{stem}-{sensor}.{ext}")
}

/// A label's file in a folder of the ground truth.
pub(super) fn label(scene: u32, frame: u32, agent: AgentId, place: &str, kind: &str, ext: &str) -> String {
    let (folder, stem) = (folder(agent), of_agent(scene, frame, agent));
    format!("simbev2x/ground-truth/{folder}/{place}/{stem}-{kind}.{ext}")
}

/// The masks of a frame.
pub(super) fn masks(scene: u32, frame: u32, agent: AgentId) -> String {
    label(scene, frame, agent, "seg", "GT_SEG", "npz")
}

/// The picture of the masks.
pub(super) fn mask_picture(scene: u32, frame: u32, agent: AgentId) -> String {
    label(scene, frame, agent, "seg_viz", "GT_SEG_VIZ", "jpg")
}

/// The boxes of a frame.
pub(super) fn boxes(scene: u32, frame: u32, agent: AgentId) -> String {
    label(scene, frame, agent, "det", "GT_DET", "bin")
}

/// The boxes of a frame before post-processing, once that has been done.
pub(super) fn old_boxes(scene: u32, frame: u32, agent: AgentId) -> String {
    label(scene, frame, agent, "old_det", "GT_DET", "bin")
}

/// The lane of a frame.
pub(super) fn lane(scene: u32, frame: u32, agent: AgentId) -> String {
    label(scene, frame, agent, "hd_map", "HD_MAP", "json")
}

/// The boxes of all agents.
pub(super) fn combined(scene: u32, frame: u32) -> String {
    format!("simbev2x/ground-truth/combined_det/{}-GT_DET_COMBINED.bin", stem(scene, frame))
}

/// The configuration of a scene.
pub(super) fn config(scene: u32) -> String {
    format!("simbev2x/configs/SimBEV2X-scene-{scene:04}.yaml")
}

/// The log of a scene.
pub(super) fn log(scene: u32) -> String {
    format!("simbev2x/logs/SimBEV2X-scene-{scene:04}.log")
}

/// The picture of a scene from above.
pub(super) fn overview(scene: u32) -> String {
    format!("simbev2x/scenario_images/Scene_{scene:04}.jpg")
}

/// The records of a split.
pub(super) fn infos(split: &str, state: &str) -> String {
    format!("simbev2x/infos/simbev2x_infos_{split}{state}.json")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_as_readers_look_for_them() {
        let (car, rsu) = (AgentId::vehicle(0), AgentId::rsu(12));
        assert_eq!(
            sweep(7, 13, car, "RGB-CAM_FRONT"),
            "simbev2x/sweeps/vehicle-0/RGB-CAM_FRONT/SimBEV2X-scene-0007-frame-0013-vehicle-0000-RGB-CAM_FRONT.jpg"
        );
        assert_eq!(
            masks(7, 13, rsu),
            "simbev2x/ground-truth/rsu-12/seg/SimBEV2X-scene-0007-frame-0013-rsu-0012-GT_SEG.npz"
        );
        assert_eq!(
            combined(7, 0),
            "simbev2x/ground-truth/combined_det/SimBEV2X-scene-0007-frame-0000-GT_DET_COMBINED.bin"
        );
        assert_eq!(overview(3), "simbev2x/scenario_images/Scene_0003.jpg");
        assert_eq!(infos("val", "_unprocessed"), "simbev2x/infos/simbev2x_infos_val_unprocessed.json");
    }

    #[test]
    fn endings_follow_the_kind() {
        for (sensor, ext) in [
            ("RGB-CAM_BACK", "jpg"),
            ("SEG-CAM_BACK", "png"),
            ("IST-CAM_BACK", "png"),
            ("DPT-CAM_BACK", "png"),
            ("FLW-CAM_BACK", "npz"),
            ("SEG-LIDAR", "npz"),
            ("LIDAR", "npz"),
            ("RAD_LEFT", "npz"),
            ("GNSS", "bin"),
            ("IMU", "bin"),
            ("VOXEL-GRID-FILLED", "npz"),
        ] {
            assert_eq!(extension(sensor), ext, "{sensor}");
        }
    }
}
