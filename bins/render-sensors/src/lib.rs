//! The sensor stage: what every agent's cameras, lidars, radars, GNSS and IMU gave, each at the frames of its
//! rate.

mod agent;
mod recorder;

use render::Renderer;
use render::cpu::CpuRenderer;
use replay::{Light, Replay};
use runner::frames::{FrameGroup, in_turn};
use runner::{At, Job, Place, Stage, StageError};
use scene::SceneReader;
use schema::ImageKind;
use sensors::{Cameras, GeoOrigin, SensorContext, SharedBeams};
use settings::Rig;
use settings::stages::SensorSettings;
use shading::CpuPainter;

use crate::agent::{AgentRig, Renderers, StaticWorld};

/// The stage.
pub const STAGE: Stage<SensorSettings> = Stage::new(run);

fn run(job: &mut Job<'_, SensorSettings>) -> Result<(), StageError> {
    let (settings, scene) = (job.settings().clone(), job.scene());
    let reader = SceneReader::new(job.store(), scene, job.inputs());
    let paints = |rig: &Rig| rig.camera.images.has(ImageKind::Rgb) && !rig.cameras.is_empty();
    let rigs = &settings.rigs;
    let mut all = [&rigs.vehicle, &rigs.rsu].into_iter().chain(rigs.own.iter().map(|(_, rig)| rig));
    let light = if all.any(paints) { Light::AmbientOcclusion } else { Light::Any };
    let replay = Replay::in_light(&reader, light).at(|| job.place())?;
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&replay.meshes()).at(|| job.place())?;
    let standing = StaticWorld(&replay);
    let painter = CpuPainter::new(&renderer, &standing);
    let eyes = Renderers { renderer: &renderer, painter: &painter };
    let agents = replay.log.agent_ids().to_vec();
    let frames = replay.log.frame_count();
    let geo_origin = geo_origin(&replay.log.info.geo_reference);
    let progress = job.progress();
    progress.set_total(u64::from(frames) * agents.len() as u64);

    let job = &*job;
    let parts = agents.iter().enumerate().filter_map(|(position, agent)| {
        let unit = job.unit(&agent.to_string()).transpose()?;
        let part = |unit| {
            let rig = settings.rigs.of(*agent);
            let carrier = SensorContext { seed: settings.seed, scene, agent: *agent, geo_origin };
            let (channels, writer) = recorder::open(unit, rig, &carrier)?;
            let cameras = Cameras::of(rig).at(|| Place::scene(scene).agent(*agent))?;
            let beams = SharedBeams::of(rig).at(|| Place::scene(scene).agent(*agent))?;
            let due = channels.due_frames(frames);
            let seen = AgentRig { replay: &replay, eyes, position, cameras, beams, channels };
            Ok(FrameGroup { due, seen, writer })
        };
        Some(unit.and_then(part))
    });
    in_turn(parts, frames, &progress, AgentRig::sense)
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
