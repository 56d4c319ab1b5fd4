//! The seam for cameras, lidars, radars and shadows.

use std::sync::Arc;

use schema::geometry::{Snapshot, TriMesh};

use crate::buffer::VisibilityBuffer;
use crate::camera::PinholeCamera;
use crate::error::RenderError;
use crate::ray::{Hits, RayBatch};

/// Owns the meshes of a world, prepared for looking at them: built once, shared by all frames, agents and threads.
///
/// All renderers give the same answers, bit for bit, to what decides a label: instance, triangle, depth and distance.
pub trait Renderer: Send + Sync {
    /// Prepares more meshes, which take the next numbers: those of a snapshot's mesh list, in its order.
    ///
    /// # Errors
    /// The device behind the renderer failed.
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError>;

    /// Puts the instances of one frame over the prepared meshes. Frames are independent of one another: many may be
    /// placed and asked at a time.
    ///
    /// Instances of empty meshes, or with poses that are not finite, are not seen.
    ///
    /// # Errors
    /// The snapshot lists more meshes than were prepared, or the device failed.
    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError>;
}

/// A look at some instances as if there were no others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alone<'a> {
    /// The camera.
    pub camera: PinholeCamera,
    /// Numbers of the instances, ascending.
    pub instances: &'a [u32],
}

/// Rays that look at some instances as if there were no others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AloneRays<'a> {
    /// The rays.
    pub rays: RayBatch<'a>,
    /// Numbers of the instances, ascending.
    pub instances: &'a [u32],
}

/// The instances of one frame over a renderer's meshes.
///
/// Questions come in batches, because a device answers many at once for little more than the price of one: ask for
/// all cameras of an agent together, and for all rays of a sweep.
pub trait Scene: Send + Sync {
    /// The snapshot that this scene shows.
    fn snapshot(&self) -> &Snapshot;

    /// What each camera sees, in the cameras' order.
    ///
    /// A pixel sees the closest triangle that its centre is in, between the camera's near and far depth. A centre
    /// exactly on the edge between two triangles belongs to one of them.
    ///
    /// # Errors
    /// The device failed.
    fn look(&self, cameras: &[PinholeCamera]) -> Result<Vec<VisibilityBuffer>, RenderError>;

    /// What each camera would see if there were nothing but some instances: how much of an object others hide.
    ///
    /// # Errors
    /// The device failed.
    fn look_at(&self, shots: &[Alone<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError>;

    /// Depths alone of what a camera sees, of all instances or as if there were nothing but some: those of
    /// [`look`](Scene::look) and [`look_at`](Scene::look_at), bit for bit. Who asks for no more need not be told more.
    ///
    /// # Errors
    /// The device failed.
    fn depths(&self, camera: &PinholeCamera, among: Option<&[u32]>) -> Result<Vec<f32>, RenderError> {
        let seen = match among {
            None => self.look(&[*camera])?,
            Some(instances) => self.look_at(&[Alone { camera: *camera, instances }])?,
        };
        Ok(seen.into_iter().flat_map(|seen| seen.depth_m).collect())
    }

    /// The same as a light has them that shines through panes with something behind them ([`Snapshot::has_cabin`]): these stop it,
    /// as a chequer does, only at pixels whose column and row add up to an odd number, so that half of it passes, as about half
    /// passes two panes of 70 % each. Who cannot tell panes from sheet metal stops it there.
    ///
    /// # Errors
    /// The device failed.
    fn depths_through_panes(
        &self,
        camera: &PinholeCamera,
        among: Option<&[u32]>,
    ) -> Result<Vec<f32>, RenderError> {
        self.depths(camera, among)
    }

    /// Those of some instances that are not wholly within a picture: whose bounds may come nearer to its edges than so many
    /// pixels, or leave its depths. Who cannot tell names them all.
    fn beyond(&self, _camera: &PinholeCamera, _inner_px: f32, instances: &[u32]) -> Vec<u32> {
        instances.to_vec()
    }

    /// The closest surface along every ray, in the batches' order. What a ray hits does not depend on its batch.
    ///
    /// # Errors
    /// The device failed.
    fn trace(&self, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError>;

    /// The closest surface along every ray if there were nothing but some instances.
    ///
    /// # Errors
    /// The device failed.
    fn trace_at(&self, batches: &[AloneRays<'_>]) -> Result<Vec<Hits>, RenderError>;

    /// The closest surface along every ray at a moment between the previous frame and this one: `before` is 0 at this frame and 1 at the previous one.
    /// Every instance is where [`pose_before`](crate::pose_before) has it then.
    ///
    /// # Errors
    /// The device failed.
    fn trace_before(&self, before: f32, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError>;

    /// The closest surface along every ray at such a moment (0 is this frame) for who looks through panes: what stands behind these
    /// ([`Snapshot::cabins`]) is met as well. Whoever has met a pane and goes on asks for what is farther than that.
    ///
    /// # Errors
    /// The device failed.
    fn trace_behind(&self, before: f32, batches: &[RayBatch<'_>]) -> Result<Vec<Hits>, RenderError>;
}
