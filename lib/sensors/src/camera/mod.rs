//! Cameras: one look at the scene, five images.

mod antialias;
mod encode;
mod flow;
mod labels;
mod rain;
mod shade;

use std::collections::BTreeMap;

use frames::{Agent, LocalOrigin, Pose, World};
use glam::Affine3A;
use schema::settings::{CameraSettings, Mount};
use schema::table::Blob;
use schema::tables::{CameraRow, FlowRow};
use schema::{ObjectId, Tag};
use visibility::{PinholeCamera, Scene, VisibilityBuffer, rasterize};

use crate::error::{MAX_SIDE_PX, SensorError};
use crate::light::Lighting;

use encode::Content;
pub use labels::decode_depth_m;

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

    /// The lens as `visibility` knows it.
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

/// A colour picture: 8-bit sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue of each pixel.
    pub rgb: Vec<u8>,
}

/// Optical flow: motion on the screen since the last frame, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flow {
    /// To the right; the image is 2 units wide.
    pub dx: Vec<f32>,
    /// Up; the image is 2 units high.
    pub dy: Vec<f32>,
}

/// The images of one camera at one frame, as [`CameraSettings`] asks for them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraFrame {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Colour, JPEG.
    pub rgb: Option<Vec<u8>>,
    /// Colour of the tag ([`Tag::camera_rgb`]), PNG.
    pub semantic: Option<Vec<u8>>,
    /// Tag (red) and object id (green low byte, blue high byte), PNG.
    pub instance: Option<Vec<u8>>,
    /// Planar depth, 24 bit, red lowest, PNG.
    pub depth: Option<Vec<u8>>,
    /// Motion since the last frame.
    pub flow: Option<Flow>,
    /// How many pixels show each object's parts of each tag; what has no pixel is not listed.
    pub pixel_counts: BTreeMap<(ObjectId, Tag), u32>,
}

/// Sees the scene and makes all wanted images.
///
/// # Errors
/// The settings are not those of a camera, a colour image is wanted and `lighting` is missing, or an encoder
/// refused.
pub fn render_camera(
    scene: &Scene<'_>,
    view: &CameraView,
    lighting: Option<&Lighting>,
) -> Result<CameraFrame, SensorError> {
    let buffer = rasterize(scene, &view.pinhole()?);
    CameraFrame::from_buffer(scene, view, &buffer, lighting)
}

impl CameraFrame {
    /// Makes all wanted images from what was seen.
    ///
    /// # Errors
    /// As [`render_camera`].
    pub fn from_buffer(
        scene: &Scene<'_>,
        view: &CameraView,
        buffer: &VisibilityBuffer,
        lighting: Option<&Lighting>,
    ) -> Result<Self, SensorError> {
        let wanted = &view.settings;
        let colour = || -> Result<Option<Vec<u8>>, SensorError> {
            if !wanted.rgb {
                return Ok(None);
            }
            let picture = Picture::new(scene, view, buffer, lighting.ok_or(SensorError::NoLight)?);
            encode::jpeg(&picture, wanted.jpeg_quality).map(Some)
        };
        let png = |wanted: bool, content, rgb: &dyn Fn() -> Vec<u8>| {
            wanted.then(|| encode::png_rgb(&rgb(), content, buffer)).transpose()
        };
        let labels = || -> Result<_, SensorError> {
            let images = labels::LabelImages::new(scene, buffer);
            Ok((
                png(wanted.semantic, Content::Flat, &|| images.semantic())?,
                png(wanted.instance, Content::Flat, &|| images.instances())?,
                png(wanted.depth, Content::Smooth, &|| labels::depth_rgb(buffer))?,
                wanted.flow.then(|| flow::flow(scene, view, buffer)),
                images.pixel_counts(),
            ))
        };
        let (rgb, labels) = rayon::join(colour, labels);
        let (semantic, instance, depth, flow, pixel_counts) = labels?;
        Ok(Self {
            width: buffer.width,
            height: buffer.height,
            rgb: rgb?,
            semantic,
            instance,
            depth,
            flow,
            pixel_counts,
        })
    }

    /// The images as table rows, by the prefix of their table: `RGB`, `SEG`, `IST`, `DPT`.
    #[must_use]
    pub fn image_rows(&mut self, frame: u32) -> Vec<(&'static str, CameraRow)> {
        let images = [
            ("RGB", self.rgb.take()),
            ("SEG", self.semantic.take()),
            ("IST", self.instance.take()),
            ("DPT", self.depth.take()),
        ];
        let time_s = crate::frame_time_s(frame);
        images
            .into_iter()
            .filter_map(|(prefix, image)| Some((prefix, CameraRow { frame, time_s, image: Blob(image?) })))
            .collect()
    }

    /// The flow as a table row (`FLW`).
    #[must_use]
    pub fn flow_row(&mut self, frame: u32) -> Option<FlowRow> {
        let Flow { dx, dy } = self.flow.take()?;
        let time_s = crate::frame_time_s(frame);
        Some(FlowRow { frame, time_s, width: self.width, height: self.height, dx, dy })
    }
}
