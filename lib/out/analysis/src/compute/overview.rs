//! The dataset in a dozen numbers.

use schema::measures;
use schema::scene_info::SceneInfo;

use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

pub(super) fn overview(scenes: &[&SceneInfo], planned: u64, counts: &MeasureTotals) -> Table {
    let mut maps: Vec<&str> = scenes.iter().map(|scene| scene.map.as_str()).collect();
    maps.sort_unstable();
    maps.dedup();
    let frames: u64 = scenes.iter().map(|scene| u64::from(scene.frames)).sum();
    let seconds = frames as f64 * schema::FRAME_PERIOD_S;
    let of_kind = |kind: &str| {
        let agents = counts.agents(measures::simulation::AGENT_FRAMES, "");
        agents.filter(|(agent, _)| agent.starts_with(kind)).map(|(_, n)| n).fold(0, u64::saturating_add)
    };
    let covered = scenes.len() as u64;
    let mut rows = vec![("scenes", covered)];
    rows.extend((covered < planned).then_some(("planned_scenes", planned)));
    rows.extend([
        ("maps", maps.len() as u64),
        ("frames", frames),
        ("recorded_time_s", seconds.round() as u64),
    ]);
    // What no stage has counted yet is left out rather than shown as 0.
    let optional = [
        (
            measures::simulation::AGENT_FRAMES,
            "agent_frames",
            counts.total(measures::simulation::AGENT_FRAMES),
        ),
        (measures::simulation::AGENT_FRAMES, "vehicle_frames", of_kind("vehicle_")),
        (measures::simulation::AGENT_FRAMES, "rsu_frames", of_kind("rsu_")),
        (measures::sensors::IMAGES, "images", counts.total(measures::sensors::IMAGES)),
        (measures::sensors::LIDAR_POINTS, "lidar_points", counts.total(measures::sensors::LIDAR_POINTS)),
        (measures::sensors::RADAR_POINTS, "radar_points", counts.total(measures::sensors::RADAR_POINTS)),
        (measures::tracks::BOXES, "boxes", counts.total(measures::tracks::BOXES)),
        (measures::tracks::BOXES_VALID, "valid_boxes", counts.total(measures::tracks::BOXES_VALID)),
        (measures::bev::BEV_GRIDS, "bev_grids", counts.total(measures::bev::BEV_GRIDS)),
        (measures::voxels::VOXEL_GRIDS, "voxel_grids", counts.total(measures::voxels::VOXEL_GRIDS)),
        (measures::sensors::SENSOR_BYTES, "sensor_bytes", counts.total(measures::sensors::SENSOR_BYTES)),
    ];
    rows.extend(optional.into_iter().filter(|(m, ..)| counts.has(m)).map(|(_, name, n)| (name, n)));
    Table::new("overview", Section::Overview, "Size of the dataset", "")
        .with_strings("quantity", rows.iter().map(|(name, _)| *name))
        .with_counts("value", rows.iter().map(|(_, value)| *value))
}
