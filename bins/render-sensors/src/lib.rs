//! The sensor stage: what every agent's cameras, lidars, radars, GNSS and IMU gave, each at the frames of its
//! rate.

mod agent;
mod due;
mod probe;
mod recorder;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::process::ExitCode;

use device::{Choice, Device, Work};
use render::Renderer;
use replay::{Light, Replay};
use runner::frames::{FrameGroup, Writer, in_turn};
use runner::{At, DeviceOptions, Job, Outlook, Place, Stage, StageError};
use scene::SceneReader;
use sensors::{Cameras, GeoOrigin, Radars, SensorContext, SharedBeams};
use settings::stages::SensorSettings;

use crate::agent::{AgentRig, Renderers, SIGHT_M, StaticWorld};
use crate::due::{AgentTables, has_colour};

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    probe::answer(&words).unwrap_or_else(|| arguments::stage::run(words, STAGE, build_stamp::STAMP))
}

/// The stage.
const STAGE: Stage<SensorSettings> = Stage { open: Some(open), ..Stage::new(run) };

/// Opens the device that looks at all scenes; its name, if it is a GPU.
fn open(outlook: &Outlook<'_, SensorSettings>) -> Result<Option<String>, StageError> {
    let DeviceOptions { name, memory_bytes } = outlook.device;
    let choice = Choice::from(&**name);
    let open = || Device::open(&choice, *memory_bytes).map_err(|e| StageError::usage(e.to_string()));
    outlook.prepared.get_or_make(open).map(Device::name)
}

fn run(job: &mut Job<'_, SensorSettings>) -> Result<(), StageError> {
    let (job, scene) = (&*job, job.scene());
    let reader = SceneReader::new(job.store(), scene, job.inputs());
    let agents = reader.agents().at(|| job.place())?;
    let open = AgentTables::open(job, &agents)?;
    let due: Vec<BTreeSet<String>> =
        open.iter().map(|(_, agent, tables)| tables.due(scene, *agent)).collect();
    let geo_origin = geo_origin(&reader.info().at(|| job.place())?.geo_reference);
    let carrier = |agent| SensorContext { seed: job.settings().seed, scene, agent, geo_origin };
    if due.iter().all(BTreeSet::is_empty) {
        for (_, agent, tables) in open {
            let rig = job.settings().rigs.of(agent);
            let (_, writer) = recorder::open(tables, rig, &carrier(agent))?;
            writer.finish()?;
        }
        return Ok(());
    }
    let light = if due.iter().any(has_colour) { Light::AmbientOcclusion } else { Light::Any };
    let mut replay = Replay::in_light(&reader, light).at(|| job.place())?;
    replay.add_horizon(SIGHT_M);
    let device = job.prepared().get_or_make(|| Ok(Device::Cpu))?;
    let mut renderer = device.renderer();
    renderer.prepare(&replay.meshes()).at(|| job.place())?;
    let standing = StaticWorld(&replay);
    let painter = renderer.painter(Some(&standing));
    let eyes = Renderers { renderer: &renderer, painter: &*painter };
    let frames = replay.log.frame_count();
    let progress = job.progress();
    progress.set_total(u64::from(frames) * open.len() as u64);
    let parts = open.into_iter().zip(due).map(|((position, agent, tables), due)| {
        let (rig, here) = (job.settings().rigs.of(agent), || Place::scene(scene).agent(agent));
        let (channels, writer) = recorder::open(tables, rig, &carrier(agent))?;
        let is_due = |name: &str| due.contains(name);
        let cameras = Cameras::for_tables(rig, is_due).at(here)?;
        let beams = SharedBeams::for_tables(rig, is_due).at(here)?;
        let radars = Radars::for_tables(rig, |name| carrier(agent).stream(name), is_due);
        let due = channels.due_frames(frames);
        let seen = AgentRig { replay: &replay, eyes, position, cameras, beams, radars, channels };
        Ok(FrameGroup { due, seen, writer })
    });
    in_turn(parts, frames, &progress, AgentRig::sense)?;
    tell(scene, renderer.work());
    Ok(())
}

/// Says what a GPU did for a scene.
fn tell(scene: u32, work: Option<Work>) {
    let Some(Work { views, rays, calls, kernel_ns, told_bytes, answered_bytes }) = work else { return };
    tracing::info!(
        "scene {scene:04}: {} views and {} rays by the GPU, {} and {} by the CPU; {calls} calls, kernels {:.2} s, \
         {} MiB there, {} MiB back",
        views.by_gpu,
        rays.by_gpu,
        views.by_cpu,
        rays.by_cpu,
        kernel_ns as f64 * 1e-9,
        told_bytes >> 20,
        answered_bytes >> 20,
    );
}

/// Where the map's origin is on the globe, as far as its projection text says (`+lat_0`, `+lon_0`).
fn geo_origin(projection: &str) -> GeoOrigin {
    let number = |name: &str| {
        projection
            .split_whitespace()
            .find_map(|word| word.strip_prefix(name))
            .and_then(|value| value.parse::<f64>().ok())
            .filter(|value| value.is_finite())
    };
    let latitude_deg = number("+lat_0=").filter(|lat| lat.abs() < 85.0).unwrap_or(0.0);
    let longitude_deg = number("+lon_0=").filter(|lon| lon.abs() <= 180.0).unwrap_or(0.0);
    GeoOrigin { latitude_deg, longitude_deg, altitude_m: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_on_the_globe_is_read_from_the_projection() {
        let of = |text: &str| {
            let GeoOrigin { latitude_deg, longitude_deg, altitude_m } = geo_origin(text);
            assert_eq!(altitude_m, 0.0, "{text}");
            [latitude_deg, longitude_deg]
        };
        assert_eq!(of("+proj=tmerc +lat_0=48.9977 +lon_0=-8.0026 +k=1 +datum=WGS84"), [48.9977, -8.0026]);
        // In any order, and each by itself.
        assert_eq!(of("  +lon_0=1.8e2\n+lat_0=-84.5"), [-84.5, 180.0]);
        assert_eq!(of("+proj=utm +lon_0=9"), [0.0, 9.0]);
        // What is no place on the globe counts as nothing; the projection fails near the poles.
        for text in
            ["", "lat_0=4 lon_0=5", "+lat_0= +lon_0=east", "+lat_0=NaN +lon_0=inf", "+lat_0=85 +lon_0=180.5"]
        {
            assert_eq!(of(text), [0.0, 0.0], "{text}");
        }
    }
}
