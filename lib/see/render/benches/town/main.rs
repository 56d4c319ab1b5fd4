//! Six cameras and a lidar in a town of 2.6 million triangles.

mod scene;

use divan::{Bencher, black_box};
use glam::Vec3;
use render::cpu::CpuRenderer;
use render::{CameraQuery, RayBatch, RayQuery, Renderer, Surfaces};
use schema::geometry::Snapshot;

fn main() {
    divan::main();
}

fn prepared(town: &Snapshot) -> CpuRenderer {
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&town.meshes).expect("has no device");
    renderer
}

#[divan::bench(sample_count = 3)]
fn prepare_meshes(bencher: Bencher) {
    let town = scene::town();
    bencher.bench(|| prepared(black_box(&town)));
}

#[divan::bench(sample_count = 20)]
fn place_instances(bencher: Bencher) {
    let town = scene::town();
    let renderer = prepared(&town);
    bencher.bench(|| renderer.place(black_box(&town)).is_ok());
}

#[divan::bench(sample_count = 10)]
fn six_cameras(bencher: Bencher) {
    let town = scene::town();
    let renderer = prepared(&town);
    let scene = renderer.place(&town).expect("all meshes are prepared");
    let cameras = scene::cameras().into_iter().map(CameraQuery::of).collect::<Vec<_>>();
    bencher.bench(|| scene.render(black_box(&cameras)));
}

#[divan::bench(sample_count = 10)]
fn surfaces_of_one_camera(bencher: Bencher) {
    let town = scene::town();
    let renderer = prepared(&town);
    let scene = renderer.place(&town).expect("all meshes are prepared");
    let buffer = scene.render(&[CameraQuery::of(scene::cameras()[0])]).expect("has no device").remove(0);
    bencher.bench(|| {
        let surfaces = Surfaces::new(&buffer, &town);
        let mut sum = Vec3::ZERO;
        for y in 0..buffer.height {
            surfaces.for_each_span(y, |span, triangle| {
                let Some(triangle) = triangle else { return };
                for first in span.step_by(8) {
                    let columns = std::array::from_fn(|i| (first + i as u32).min(buffer.width - 1));
                    sum +=
                        triangle.points(&buffer, &columns, y).position_object.lane(0) + triangle.normal_local;
                }
            });
        }
        sum
    });
}

#[divan::bench(sample_count = 10)]
fn lidar(bencher: Bencher) {
    let town = scene::town();
    let renderer = prepared(&town);
    let scene = renderer.place(&town).expect("all meshes are prepared");
    let directions = scene::lidar();
    let origin = Vec3::new(0.0, -1.5, 1.9);
    bencher.bench(|| {
        scene.trace(&[RayQuery::of(RayBatch {
            origin,
            directions: black_box(&directions),
            range_m: [0.0, 120.0],
            nearest_m: &[],
        })])
    });
}

#[divan::bench(sample_count = 5)]
fn single_rays_65536(bencher: Bencher) {
    let town = scene::town();
    let renderer = prepared(&town);
    let scene = renderer.place(&town).expect("all meshes are prepared");
    let directions = scene::lidar();
    let origin = Vec3::new(0.0, -1.5, 1.9);
    let ray = |direction| {
        let directions = std::slice::from_ref(direction);
        RayQuery::of(RayBatch { origin, directions, range_m: [0.0, 120.0], nearest_m: &[] })
    };
    let rays: Vec<_> = directions.iter().step_by(4).map(ray).collect();
    bencher.bench(|| scene.trace(black_box(&rays)));
}
