//! What cameras see and what rays hit: the interface of renderers, and the one on the CPU.
//!
//! [`Renderer`] owns prepared meshes; [`Renderer::place`] puts the instances of one frame over them and gives
//! a [`Scene`], which answers two questions: what cameras see ([`Scene::render`]) and what rays hit
//! ([`Scene::trace`]). Many are asked at once; a [`CameraQuery`] and a [`RayQuery`] say among which
//! instances, when, and what is wanted. Cameras, shadow maps, lidars and radars ask nothing else;
//! [`render_views`] asks them for cameras with and without lenses. [`VoxelRenderer`] answers voxel grids.
//! Answers are plain buffers of numbers, nothing that lives on one device; [`Surfaces`] recovers the exact
//! surface point of every pixel from them, the same for all renderers. [`cpu`] and the voxels of `labels`
//! fill the seam on the CPU.
//!
//! Every renderer keeps to this:
//! * everything is in the snapshot's local frame (metres, `f32`), cameras in their optical frame;
//! * both sides of every triangle are seen: meshes may be open, and a closed mesh hides its own back faces;
//! * triangles of zero area, and triangles or instances with numbers that are not finite, are never seen;
//! * of two surfaces at exactly the same distance, the smaller (instance, triangle) is seen.
//!
//! Numbers called `instance` index [`schema::geometry::Snapshot::instances`]; numbers called `triangle` index
//! [`schema::geometry::TriMesh::triangles`] of that instance's mesh.
//!
//! ```
//! use glam::{Affine3A, Vec3};
//! use render::{Hits, PinholeCamera, SKY, VisibilityBuffer};
//!
//! // 90 degrees wide: what is as far to the right as ahead is at the edge of the picture.
//! let camera = PinholeCamera::centred(Affine3A::IDENTITY, 640, 360, frames::deg(90.0) as f32);
//! assert!((camera.direction_optical(640.0, 180.0) - Vec3::new(1.0, 0.0, 1.0)).length() < 1e-6);
//!
//! // A renderer starts from a picture of the sky and from rays that hit nothing.
//! let seen = VisibilityBuffer::empty(&camera);
//! assert_eq!(seen.instance[seen.index(320, 180)], SKY);
//! assert_eq!(Hits::none(3).get(2), None);
//! ```

pub mod cpu;

mod bend;
mod buffer;
mod camera;
mod error;
mod flow;
mod model;
mod moment;
pub mod panes;
pub mod prepared;
mod query;
mod ray;
mod scene;
mod surface;
mod view;
mod view_query;
mod voxels;

pub use bend::Bend;
pub use buffer::{SKY, VisibilityBuffer};
pub use camera::PinholeCamera;
pub use error::{CameraError, RenderError};
pub use flow::flow;
pub use model::CameraModel;
pub use moment::pose_before;
pub use query::{CameraQuery, Outputs, RayQuery, Stipple};
pub use ray::{Hit, Hits, RayBatch};
pub use scene::{Renderer, Scene};
pub use surface::{SurfacePoint, SurfacePoints, SurfaceTriangle, Surfaces};
pub use view::CameraView;
pub use view_query::{ViewQuery, Window, render_views};
pub use voxels::{VoxelBlock, VoxelRenderer};
