//! Cameras of a rig, made ready to look.

use std::sync::Arc;

use frames::{Agent, LocalOrigin, Pose, World};
use settings::{CameraSettings, CameraSpec, Mount, Rig};

use crate::error::SensorError;
use render::CameraModel;
use render::CameraView;

/// A camera of a rig with what is worked out of it once, for all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub(crate) mount: Mount,
    pub(crate) model: Arc<CameraModel>,
    pub(crate) settings: CameraSettings,
}

/// All cameras of a rig.
#[derive(Clone, Debug)]
pub struct Cameras {
    pub(crate) list: Vec<Camera>,
    /// Whether any images are wanted.
    pub(crate) wanted: bool,
    pub(crate) every_n_frames: u32,
}

impl Cameras {
    /// Makes the cameras of a rig ready.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn of(rig: &Rig) -> Result<Self, SensorError> {
        let list = rig.cameras.iter().map(|spec| Camera::new(spec, &rig.camera)).collect::<Result<_, _>>()?;
        Ok(Self { list, wanted: !rig.camera.images.is_empty(), every_n_frames: rig.camera.every_n_frames })
    }
}

impl Camera {
    /// Makes a camera ready.
    ///
    /// # Errors
    /// The picture has no pixels or too many, or the intrinsics are not those of a camera.
    pub fn new(spec: &CameraSpec, settings: &CameraSettings) -> Result<Self, SensorError> {
        let model = Arc::new(CameraModel::new(&spec.optics)?);
        Ok(Self { mount: spec.mount, model, settings: settings.clone() })
    }

    /// What it looks through at a frame. `previous` is where the agent was one frame before (where it is now,
    /// when there was no frame before).
    #[must_use]
    pub fn view(
        &self,
        origin: &LocalOrigin,
        world_from_agent: &Pose<World, Agent>,
        previous: &Pose<World, Agent>,
    ) -> CameraView {
        let agent_from_optical = self.mount.agent_from_sensor() * frames::flu_from_optical();
        CameraView {
            local_from_optical: origin.local_from_body(&(*world_from_agent * agent_from_optical)),
            previous_local_from_optical: origin.local_from_body(&(*previous * agent_from_optical)),
            model: Arc::clone(&self.model),
            settings: self.settings.clone(),
        }
    }
}
