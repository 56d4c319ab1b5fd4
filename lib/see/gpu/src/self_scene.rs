//! Whether a device sees a small scene, and follows rays through it, as the CPU does.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3};
use render::cpu::CpuRenderer;
use render::{CameraQuery, Hits, Outputs, PinholeCamera, RayBatch, RayQuery, Renderer, VisibilityBuffer};
use schema::Tag;
use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};

use crate::adapter::Adapter;
use crate::error::GpuError;
use crate::eyes::Eyes;
use crate::renderer::{GpuRenderer, Work};

/// Squares of a mesh along a side.
const SQUARES: u32 = 24;

/// Opens an adapter's device, tries whether it computes as the CPU does ([`crate::open`]), compiles the
/// kernels, and tries whether it sees a small scene and follows rays through it as the CPU does.
///
/// It uses no more memory than so many bytes; if nothing is said, half of what the adapter has.
///
/// # Errors
/// It lacks a feature, the driver gives no device, refuses a kernel or fails, or an answer is not the CPU's.
pub fn eyes(adapter: &Adapter, memory_bytes: Option<u64>) -> Result<Arc<Eyes>, GpuError> {
    let eyes = Arc::new(Eyes::new(adapter)?);
    try_scene(&eyes)?;
    eyes.limit_memory(memory_bytes);
    Ok(eyes)
}

/// Sees a scene with the device and with the CPU.
fn try_scene(eyes: &Arc<Eyes>) -> Result<(), GpuError> {
    let snapshot = snapshot();
    let queries: Vec<CameraQuery<'_>> = cameras()
        .into_iter()
        .flat_map(|camera| {
            let query = CameraQuery::of(camera);
            [query, CameraQuery { outputs: Outputs::Depths, ..query }]
        })
        .collect();
    let failed = |e: render::RenderError| GpuError::Device { problem: e.to_string() };
    let mut cpu = CpuRenderer::default();
    cpu.prepare(&snapshot.meshes).map_err(failed)?;
    let scene = cpu.place(&snapshot).map_err(failed)?;
    let expected = scene.render(&queries).map_err(failed)?;
    let directions = directions();
    let rays = RayQuery::of(RayBatch {
        origin: Vec3::new(0.2, 0.1, 0.3),
        directions: &directions,
        range_m: [0.5, 40.0],
        nearest_m: &[],
    });
    let met = scene.trace(&[rays]).map_err(failed)?;
    let mut gpu = GpuRenderer::new(Arc::clone(eyes));
    gpu.prepare(&snapshot.meshes).map_err(failed)?;
    let scene = gpu.place(&snapshot).map_err(failed)?;
    let found = scene.render(&queries).map_err(failed)?;
    let found_by_rays = scene.trace(&[rays]).map_err(failed)?;
    drop(scene);
    let Work { views, rays, .. } = gpu.work();
    if views.by_cpu > 0 || rays.by_cpu > 0 {
        return Err(GpuError::Device { problem: "it cannot see a scene".to_owned() });
    }
    for (found, expected) in found.iter().zip(&expected) {
        if let Some(at) = (0..expected.depth_m.len()).find(|&at| pixel(found, at) != pixel(expected, at)) {
            let [column, row] = [at % expected.width as usize, at / expected.width as usize];
            return Err(GpuError::Unequal { driver: eyes.adapter().driver(), column, row });
        }
    }
    for (found, expected) in found_by_rays.iter().zip(&met) {
        let hit = |hits: &Hits, ray: usize| {
            let floats = [hits.t[ray], hits.u[ray], hits.v[ray]].map(f32::to_bits);
            (floats, hits.instance[ray], hits.triangle[ray])
        };
        if let Some(ray) = (0..expected.len()).find(|&ray| hit(found, ray) != hit(expected, ray)) {
            return Err(GpuError::UnequalRay { driver: eyes.adapter().driver(), ray });
        }
    }
    Ok(())
}

/// Rays to all sides: along a spiral from straight up to straight down.
fn directions() -> Vec<Vec3> {
    const RAYS: u16 = 4096;
    let along = |i: u16| {
        let z = 1.0 - 2.0 * (f32::from(i) + 0.5) / f32::from(RAYS);
        let (sin, cos) = frames::math::f32::sin_cos(f32::from(i) * 2.4);
        Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z
    };
    (0..RAYS).map(along).collect()
}

/// What a pixel shows, and the bits of its depth.
fn pixel(seen: &VisibilityBuffer, at: usize) -> (Option<u32>, Option<u32>, u32) {
    (seen.instance.get(at).copied(), seen.triangle.get(at).copied(), seen.depth_m[at].to_bits())
}

/// Two hilly sheets, one of them there three times: they meet, hide one another, and reach behind a camera.
fn snapshot() -> Snapshot {
    let meshes: Vec<Arc<TriMesh>> = vec![Arc::new(sheet(7)), Arc::new(sheet(11))];
    let instance = |mesh, degrees: f64, along_m: Vec3| {
        let turn = Mat3::from_rotation_y(frames::deg(degrees) as f32);
        let at = Affine3A::from_mat3_translation(turn, along_m);
        Instance {
            mesh,
            object: 1,
            local_from_object: at,
            previous_local_from_object: at,
            paint: [0.5; 3],
            lights: 0,
            glow: [1.0; 3],
        }
    };
    Snapshot {
        origin: frames::LocalOrigin::near([0.0; 3]),
        meshes: meshes.into(),
        instances: vec![
            instance(0, 0.0, Vec3::new(0.0, 0.0, -1.5)),
            instance(1, 0.0, Vec3::new(0.0, 0.0, -1.5)),
            instance(1, 80.0, Vec3::new(20.0, 3.0, 0.0)),
            instance(1, 35.0, Vec3::new(9.0, -4.0, 1.0)),
        ],
        cabins: Vec::new(),
        motions: Vec::new(),
    }
}

/// A sheet of squares of a metre with bumps of a few decimetres.
fn sheet(step: u32) -> TriMesh {
    let half = SQUARES as f32 / 2.0;
    let corner = |i: u32, j: u32| {
        let bump = (i * step + j * j * 5) % 13;
        Vec3::new(i as f32 - half, j as f32 - half, bump as f32 * 0.03)
    };
    let positions = (0..=SQUARES).flat_map(|i| (0..=SQUARES).map(move |j| corner(i, j))).collect();
    let triangles: Vec<[u32; 3]> = (0..SQUARES)
        .flat_map(|i| (0..SQUARES).map(move |j| i * (SQUARES + 1) + j))
        .flat_map(|k| [[k, k + SQUARES + 1, k + SQUARES + 2], [k, k + SQUARES + 2, k + 1]])
        .collect();
    let part = MeshPart { tag: Tag::Ground, surface: Surface::Plain, rgb: [0.5; 3] };
    TriMesh {
        triangle_part: vec![0; triangles.len()],
        positions,
        triangles,
        parts: vec![part],
        ..TriMesh::default()
    }
}

/// Ahead and askew, of a size that fills no tile.
fn cameras() -> [PinholeCamera; 2] {
    [(Vec3::X, Vec3::ZERO), (Vec3::new(0.8, 0.5, -0.2), Vec3::new(0.3, -0.4, 0.2))].map(|(along, from_m)| {
        let forward = along.normalize();
        let right = forward.cross(Vec3::Z).normalize();
        let turn = Mat3::from_cols(right, forward.cross(right), forward);
        PinholeCamera::centred(Affine3A::from_mat3_translation(turn, from_m), 150, 90, 1.5)
    })
}
