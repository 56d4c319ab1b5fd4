//! A made-up town of 2.6 million triangles: ground tiles, 300 buildings, 2,700 vehicles and trees.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use frames::LocalOrigin;
use glam::{Affine3A, Mat3, Quat, Vec3};
use random::Stream;
use render::PinholeCamera;
use schema::Tag;
use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};

/// Blocks in each direction, and metres from street to street.
const BLOCKS: i32 = 10;
const BLOCK_M: f32 = 80.0;

/// A bent grid of quads.
fn sheet(mesh: &mut TriMesh, n: u32, m: u32, place: impl Fn(f32, f32) -> Vec3) {
    let first = mesh.positions.len() as u32;
    for i in 0..=n {
        mesh.positions.extend((0..=m).map(|j| place(i as f32 / n as f32, j as f32 / m as f32)));
    }
    for i in 0..n {
        for k in (0..m).map(|j| first + i * (m + 1) + j) {
            mesh.triangles.extend([[k, k + m + 1, k + m + 2], [k, k + m + 2, k + 1]]);
        }
    }
}

fn finish(mut mesh: TriMesh, tag: Tag) -> Arc<TriMesh> {
    mesh.triangle_part = vec![0; mesh.triangles.len()];
    mesh.parts = vec![MeshPart { tag, surface: Surface::Plain, rgb: [0.5; 3] }];
    Arc::new(mesh)
}

fn uniform(s: &mut Stream, low: f32, high: f32) -> f32 {
    s.uniform(low.into(), high.into()) as f32
}

/// A closed, rounded body: 4 * n * n triangles within half extents, resting on the ground.
fn body(n: u32, half: Vec3) -> TriMesh {
    let mut mesh = TriMesh::default();
    sheet(&mut mesh, n, 2 * n, |i, j| {
        let (s, c) = frames::math::f32::sin_cos(PI * i);
        let (y, x) = frames::math::f32::sin_cos(TAU * j);
        let unit = Vec3::new(s * x, s * y, c);
        half * (unit * 1.3).clamp(Vec3::NEG_ONE, Vec3::ONE) + Vec3::Z * half.z
    });
    mesh
}

fn building(s: &mut Stream) -> Arc<TriMesh> {
    let half = Vec3::new(uniform(s, 7.0, 12.0), uniform(s, 7.0, 12.0), uniform(s, 4.0, 20.0));
    let mut mesh = TriMesh::default();
    for side in 0..4 {
        let turn = Quat::from_rotation_z(side as f32 * PI / 2.0);
        let (out, along) = if side % 2 == 0 { (half.x, half.y) } else { (half.y, half.x) };
        // Every third row and column of panels stands back, as windows do.
        sheet(&mut mesh, 18, 17, |i, j| {
            let inner = (i * 18.0) as u32 % 3 == 1 && (j * 17.0) as u32 % 3 == 1;
            let depth = if inner { out - 0.2 } else { out };
            turn * Vec3::new(depth, (2.0 * i - 1.0) * along, j * 2.0 * half.z)
        });
    }
    sheet(&mut mesh, 1, 1, |i, j| {
        Vec3::new((2.0 * i - 1.0) * half.x, (2.0 * j - 1.0) * half.y, 2.0 * half.z)
    });
    finish(mesh, Tag::Building)
}

fn tree(s: &mut Stream) -> Arc<TriMesh> {
    let mut mesh = body(4, Vec3::new(0.2, 0.2, 1.5));
    // Loose leaves in a crown.
    for _ in 0..450 {
        let centre = loop {
            let p = Vec3::from_array(std::array::from_fn(|_| uniform(s, -1.0, 1.0)));
            if p.length() < 1.0 {
                break p * 2.0 + Vec3::Z * 4.5;
            }
        };
        let k = mesh.positions.len() as u32;
        mesh.positions.extend(
            (0..3).map(|_| centre + Vec3::from_array(std::array::from_fn(|_| uniform(s, -0.35, 0.35)))),
        );
        mesh.triangles.push([k, k + 1, k + 2]);
    }
    finish(mesh, Tag::Vegetation)
}

