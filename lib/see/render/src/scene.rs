//! The seam for cameras, lidars, radars and shadows.

use std::sync::Arc;

use schema::geometry::{Snapshot, TriMesh};

use crate::buffer::VisibilityBuffer;
use crate::camera::PinholeCamera;
use crate::error::RenderError;
use crate::query::{CameraQuery, RayQuery};
use crate::ray::Hits;

/// Owns the meshes of a world, prepared for looking at them: built once, shared by all frames, agents and
/// threads.
///
/// All renderers give the same answers, bit for bit, to what decides a label: instance, triangle, depth and
/// distance.
pub trait Renderer: Send + Sync {
    /// Prepares more meshes, which take the next numbers: those of a snapshot's mesh list, in its order.
    ///
    /// # Errors
    /// The device behind the renderer failed.
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError>;

    /// Puts the instances of one frame over the prepared meshes. Frames are independent of one another: many
    /// may be placed and asked at a time.
    ///
    /// Instances of empty meshes, or with poses that are not finite, are not seen.
    ///
    /// # Errors
    /// The snapshot lists more meshes than were prepared, or the device failed.
    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError>;
}

/// The instances of one frame over a renderer's meshes.
///
/// Questions come in batches, because a device answers many at once for little more than the price of one:
/// ask for all cameras of an agent together, and for all rays of a sweep.
pub trait Scene: Send + Sync {
    /// The snapshot that this scene shows.
    fn snapshot(&self) -> &Snapshot;

    /// What cameras see, in the order of the queries.
    ///
    /// A pixel sees the closest triangle that its centre is in, between the camera's near and far depth. A
    /// centre exactly on the edge between two triangles belongs to one of them.
    ///
    /// # Errors
    /// The device failed.
    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError>;

    /// The closest surface along every ray, in the order of the queries. What a ray hits does not depend on
    /// the other rays.
    ///
    /// # Errors
    /// The device failed.
    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError>;

    /// Those of some instances that are not wholly within a picture: whose bounds may come nearer to its
    /// edges than so many pixels, or leave its depths. A renderer that cannot tell names them all: the answer
    /// only saves work.
    fn beyond(&self, _camera: &PinholeCamera, _inner_px: f32, instances: &[u32]) -> Vec<u32> {
        instances.to_vec()
    }
}
