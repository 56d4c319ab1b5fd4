//! Small worlds for the tests.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use random::Stream;
use render::cpu::CpuRenderer;
use render::{CameraQuery, Hit, Hits, PinholeCamera, RayBatch, RayQuery, Renderer, Scene, VisibilityBuffer};
use schema::geometry::{Snapshot, Surface, TriMesh};
use testkit::random_world;
pub(crate) use testkit::random_world::{ball, point, pose, soup, uniform};
pub(crate) use testkit::{camera_at, instance, snapshot};

pub(crate) fn stream(topic: &str, number: u64) -> Stream {
    Stream::new(5, 0, topic, number)
}

pub(crate) fn unit(stream: &mut Stream) -> Vec3 {
    loop {
        let p = point(stream, 1.0);
        if (0.01..1.0).contains(&p.length_squared()) {
            return p.normalize();
        }
    }
}

pub(crate) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Arc<TriMesh> {
    random_world::mesh(positions, triangles, Surface::Plain)
}

pub(crate) fn floor(n: u32, half: f32) -> Arc<TriMesh> {
    random_world::grid(n, half, Surface::Plain)
}

/// Floor, balls and loose triangles around the origin.
pub(crate) fn world(number: u64) -> Snapshot {
    let mut s = stream("world", number);
    let meshes = vec![
        floor(12, 40.0),
        ball(&mut s, 7, 12, 1.5),
        ball(&mut s, 20, 30, 4.0),
        soup(&mut s, 60, 6.0, 2.0),
    ];
    let floor_pose = Affine3A::from_translation(Vec3::new(0.0, 0.0, -2.0));
    let mut instances = vec![instance(0, 1, floor_pose)];
    for i in 0..60 {
        instances.push(instance(1 + i % 3, 2 + i as u16, pose(&mut s, 30.0)));
    }
    snapshot(meshes, instances)
}

/// A ray by itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) range_m: [f32; 2],
}

/// A renderer with a world's meshes.
pub(crate) fn prepared(world: &Snapshot) -> CpuRenderer {
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&world.meshes).unwrap();
    renderer
}

pub(crate) fn with_scene<T>(world: &Snapshot, run: impl FnOnce(&dyn Scene) -> T) -> T {
    run(&*prepared(world).place(world).unwrap())
}

pub(crate) fn trace(scene: &dyn Scene, ray: &Ray) -> Option<Hit> {
    trace_all(scene, ray.origin, &[ray.direction], ray.range_m).get(0)
}

pub(crate) fn trace_all(scene: &dyn Scene, origin: Vec3, directions: &[Vec3], range_m: [f32; 2]) -> Hits {
    scene.trace(&[RayQuery::of(RayBatch { origin, directions, range_m, nearest_m: &[] })]).unwrap().remove(0)
}

pub(crate) fn see(scene: &dyn Scene, camera: &PinholeCamera) -> VisibilityBuffer {
    scene.render(&[CameraQuery::of(*camera)]).unwrap().remove(0)
}

/// How far, in barycentric weight, a hit is from its triangle's nearest edge.
pub(crate) fn edge_weight(hit: &Hit) -> f32 {
    hit.u.min(hit.v).min(1.0 - hit.u - hit.v)
}
