//! What a sensor's table says of the sensor itself.

use frames::{Agent, Frame, Pose};
use serde::{Deserialize, Serialize};

use crate::lens::Lens;

/// Key of the JSON text of a [`Calibration`] in a sensor table's metadata.
pub const METADATA_KEY: &str = "sensor";

/// Pose and intrinsics of a sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Its name.
    pub name: String,
    /// Its axes: `flu` (x forward, y left, z up) or `optical` (x right, y down, z forward).
    pub frame: String,
    /// Where it is on its agent.
    pub agent_from_sensor: Mounting,
    /// It has readings at frames 0, n, 2 n, ... and none between.
    #[serde(default = "crate::rate::every_frame")]
    pub every_n_frames: u32,
    /// Columns of a camera's pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<u32>,
    /// Rows of a camera's pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<u32>,
    /// The 3 x 3 matrix that takes directions in a camera's optical frame (bent by its lens) to pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<[[f64; 3]; 3]>,
    /// What bends a camera's rays. Depth images of fisheyes hold distances along the ray, others along the
    /// axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lens: Option<Lens>,
}

/// Position and orientation on the agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mounting {
    /// Metres.
    pub translation: [f64; 3],
    /// w, x, y, z.
    pub quaternion: [f64; 4],
}

impl Mounting {
    /// Of a pose.
    #[must_use]
    pub fn new<F: Frame>(agent_from_sensor: &Pose<Agent, F>) -> Self {
        Self { translation: agent_from_sensor.xyz(), quaternion: agent_from_sensor.wxyz() }
    }

    /// The pose, in the axes that [`Calibration::frame`] names.
    #[must_use]
    pub fn agent_from_sensor<F: Frame>(&self) -> Pose<Agent, F> {
        Pose::from_xyz_wxyz(self.translation, self.quaternion)
    }
}
