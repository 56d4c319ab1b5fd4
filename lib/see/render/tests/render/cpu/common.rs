//! Small worlds for the tests.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use random::Stream;
use render::cpu::CpuRenderer;
use render::{CameraQuery, Hit, Hits, PinholeCamera, RayBatch, RayQuery, Renderer, Scene, VisibilityBuffer};
use schema::Tag;
use schema::geometry::{MeshPart, Snapshot, Surface, TriMesh};
pub(crate) use testkit::{camera_at, instance, snapshot};

pub(crate) fn stream(topic: &str, number: u64) -> Stream {
    Stream::new(5, 0, topic, number)
}

pub(crate) fn uniform(stream: &mut Stream, low: f32, high: f32) -> f32 {
    stream.uniform(low.into(), high.into()) as f32
}

pub(crate) fn point(stream: &mut Stream, size: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| uniform(stream, -size, size)))
}

pub(crate) fn unit(stream: &mut Stream) -> Vec3 {
    loop {
        let p = point(stream, 1.0);
        if (0.01..1.0).contains(&p.length_squared()) {
            return p.normalize();
        }
    }
}

pub(crate) fn pose(stream: &mut Stream, size: f32) -> Affine3A {
    let q: [f32; 4] = std::array::from_fn(|_| uniform(stream, -1.0, 1.0));
    let rotation = Quat::from_xyzw(q[0], q[1], q[2], q[3] + 2.0).normalize();
    Affine3A::from_rotation_translation(rotation, point(stream, size))
}

pub(crate) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Arc<TriMesh> {
    let part = MeshPart { tag: Tag::Building, surface: Surface::Plain, rgb: [0.5; 3] };
    Arc::new(TriMesh {
        triangle_part: vec![0; triangles.len()],
        positions,
        triangles,
        parts: vec![part],
        ..TriMesh::default()
    })
}

/// Unconnected triangles.
pub(crate) fn soup(stream: &mut Stream, count: usize, spread: f32, size: f32) -> Arc<TriMesh> {
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = point(stream, spread);
        positions.extend((0..3).map(|_| centre + point(stream, size)));
    }
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh(positions, triangles)
}

/// A closed, lumpy ball of `2 * rings * sectors` triangles.
pub(crate) fn ball(stream: &mut Stream, rings: u32, sectors: u32, radius: f32) -> Arc<TriMesh> {
    let mut positions = vec![Vec3::Z * radius, -Vec3::Z * radius];
    for ring in 1..=rings {
        for sector in 0..sectors {
            let (s, c) = frames::math::f32::sin_cos(std::f32::consts::PI * ring as f32 / (rings + 1) as f32);
            let (y, x) = frames::math::f32::sin_cos(std::f32::consts::TAU * sector as f32 / sectors as f32);
            positions.push(Vec3::new(s * x, s * y, c) * (radius * uniform(stream, 0.9, 1.1)));
        }
    }
    let at = |ring: u32, sector: u32| 2 + ring * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(0, s), at(0, s + 1)]);
        triangles.push([1, at(rings - 1, s + 1), at(rings - 1, s)]);
        for r in 1..rings {
            triangles.push([at(r - 1, s), at(r, s), at(r, s + 1)]);
            triangles.push([at(r - 1, s), at(r, s + 1), at(r - 1, s + 1)]);
        }
    }
    mesh(positions, triangles)
}

/// A flat grid of `2 * n * n` triangles in z = 0.
pub(crate) fn floor(n: u32, size: f32) -> Arc<TriMesh> {
    let step = 2.0 * size / n as f32;
    let positions = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| Vec3::new(i as f32 * step - size, j as f32 * step - size, 0.0)))
        .collect();
    let triangles = (0..n)
        .flat_map(|i| (0..n).map(move |j| i * (n + 1) + j))
        .flat_map(|k| [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]])
        .collect();
    mesh(positions, triangles)
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
