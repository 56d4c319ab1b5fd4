//! What is seen: a tiled rasteriser for pinhole cameras and a packet ray tracer for lidar, radar and shadows.
//!
//! Both look at the same triangles: [`Meshes`] holds the per-mesh data, built once for a scene; [`Scene`] puts
//! the instances of one frame over it. [`rasterize`] fills a [`VisibilityBuffer`] (instance, triangle and depth
//! per pixel), from which [`Surfaces`] recovers the exact surface point of every pixel; [`Scene::trace`],
//! [`Scene::occluded`] and [`Scene::trace_packet_shared_origin`] follow rays.
//!
//! Conventions:
//! * everything is in the snapshot's local frame (metres, `f32`), cameras in their optical frame;
//! * both sides of every triangle are seen: meshes may be open, and a closed mesh hides its own back faces;
//! * triangles of zero area, and triangles or instances with numbers that are not finite, are never seen;
//! * of two surfaces at exactly the same distance, the smaller (instance, triangle) is seen. Bounding volumes,
//!   tiles and packets only leave out what can't be seen, so results do not depend on how the trees were
//!   built or on the number of threads.
//!
//! Numbers called `instance` index [`schema::geometry::Snapshot::instances`]; numbers called `triangle` index
//! [`schema::geometry::TriMesh::triangles`] of that instance's mesh.

mod buffer;
mod bvh;
mod camera;
mod meshes;
mod packet;
mod raster;
mod ray;
mod scene;
mod surface;

pub use buffer::{SKY, VisibilityBuffer};
pub use camera::PinholeCamera;
pub use meshes::Meshes;
pub use raster::rasterize;
pub use ray::{Hit, Ray};
pub use scene::Scene;
pub use surface::{SurfacePoint, Surfaces};
