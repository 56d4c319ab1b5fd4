//! Time of each part of an agent's frame on a small street; `visibility` has its own benches.

#[path = "../tests/sensors/common/mod.rs"]
mod common;

use std::sync::Arc;

use divan::Bencher;
use glam::Vec3;
use random::Stream;
use render::{CameraQuery, Scene};
use schema::images::{Depth, Flow, Instance, Rgb, Semantic};
use schema::tables::Weather;
use sensors::{Image, Lidar, LidarMoment, RadarMotion, RadarQuery, RadarReturns, pixel_counts, radars};
use settings::{BeamSpec, LidarSpec, Rig, RollingScan, WeatherSpec};
use shading::Sight;
use shading::{Lighting, Shot, Sky, compose};

fn main() {
    divan::main();
}

fn day() -> Weather {
    Weather { cloudiness: 30.0, ..Weather::default() }
}

fn night() -> Weather {
    Weather { sun_altitude_deg: -30.0, wetness: 60.0, ..Weather::default() }
}

/// Calls with everything that images are made from.
fn with_sight(weather: &Weather, each: impl FnOnce(&dyn Scene, &Sight, &Lighting)) {
    let snapshot = common::street(weather.is_night());
    common::with_scene(&snapshot, |scene| {
        let view = common::standing_view([0.0, -5.2, 0.0], [0.0; 3], common::optics(1600, 900));
        each(scene, &common::sight(scene, &view, weather), &common::lighting(scene, weather));
    });
}

#[divan::bench]
fn sky(bencher: Bencher) {
    bencher.bench(|| Sky::new(&day(), 1.0));
}

#[divan::bench]
fn lighting(bencher: Bencher) {
    with_sight(&day(), |scene, _, _| {
        let sky = Arc::new(Sky::new(&day(), 0.0));
        bencher.bench(|| Lighting::new(scene, Arc::clone(&sky), &day(), Vec3::ZERO));
    });
}

#[divan::bench]
fn camera_visibility(bencher: Bencher) {
    with_sight(&day(), |scene, sight, _| {
        bencher.bench(|| scene.render(&[CameraQuery::of(sight.seen.camera)]))
    });
}

#[divan::bench]
fn camera_colour_day(bencher: Bencher) {
    with_sight(&day(), |scene, sight, light| {
        bencher.bench(|| compose(scene, &[Shot { view: &sight.view, seen: &sight.seen }], light));
    });
}

#[divan::bench]
fn camera_colour_wet_night(bencher: Bencher) {
    with_sight(&night(), |scene, sight, light| {
        bencher.bench(|| compose(scene, &[Shot { view: &sight.view, seen: &sight.seen }], light));
    });
}

/// Each image with its encoder, from what was seen and painted.
#[divan::bench(types = [Rgb, Semantic, Instance, Depth, Flow])]
fn camera_image<I: Image>(bencher: Bencher) {
    with_sight(&day(), |scene, sight, _| bencher.bench(|| I::of(scene.snapshot(), sight, 3).is_ok()));
}

#[divan::bench]
fn camera_pixel_counts(bencher: Bencher) {
    with_sight(&day(), |scene, sight, _| bencher.bench(|| pixel_counts(scene.snapshot(), &sight.seen)));
}

/// A sweep of 262,144 beams from a vehicle that drives at 15 m/s.
fn bench_lidar(bencher: Bencher, spec: &LidarSpec, weather: Weather) {
    with_sight(&day(), |scene, _, _| {
        let lidar = Lidar::new(spec).expect("is possible");
        let stream = Stream::new(27, 0, "bench", 0);
        let mut moment = LidarMoment { weather, ..LidarMoment::standing(3, common::at(0.0, -5.2, 1.8, 0.0)) };
        moment.path.previous_local_from_agent = common::at(-0.75, -5.2, 1.8, 0.0);
        bencher.bench(|| lidar.sweep(scene, &moment, &stream));
    });
}

#[divan::bench]
fn lidar_262144_rays(bencher: Bencher) {
    bench_lidar(bencher, &LidarSpec::vehicle(), Weather::default());
}

#[divan::bench]
fn lidar_rolling_in_64_slices(bencher: Bencher) {
    let rolling = Some(RollingScan { slices: 64, compensated: true });
    bench_lidar(bencher, &LidarSpec { rolling, ..LidarSpec::vehicle() }, Weather::default());
}

#[divan::bench]
fn lidar_seven_rays_a_beam(bencher: Bencher) {
    let base = LidarSpec::vehicle();
    let beam = BeamSpec { rays: 7, ..base.beam.clone() };
    bench_lidar(bencher, &LidarSpec { beam, ..base }, Weather::default());
}

#[divan::bench]
fn lidar_in_rain_and_fog(bencher: Bencher) {
    let weather = Some(WeatherSpec { detected: 0.1 });
    let sky = Weather { precipitation: 50.0, fog_density: 80.0, ..Weather::default() };
    bench_lidar(bencher, &LidarSpec { weather, ..LidarSpec::vehicle() }, sky);
}

#[divan::bench]
fn four_radars(bencher: Bencher) {
    with_sight(&day(), |scene, _, _| {
        let stream = Stream::new(27, 0, "bench", 0);
        let pose = common::at(0.0, -5.2, 0.6, 0.0);
        let motion = RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: None };
        let rig = Rig::vehicle();
        let query = |spec| RadarQuery { spec, motion, stream: &stream };
        let queries: Vec<RadarQuery<'_>> = rig.radars.iter().map(query).collect();
        bencher.bench(|| radars(scene, &queries, 3).map_or(0, |all| all.iter().map(RadarReturns::len).sum()));
    });
}
