//! Draws fast traffic on a wet street, through drops on the lens, at some frames:
//! `cargo run -p convoy-sensors --example rain -- FOLDER`.

#[path = "../tests/sensors/common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use catalogue::models;
use frames::{Agent, Pose, World, deg};
use glam::{Affine3A, Vec3};
use meshes::actors::{Posture, actor_mesh};
use render::Renderer;
use schema::geometry::{Instance, Snapshot};
use schema::tables::Weather;
use schema::{AgentId, FRAME_PERIOD_S, ImageKind, ImageSet, lights};
use sensors::{AgentState, Cameras, GeoOrigin, Motion, Observation, Sensor, SensorContext, SensorVisitor};
use settings::{CameraSettings, CameraSpec, Mount, Rig};
use shading::{CpuPainter, FrameWeather};

/// Model, place along and across the street, speed (metres a second), and whether it comes towards the
/// camera.
const TRAFFIC: [(&str, f32, f32, f32, bool); 4] = [
    ("car.sedan", 12.0, -1.8, 24.0, false),
    ("truck.box", 34.0, -1.8, 22.0, false),
    ("car.suv", 21.0, 1.9, 26.0, true),
    ("van.delivery", 55.0, 1.9, 14.0, true),
];

/// Keeps the first column of bytes of colour images.
struct Kept<'a> {
    at: &'a Observation<'a>,
    images: Vec<Vec<u8>>,
}

impl SensorVisitor for Kept<'_> {
    type Error = sensors::SensorError;

    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), Self::Error> {
        use schema::table::{Column, Row};
        for column in S::Row::to_columns(&sensor.sense(self.at)?) {
            if let Column::Bytes(images) = column {
                self.images.extend(images);
            }
        }
        Ok(())
    }
}

/// The street with fast traffic on it, whose clocks are at a time.
fn scene(night: bool) -> Snapshot {
    let street = common::street(night);
    let mut meshes = street.meshes.to_vec();
    // Without its own moving cars.
    let mut instances: Vec<Instance> = street.instances;
    instances.retain(|i| i.local_from_object == i.previous_local_from_object);
    for (number, (name, x, y, mps, comes)) in TRAFFIC.into_iter().enumerate() {
        let Some(model) = models::find(name) else { continue };
        let Some(made) = actor_mesh(name, model.size_m, 0) else { continue };
        let made = made.with_ambient_occlusion();
        let at = common::at(x, y, 0.0, if comes { std::f32::consts::PI } else { 0.0 });
        let step = Affine3A::from_translation(Vec3::X * (-mps * FRAME_PERIOD_S as f32));
        let posture = made.posed(Posture::default());
        let burn = lights::LOW_BEAM | lights::POSITION;
        for piece in &made.pieces {
            let Some(pose) = piece.joint.object_from_piece(&posture) else { continue };
            instances.push(Instance {
                previous_local_from_object: at * step * pose,
                paint: [[0.5, 0.02, 0.02], [0.7; 3], [0.05, 0.1, 0.3], [0.6; 3]][number],
                lights: burn,
                ..common::instance(meshes.len() as u32, 900 + number as u16, at * pose)
            });
            meshes.push(Arc::clone(&piece.mesh));
        }
    }
    common::snapshot(meshes, instances)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    let rain = Weather {
        sun_azimuth_deg: 150.0,
        sun_altitude_deg: 42.0,
        cloudiness: 95.0,
        precipitation: 70.0,
        wetness: 80.0,
        precipitation_deposits: 40.0,
        fog_density: 4.0,
        ..Weather::default()
    };
    let dried = Weather {
        cloudiness: 30.0,
        precipitation: 0.0,
        precipitation_deposits: 10.0,
        fog_density: 0.0,
        ..rain
    };
    let night = Weather { sun_altitude_deg: -30.0, ..rain };
    for (name, weather, drops) in
        [("spray", rain, 0.0), ("after-rain", dried, 0.0), ("drops", rain, 1.0), ("night", night, 1.0)]
    {
        let snapshot = scene(weather.is_night());
        let mut renderer = render::cpu::CpuRenderer::default();
        renderer.prepare(&snapshot.meshes)?;
        let placed = renderer.place(&snapshot)?;
        let camera = CameraSettings {
            lens_drops: drops,
            images: ImageSet::of(&[ImageKind::Rgb]),
            ..CameraSettings::default()
        };
        let spec = CameraSpec {
            name: "CAM".into(),
            mount: Mount::upright([0.6, 0.0, 1.6], 0.0),
            optics: common::optics(1600, 900),
        };
        let rig = Rig { camera, cameras: vec![spec], lidars: Vec::new(), radars: Vec::new(), ..Rig::rsu() };
        let pose = Pose::<World, Agent>::from_xyz_rpy([0.0, -2.6, 0.0], [0.0, 0.0, deg(3.0)]);
        let still = Motion {
            world_from_agent: pose,
            velocity_mps: nalgebra::Vector3::zeros(),
            angular_velocity_radps: nalgebra::Vector3::zeros(),
        };
        let painter = CpuPainter::default();
        for frame in if drops > 0.0 { vec![40, 44, 80] } else { vec![40, 41] } {
            let when =
                FrameWeather { frame, time_s: f64::from(frame) * FRAME_PERIOD_S, weather, is_steady: true };
            let agent = AgentState { own: 1, motion: still, previous: Some(still) };
            let cameras = Cameras::of(&rig)?;
            let at = Observation::new(&*placed, Some(&painter), &cameras, &when, agent)?;
            let carrier = SensorContext {
                seed: 3,
                scene: 1,
                agent: AgentId::vehicle(0),
                geo_origin: GeoOrigin::default(),
            };
            let mut kept = Kept { at: &at, images: Vec::new() };
            sensors::visit_sensors(&rig, &carrier, &mut kept)?;
            for image in kept.images {
                std::fs::write(folder.join(format!("{name}-{frame}.jpg")), image)?;
            }
        }
    }
    Ok(())
}
