//! What a file will come to: bytes of what it is made from, and seconds as measured.

use scene::SensorKind;
use schema::arrays::{BEV_MASKS, VOXEL_CELLS, VOXEL_GRIDS};
use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, ImageKind};
use store::keys;

use super::options::McapOptions;
use super::tracks::pictures;
use crate::{Cost, ExportError, SceneSource};

/// Bytes in a file for a byte in the store, and seconds for a megabyte in the store.
struct Rate {
    bytes: f64,
    s_per_mb: f64,
}

const PICTURES: Rate = Rate { bytes: 1.0, s_per_mb: 0.002 };
const CLOUDS: Rate = Rate { bytes: 1.2, s_per_mb: 0.014 };
const DEPTHS: Rate = Rate { bytes: 2.0, s_per_mb: 0.05 };
const MASKS: Rate = Rate { bytes: 1.5, s_per_mb: 0.6 };
const VOXELS: Rate = Rate { bytes: 0.02, s_per_mb: 0.05 };
/// Poses, boxes and other small things of an agent's frame.
const SMALL_BYTES: u64 = 16_000;
const SMALL_S: f64 = 0.002;

/// What the file of a scene comes to.
///
/// # Errors
/// The store cannot be read.
pub(crate) fn of_scene(scene: &SceneSource, options: McapOptions) -> Result<Cost, ExportError> {
    let mut total = Cost::default();
    let share = f64::from(scene.frame_count()) / f64::from(scene.info().frames.max(1));
    let mut add = |bytes: u64, rate: &Rate| {
        let taken = bytes as f64 * share;
        total.bytes += (taken * rate.bytes) as u64;
        total.cpu_s += taken * 1e-6 * rate.s_per_mb;
    };
    for agent in scene.agents() {
        if scene.has(CameraRow::STAGE) {
            for sensor in scene.sensors(*agent)? {
                match sensor.kind {
                    SensorKind::Image(ImageKind::Depth) if options.depth => add(sensor.bytes, &DEPTHS),
                    SensorKind::Image(kind) if pictures::topic_of(kind).is_some() => {
                        add(sensor.bytes, &PICTURES);
                    }
                    SensorKind::Image(_) => {}
                    SensorKind::Lidar | SensorKind::SemanticLidar | SensorKind::Radar => {
                        add(sensor.bytes, &CLOUDS);
                    }
                    // A few numbers a frame.
                    SensorKind::Gnss | SensorKind::Imu => {}
                }
            }
        }
        add(array_bytes(scene, *agent, &[&BEV_MASKS]), &MASKS);
        if options.voxel_range_m > 0.0 {
            add(array_bytes(scene, *agent, &[&VOXEL_GRIDS, &VOXEL_CELLS]), &VOXELS);
        }
    }
    let agent_frames = u64::from(scene.frame_count()) * scene.agents().len() as u64;
    total += Cost { agent_frames, bytes: SMALL_BYTES * agent_frames, cpu_s: SMALL_S * agent_frames as f64 };
    Ok(total)
}

/// Bytes of an agent's archives.
fn array_bytes(scene: &SceneSource, agent: AgentId, kinds: &[&schema::arrays::ArrayKind]) -> u64 {
    let bytes = |kind: &&schema::arrays::ArrayKind| {
        let manifest = scene.reader().manifest(kind.stage).ok()?;
        Some(manifest.output(&keys::array(scene.number(), kind, agent))?.bytes)
    };
    kinds.iter().filter_map(bytes).sum()
}