fn ground() -> Arc<TriMesh> {
    let mut mesh = TriMesh::default();
    sheet(&mut mesh, 55, 55, |i, j| {
        let (x, y) = ((i - 0.5) * BLOCK_M, (j - 0.5) * BLOCK_M);
        // A crown in the middle of a tile.
        Vec3::new(
            x,
            y,
            0.05 * frames::math::f32::cos(PI * (i - 0.5)) * frames::math::f32::cos(PI * (j - 0.5)),
        )
    });
    finish(mesh, Tag::Road)
}

/// The town around a crossing at the origin.
pub(crate) fn town() -> Snapshot {
    let mut s = Stream::new(1, 0, "bench/town", 0);
    let mut meshes = vec![ground()];
    meshes.extend((0..10).map(|i| finish(body(12, Vec3::new(2.2 + 0.2 * i as f32, 0.95, 0.8)), Tag::Car)));
    meshes.extend((0..10).map(|_| tree(&mut s)));
    let mut instances = Vec::new();
    let mut add = |mesh: usize, x: f32, y: f32, yaw: f32| {
        let pose = Affine3A::from_rotation_translation(Quat::from_rotation_z(yaw), Vec3::new(x, y, 0.0));
        instances.push(Instance {
            mesh: mesh as u32,
            object: instances.len() as u16 + 1,
            local_from_object: pose,
            previous_local_from_object: pose,
            paint: [0.5; 3],
            lights: 0,
            glow: [1.0; 3],
        });
    };
    let centre = |i: i32| (i as f32 - BLOCKS as f32 / 2.0 + 0.5) * BLOCK_M;
    for i in 0..BLOCKS * BLOCKS {
        let (x, y) = (centre(i % BLOCKS), centre(i / BLOCKS));
        add(0, x, y, 0.0);
        for k in 0..3 {
            meshes.push(building(&mut s));
            let turn = uniform(&mut s, -0.1, 0.1);
            add(meshes.len() - 1, x - 18.0 + 18.0 * k as f32, y + [-18.0, 16.0, -14.0][k], turn);
        }
    }
    for i in 0..2700 {
        // Along a street: vehicles on it, trees beside it.
        let street = (s.int_inclusive(0, BLOCKS.into()) as f32 - BLOCKS as f32 / 2.0) * BLOCK_M;
        let along = uniform(&mut s, -400.0, 400.0);
        let car = i % 2 == 0;
        let beside = if car { 1.9 } else { 9.0 } * if s.chance(0.5) { 1.0 } else { -1.0 };
        let mesh = 1 + s.int_inclusive(0, 9) as usize + if car { 0 } else { 10 };
        if along.abs() < 7.0 && street.abs() < 1.0 {
            continue; // Room for the sensors.
        }
        if s.chance(0.5) {
            add(mesh, along, street + beside, 0.0);
        } else {
            add(mesh, street + beside, along, PI / 2.0);
        }
    }
    Snapshot {
        origin: LocalOrigin::near([0.0; 3]),
        meshes: meshes.into(),
        instances,
        cabins: Vec::new(),
        motions: Vec::new(),
    }
}

/// Six cameras on the roof of a car at the crossing, 60 degrees apart.
pub(crate) fn cameras() -> Vec<PinholeCamera> {
    (0..6)
        .map(|i| {
            let (y, x) = frames::math::f32::sin_cos(0.2 + i as f32 * PI / 3.0);
            let forward = Vec3::new(x, y, 0.0);
            let rotation = Mat3::from_cols(forward.cross(Vec3::Z), Vec3::NEG_Z, forward);
            let pose = Affine3A { matrix3: rotation.into(), translation: Vec3::new(0.0, -1.5, 1.6).into() };
            PinholeCamera::centred(pose, 1600, 900, frames::deg(80.0) as f32)
        })
        .collect()
}

/// 262,144 lidar directions: 128 rings by 2,048 columns, in patches of 4 by 4.
pub(crate) fn lidar() -> Vec<Vec3> {
    let mut all = Vec::new();
    for patch in 0..32 * 512 {
        for k in 0..16 {
            let (ring, column) = (patch / 512 * 4 + k / 4, patch % 512 * 4 + k % 4);
            let elevation = frames::deg(-30.0 + 40.0 * f64::from(ring) / 127.0) as f32;
            let (sin, cos) = frames::math::f32::sin_cos(elevation);
            let (y, x) = frames::math::f32::sin_cos(TAU * column as f32 / 2048.0);
            all.push(Vec3::new(cos * x, cos * y, sin));
        }
    }
    all
}
