//! What is seen, on the CPU: a tiled rasteriser for pinhole cameras and a packet ray tracer for lidar, radar
//! and shadows: implements [`Renderer`](crate::Renderer).
//!
//! Both look at the same triangles: per mesh a search tree, built once; per frame a tree over the instances.
//! Bounding volumes, tiles and packets only leave out what can't be seen, so results do not depend on how the
//! trees were built or on the number of threads.
//!
//! ```
//! use std::sync::Arc;
//! use glam::{Affine3A, Vec3};
//! use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};
//! use schema::Tag;
//! use render::{CameraQuery, PinholeCamera, RayBatch, RayQuery, Renderer, SKY, Surfaces};
//! use render::cpu::CpuRenderer;
//!
//! // A wall 10 m ahead along z, which is where a camera at the origin looks.
//! let corner = |x: f32, y: f32| Vec3::new(x, y, 10.0);
//! let wall = Arc::new(TriMesh {
//!     positions: vec![corner(-2.0, -1.0), corner(2.0, -1.0), corner(2.0, 1.0), corner(-2.0, 1.0)],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     triangle_part: vec![0, 0],
//!     parts: vec![MeshPart { tag: Tag::Wall, surface: Surface::Plain, rgb: [0.5; 3] }],
//!     ..TriMesh::default()
//! });
//! let mut cpu = CpuRenderer::default();
//! cpu.prepare(&[Arc::clone(&wall)])?;
//! let snapshot = Snapshot {
//!     origin: frames::LocalOrigin::near([0.0; 3]),
//!     meshes: vec![wall].into(),
//!     instances: vec![Instance {
//!         mesh: 0,
//!         object: 7,
//!         local_from_object: Affine3A::IDENTITY,
//!         previous_local_from_object: Affine3A::IDENTITY,
//!         paint: [0.5; 3],
//!         lights: 0,
//!         glow: [1.0; 3],
//!     }],
//!     cabins: Vec::new(),
//!     motions: Vec::new(),
//! };
//! let scene = cpu.place(&snapshot)?;
//!
//! let camera = PinholeCamera::centred(Affine3A::IDENTITY, 64, 48, frames::deg(60.0) as f32);
//! let seen = scene.render(&[CameraQuery::of(camera)])?.remove(0);
//! let middle = seen.index(32, 24);
//! assert_eq!((seen.instance[middle], seen.depth_m[middle]), (0, 10.0));
//! assert_eq!(seen.instance[seen.index(0, 0)], SKY);
//! let point = Surfaces::new(&seen, &snapshot).at(32, 24).expect("the wall is there");
//! assert_eq!(point.part.tag, Tag::Wall);
//!
//! let ahead = RayBatch { origin: Vec3::ZERO, directions: &[Vec3::Z, Vec3::X], range_m: [0.0, 100.0], nearest_m: &[] };
//! let hits = scene.trace(&[RayQuery::of(ahead)])?.remove(0);
//! assert_eq!(hits.get(0).map(|hit| hit.t), Some(10.0));
//! assert_eq!(hits.get(1), None);
//! # Ok::<(), render::RenderError>(())
//! ```

mod packet;
mod raster;
mod renderer;
mod scene;

pub use renderer::CpuRenderer;
pub use scene::{Among, CpuScene, Placement, Placements};
