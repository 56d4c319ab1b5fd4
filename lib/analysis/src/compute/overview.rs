//! The dataset in a dozen numbers.

use schema::measures;
use schema::scene_info::SceneInfo;

use crate::counts::Counts;
use crate::table::{Section, Table};

pub(super) fn overview(scenes: &[&SceneInfo], counts: &Counts, frames: u64) -> Table {
    let mut maps: Vec<&str> = scenes.iter().map(|scene| scene.map.as_str()).collect();
    maps.sort_unstable();
    maps.dedup();
    let seconds = frames as f64 * schema::FRAME_PERIOD_S;
    let of_kind = |kind: &str| {
        let agents = counts.agents(measures::AGENT_FRAMES, "");
        agents.filter(|(agent, _)| agent.starts_with(kind)).map(|(_, n)| n).fold(0, u64::saturating_add)
    };
    let mut rows = vec![
        ("scenes", scenes.len() as u64),
        ("maps", maps.len() as u64),
        ("frames", frames),
        ("recorded_time_s", seconds.round() as u64),
    ];
    // What no stage has counted yet is left out rather than shown as 0.
    let optional = [
        (measures::AGENT_FRAMES, "agent_frames", counts.total(measures::AGENT_FRAMES)),
        (measures::AGENT_FRAMES, "vehicle_frames", of_kind("vehicle_")),
        (measures::AGENT_FRAMES, "rsu_frames", of_kind("rsu_")),
        (measures::IMAGES, "images", counts.total(measures::IMAGES)),
        (measures::LIDAR_POINTS, "lidar_points", counts.total(measures::LIDAR_POINTS)),
        (measures::RADAR_POINTS, "radar_points", counts.total(measures::RADAR_POINTS)),
        (measures::BOXES, "boxes", counts.total(measures::BOXES)),
        (measures::BOXES_VALID, "valid_boxes", counts.total(measures::BOXES_VALID)),
        (measures::BEV_GRIDS, "bev_grids", counts.total(measures::BEV_GRIDS)),
        (measures::VOXEL_GRIDS, "voxel_grids", counts.total(measures::VOXEL_GRIDS)),
        (measures::SENSOR_BYTES, "sensor_bytes", counts.total(measures::SENSOR_BYTES)),
    ];
    rows.extend(optional.into_iter().filter(|(m, ..)| counts.has(m)).map(|(_, name, n)| (name, n)));
    Table::new("overview", Section::Overview, "Size of the dataset", "")
        .with_strings("quantity", rows.iter().map(|(name, _)| *name))
        .with_counts("value", rows.iter().map(|(_, value)| *value))
}
