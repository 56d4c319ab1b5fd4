//! What is seen: one seam for everything that looks at the world's triangles, and its implementation on the CPU.
//!
//! [`Renderer`] owns prepared meshes; [`Renderer::place`] puts the instances of one frame over them and gives a
//! [`Scene`], which answers batches of questions: what cameras see ([`Scene::look`]) and what rays hit
//! ([`Scene::trace`]). Cameras, shadow maps, lidars and radars ask nothing else, so another renderer (on a GPU, say)
//! takes the place of [`CpuRenderer`] by implementing these two traits. Answers are plain buffers of numbers;
//! [`Surfaces`] recovers the exact surface point of every pixel from them, the same for all renderers.
//!
//! Every renderer keeps to this:
//! * everything is in the snapshot's local frame (metres, `f32`), cameras in their optical frame;
//! * both sides of every triangle are seen: meshes may be open, and a closed mesh hides its own back faces;
//! * triangles of zero area, and triangles or instances with numbers that are not finite, are never seen;
//! * of two surfaces at exactly the same distance, the smaller (instance, triangle) is seen. Bounding volumes,
//!   tiles and packets only leave out what can't be seen, so results do not depend on how the trees were
//!   built or on the number of threads.
//!
//! Numbers called `instance` index [`schema::geometry::Snapshot::instances`]; numbers called `triangle` index
//! [`schema::geometry::TriMesh::triangles`] of that instance's mesh.
//!
//! ```
//! use std::sync::Arc;
//! use glam::{Affine3A, Vec3};
//! use schema::geometry::{Instance, Part, Snapshot, Surface, TriMesh};
//! use schema::Tag;
//! use visibility::{CpuRenderer, PinholeCamera, RayBatch, Renderer, SKY, Surfaces};
//!
//! // A wall 10 m ahead along z, which is where a camera at the origin looks.
//! let corner = |x: f32, y: f32| Vec3::new(x, y, 10.0);
//! let wall = Arc::new(TriMesh {
//!     positions: vec![corner(-2.0, -1.0), corner(2.0, -1.0), corner(2.0, 1.0), corner(-2.0, 1.0)],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     triangle_part: vec![0, 0],
//!     parts: vec![Part { tag: Tag::Wall, surface: Surface::Plain, rgb: [0.5; 3] }],
//! });
//! let mut renderer = CpuRenderer::default();
//! renderer.prepare(&[Arc::clone(&wall)])?;
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
//! };
//! let scene = renderer.place(&snapshot)?;
//!
//! let camera = PinholeCamera::centred(Affine3A::IDENTITY, 64, 48, frames::deg(60.0) as f32);
//! let seen = scene.look(&[camera])?.remove(0);
//! let middle = seen.index(32, 24);
//! assert_eq!((seen.instance[middle], seen.depth_m[middle]), (0, 10.0));
//! assert_eq!(seen.instance[seen.index(0, 0)], SKY);
//! let point = Surfaces::new(&seen, &snapshot).at(32, 24).expect("the wall is there");
//! assert_eq!(point.part.tag, Tag::Wall);
//!
//! let ahead = RayBatch { origin: Vec3::ZERO, directions: &[Vec3::Z, Vec3::X], range_m: [0.0, 100.0] };
//! let hits = scene.trace(&[ahead])?.remove(0);
//! assert_eq!(hits.get(0).map(|hit| hit.t), Some(10.0));
//! assert_eq!(hits.get(1), None);
//! # Ok::<(), visibility::RenderError>(())
//! ```

mod buffer;
mod camera;
mod cpu;
mod error;
mod ray;
mod renderer;
mod surface;

pub use buffer::{SKY, VisibilityBuffer};
pub use camera::PinholeCamera;
pub use cpu::CpuRenderer;
pub use error::RenderError;
pub use ray::{Hit, Hits, RayBatch};
pub use renderer::{Renderer, Scene};
pub use surface::{SurfacePoint, Surfaces};
