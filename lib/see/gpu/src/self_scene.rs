//! Whether a device sees a small scene as the CPU does.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3};
use render::cpu::CpuRenderer;
use render::{CameraQuery, Outputs, PinholeCamera, Renderer, VisibilityBuffer};
use schema::Tag;
use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};

use crate::adapter::Adapter;
use crate::error::GpuError;
use crate::renderer::{Eyes, GpuRenderer};
use crate::self_test::open;

/// Squares of a mesh along a side.
const SQUARES: u32 = 24;

/// Opens an adapter's device, tries whether it computes as the CPU does ([`open`]), compiles the kernels, and
/// tries whether it sees a small scene as the CPU does.
///
/// # Errors
/// It lacks a feature, the driver gives no device, refuses a kernel or fails, or an answer is not the CPU's.
pub fn eyes(adapter: &Adapter) -> Result<Arc<Eyes>, GpuError> {
    let eyes = Arc::new(Eyes::new(open(adapter)?)?);
    try_scene(&eyes)?;
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
    let expected = cpu.place(&snapshot).and_then(|scene| scene.render(&queries)).map_err(failed)?;
    let mut gpu = GpuRenderer::new(Arc::clone(eyes));
    gpu.prepare(&snapshot.meshes).map_err(failed)?;
    let found = gpu.place(&snapshot).and_then(|scene| scene.render(&queries)).map_err(failed)?;
    if gpu.seen().by_cpu > 0 {
        return Err(GpuError::Device { problem: "it cannot see a scene".to_owned() });
    }
    for (found, expected) in found.iter().zip(&expected) {
        if let Some(at) = (0..expected.depth_m.len()).find(|&at| pixel(found, at) != pixel(expected, at)) {
            let [column, row] = [at % expected.width as usize, at / expected.width as usize];
            return Err(GpuError::Unequal { driver: eyes.gpu().driver().to_owned(), column, row });
        }
    }
    Ok(())
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
