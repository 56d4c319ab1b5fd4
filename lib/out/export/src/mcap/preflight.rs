//! What of a store is not in the files, and why.

use scene::SensorKind;
use schema::ImageKind;
use schema::arrays::{
    ArrayKind, BEV_HEIGHTS, BEV_IDS, BEV_PAINT, FILLED_VOXEL_GRIDS, OBSERVED_VOXELS, VOXEL_CELLS, VOXEL_FLOW,
    VOXEL_GRIDS, VOXEL_IDS,
};
use schema::table::Row;
use schema::tables::{CameraRow, TrackRow, ValidBoxRow};

use super::options::McapOptions;
use crate::source::NO_MAP;
use crate::{ExportError, Omission, Source};

const NO_MESSAGE: &str = "there is no message that viewers show of it";
/// Arrays that are left out.
const ARRAYS: [(&ArrayKind, &str, &str); 7] = [
    (&BEV_PAINT, "paint in BEV", NO_MESSAGE),
    (&BEV_IDS, "objects of BEV cells", NO_MESSAGE),
    (&BEV_HEIGHTS, "heights of BEV cells", NO_MESSAGE),
    (&FILLED_VOXEL_GRIDS, "filled voxel grids", "from outside they look like the others"),
    (&OBSERVED_VOXELS, "which voxels lidars saw", NO_MESSAGE),
    (&VOXEL_IDS, "objects of voxels", "cells are joined to larger ones"),
    (&VOXEL_FLOW, "velocities of voxels", "cells are joined to larger ones"),
];

/// What these scenes have that is left out.
///
/// # Errors
/// The store cannot be read.
pub(crate) fn omissions(source: &Source, options: McapOptions) -> Result<Vec<Omission>, ExportError> {
    let mut found = vec![
        Omission::new(
            "lane records of agents, the map's lane graph, lamps, the log of all actors",
            NO_MESSAGE,
        ),
        Omission::new("angular velocities of boxes", "things that are drawn have no place for them"),
    ];
    let mut has_voxels = false;
    for scene in &source.scenes {
        for (stage, what) in [
            (CameraRow::STAGE, "sensors"),
            (ValidBoxRow::STAGE, "what sensors saw of boxes"),
            (TrackRow::STAGE, "merged boxes"),
        ] {
            if !scene.has(stage) {
                let why = format!("{stage} has not been run for scene {}", scene.number());
                found.push(Omission::new(what, why));
            }
        }
        if !scene.has_map()? {
            found.push(Omission::new(format!("the map of scene {}", scene.number()), NO_MAP));
        }
        for agent in scene.agents() {
            has_voxels |= scene.has_arrays(&VOXEL_GRIDS, *agent) || scene.has_arrays(&VOXEL_CELLS, *agent);
            for (kind, what, why) in ARRAYS {
                if scene.has_arrays(kind, *agent) {
                    found.push(Omission::new(what, why));
                }
            }
            if !scene.has(CameraRow::STAGE) {
                continue;
            }
            for sensor in scene.sensors(*agent)? {
                found.extend(match sensor.kind {
                    SensorKind::Image(ImageKind::Flow) => Some(Omission::sensor(&sensor, NO_MESSAGE)),
                    SensorKind::Image(ImageKind::Depth) if !options.depth => {
                        Some(Omission::sensor(&sensor, "large; --depth writes them as metres"))
                    }
                    SensorKind::Lidar | SensorKind::SemanticLidar => {
                        Some(Omission::new("cosines between lidar rays and surfaces", NO_MESSAGE))
                    }
                    SensorKind::Image(_) | SensorKind::Radar | SensorKind::Gnss | SensorKind::Imu => None,
                });
            }
            found.push(Omission::new("boxes in pictures", "viewers draw the 3-D boxes into pictures"));
        }
    }
    let McapOptions { voxel_range_m: range, voxel_block: block, .. } = options;
    if has_voxels && range > 0.0 {
        found.push(Omission::new(
            format!("voxels beyond {range} m, and {block} x {block} x {block} of them in one"),
            "whole grids are too large for viewers; --voxel-range and --voxel-block",
        ));
    } else if has_voxels {
        found.push(Omission::new("voxels", "--voxel-range is 0"));
    }
    found.sort();
    found.dedup();
    Ok(found)
}
