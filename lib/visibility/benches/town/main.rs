//! Six cameras and a lidar in a town of 2.6 million triangles.

mod scene;

use divan::{Bencher, black_box};
use glam::Vec3;
use visibility::{Meshes, Ray, Scene, rasterize};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 3)]
fn prepare_meshes(bencher: Bencher) {
    let town = scene::town();
    bencher.bench(|| Meshes::build(black_box(&town.meshes)));
}

#[divan::bench(sample_count = 20)]
fn place_instances(bencher: Bencher) {
    let town = scene::town();
    let meshes = Meshes::build(&town.meshes);
    bencher.bench(|| Scene::new(&meshes, black_box(&town)));
}

#[divan::bench(sample_count = 10)]
fn six_cameras(bencher: Bencher) {
    let town = scene::town();
    let meshes = Meshes::build(&town.meshes);
    let scene = Scene::new(&meshes, &town);
    let cameras = scene::cameras();
    bencher.bench(|| cameras.iter().map(|camera| rasterize(&scene, camera)).collect::<Vec<_>>());
}

#[divan::bench(sample_count = 10)]
fn surfaces_of_one_camera(bencher: Bencher) {
    let town = scene::town();
    let meshes = Meshes::build(&town.meshes);
    let scene = Scene::new(&meshes, &town);
    let buffer = rasterize(&scene, &scene::cameras()[0]);
    bencher.bench(|| {
        let surfaces = buffer.surfaces(&scene);
        let mut sum = Vec3::ZERO;
        for y in 0..buffer.height {
            surfaces.for_each_in_row(y, |_, point| {
                if let Some(point) = point {
                    sum += point.position_object + point.normal_local;
                }
            });
        }
        sum
    });
}

#[divan::bench(sample_count = 10)]
fn lidar(bencher: Bencher) {
    let town = scene::town();
    let meshes = Meshes::build(&town.meshes);
    let scene = Scene::new(&meshes, &town);
    let directions = scene::lidar();
    let mut hits = vec![None; directions.len()];
    bencher.bench_local(|| {
        let origin = Vec3::new(0.0, -1.5, 1.9);
        scene.trace_packet_shared_origin(origin, black_box(&directions), 0.0, 120.0, &mut hits);
    });
}

#[divan::bench(sample_count = 5)]
fn single_rays_65536(bencher: Bencher) {
    let town = scene::town();
    let meshes = Meshes::build(&town.meshes);
    let scene = Scene::new(&meshes, &town);
    let directions = scene::lidar();
    let origin = Vec3::new(0.0, -1.5, 1.9);
    bencher.bench_local(|| {
        let rays = directions.iter().step_by(4);
        rays.filter(|&&direction| scene.trace(&Ray { origin, direction, t_min: 0.0, t_max: 120.0 }).is_some())
            .count()
    });
}
