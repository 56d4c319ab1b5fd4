//! Where a camera is and how it looks.

use frames::{Agent, LocalOrigin, Pose, World};
use glam::Affine3A;
use renderer::PinholeCamera;
use schema::settings::{CameraSettings, Mount};

use crate::error::{MAX_SIDE_PX, SensorError};

/// A camera at one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraView {
    /// Optical frame (x right, y down, z forward) to the snapshot's local frame, now.
    pub local_from_optical: Affine3A,
    /// The same one frame period ago, in the same local frame; for flow.
    pub previous_local_from_optical: Affine3A,
    /// Picture size, lens and wanted images.
    pub settings: CameraSettings,
}

impl CameraView {
    /// The view of a mounted camera. `previous` is where the agent was one frame before (where it is now, when
    /// there was no frame before).
    #[must_use]
    pub fn new(
        origin: &LocalOrigin,
        world_from_agent: &Pose<World, Agent>,
        previous: &Pose<World, Agent>,
        mount: &Mount,
        settings: &CameraSettings,
    ) -> Self {
        let agent_from_optical = mount.agent_from_sensor() * frames::flu_from_optical();
        Self {
            local_from_optical: origin.local_from_body(&(*world_from_agent * agent_from_optical)),
            previous_local_from_optical: origin.local_from_body(&(*previous * agent_from_optical)),
            settings: settings.clone(),
        }
    }

    /// The lens as renderers know it.
    ///
    /// # Errors
    /// The picture has no pixels or too many, or the field of view is not that of a pinhole camera.
    pub fn pinhole(&self) -> Result<PinholeCamera, SensorError> {
        let CameraSettings { width, height, horizontal_fov_rad, .. } = self.settings;
        if !(1..=MAX_SIDE_PX).contains(&width) || !(1..=MAX_SIDE_PX).contains(&height) {
            return Err(SensorError::PictureSize { width, height });
        }
        if !(horizontal_fov_rad > 0.0 && horizontal_fov_rad < std::f64::consts::PI) {
            return Err(SensorError::FieldOfView { degrees: frames::to_deg(horizontal_fov_rad) });
        }
        let focal = self.settings.focal_px() as f32;
        let mut camera =
            PinholeCamera::centred(self.local_from_optical, width, height, horizontal_fov_rad as f32);
        camera.fx = focal;
        camera.fy = focal;
        Ok(camera)
    }
}
