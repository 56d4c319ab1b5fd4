//! Cameras of a rig, made ready to look.

use std::sync::Arc;

use frames::{Agent, LocalOrigin, Pose, World};
use schema::ImageSet;
use schema::tables::{BOXES_2D_TABLE, VISIBLE_TABLE};
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

/// The cameras of a rig.
#[derive(Clone, Debug)]
pub struct Cameras {
    /// In the rig's order; none where nothing is to be made of what the camera sees.
    pub(crate) list: Vec<Option<Camera>>,
    pub(crate) every_n_frames: u32,
}

impl Cameras {
    /// Makes the cameras of a rig ready for all its tables.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn of(rig: &Rig) -> Result<Self, SensorError> {
        Self::for_tables(rig, |_| true)
    }

    /// Makes those ready that some of the rig's tables are made with, by the tables' names: the others do not
    /// look, and of colour only what is wanted is painted.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn for_tables(rig: &Rig, is_made: impl Fn(&str) -> bool) -> Result<Self, SensorError> {
        let has_images = !rig.camera.images.is_empty();
        let all_look = has_images && (is_made(VISIBLE_TABLE) || is_made(BOXES_2D_TABLE));
        let camera = |spec: &CameraSpec| {
            let mut images = ImageSet::NONE;
            for kind in rig.camera.images.iter() {
                images.set(kind, is_made(&kind.table(&spec.name)));
            }
            let settings = CameraSettings { images, ..rig.camera.clone() };
            (all_look || !images.is_empty()).then(|| Camera::new(spec, &settings)).transpose()
        };
        let list = rig.cameras.iter().map(camera).collect::<Result<_, _>>()?;
        Ok(Self { list, every_n_frames: rig.camera.every_n_frames })
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
