//! Time of each part of an agent's frame on a small street; `visibility` has its own benches.

#[path = "../tests/common/mod.rs"]
mod common;

use divan::Bencher;
use frames::{Agent, Pose, World};
use glam::Vec3;
use random::Stream;
use schema::settings::{CameraSettings, LidarSpec, Mount, Rig};
use schema::tables::Weather;
use sensors::{CameraFrame, CameraView, Lidar, Lighting, Picture, RadarMotion, Sky, radar};
use visibility::{Meshes, Scene, VisibilityBuffer, rasterize};

fn main() {
    divan::main();
}

fn day() -> Weather {
    Weather { cloudiness: 30.0, ..Weather::default() }
}

fn night() -> Weather {
    Weather { sun_altitude_deg: -30.0, wetness: 60.0, ..Weather::default() }
}

/// Calls with everything that a camera image is made from.
fn with_view(
    weather: &Weather,
    each: impl FnOnce(&Scene<'_>, &CameraView, &VisibilityBuffer, &Lighting<'_>),
) {
    let snapshot = common::street(weather.is_night());
    let meshes = Meshes::build(&snapshot.meshes);
    let scene = Scene::new(&meshes, &snapshot);
    let sky = Sky::new(weather, 0.0);
    let lighting = Lighting::new(&scene, &sky, weather, Vec3::ZERO);
    let pose = Pose::<World, Agent>::from_xyz_rpy([0.0, -5.2, 0.0], [0.0; 3]);
    let mount = Mount::upright([0.6, 0.0, 1.6], 0.0);
    let view = CameraView::new(&snapshot.origin, &pose, &pose, &mount, &CameraSettings::default());
    if let Ok(camera) = view.pinhole() {
        each(&scene, &view, &rasterize(&scene, &camera), &lighting);
    }
}

#[divan::bench]
fn sky(bencher: Bencher) {
    bencher.bench(|| Sky::new(&day(), 1.0));
}

#[divan::bench]
fn lighting(bencher: Bencher) {
    with_view(&day(), |scene, _, _, _| {
        let sky = Sky::new(&day(), 0.0);
        bencher.bench(|| Lighting::new(scene, &sky, &day(), Vec3::ZERO));
    });
}

#[divan::bench]
fn camera_visibility(bencher: Bencher) {
    with_view(&day(), |scene, _, buffer, _| bencher.bench(|| rasterize(scene, &buffer.camera)));
}

#[divan::bench]
fn camera_colour_day(bencher: Bencher) {
    with_view(&day(), |scene, view, buffer, light| {
        bencher.bench(|| Picture::new(scene, view, buffer, light))
    });
}

#[divan::bench]
fn camera_colour_wet_night(bencher: Bencher) {
    with_view(&night(), |scene, view, buffer, light| {
        bencher.bench(|| Picture::new(scene, view, buffer, light));
    });
}

/// Each image with its encoder, without the others.
#[divan::bench(args = ["rgb", "semantic", "instance", "depth", "flow"])]
fn camera_image(bencher: Bencher, kind: &str) {
    with_view(&day(), |scene, view, buffer, light| {
        let settings = CameraSettings {
            rgb: kind == "rgb",
            semantic: kind == "semantic",
            instance: kind == "instance",
            depth: kind == "depth",
            flow: kind == "flow",
            ..view.settings.clone()
        };
        let view = CameraView { settings, ..view.clone() };
        bencher.bench(|| CameraFrame::from_buffer(scene, &view, buffer, Some(light)));
    });
}

#[divan::bench]
fn lidar_262144_rays(bencher: Bencher) {
    with_view(&day(), |scene, _, _, _| {
        let Ok(lidar) = Lidar::new(&LidarSpec::vehicle()) else { return };
        let stream = Stream::new(27, 0, "bench", 0);
        bencher.bench(|| lidar.sweep(scene, common::at(0.0, -5.2, 1.8, 0.0), &stream, 3));
    });
}

#[divan::bench]
fn four_radars(bencher: Bencher) {
    with_view(&day(), |scene, _, _, _| {
        let stream = Stream::new(27, 0, "bench", 0);
        let pose = common::at(0.0, -5.2, 0.6, 0.0);
        let motion = RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: None };
        bencher.bench(|| {
            Rig::vehicle()
                .radars
                .iter()
                .map(|spec| radar(scene, spec, &motion, &stream, 3).len())
                .sum::<usize>()
        });
    });
}
