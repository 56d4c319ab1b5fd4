//! Where a camera is and how it looks.

use std::sync::Arc;

use glam::Affine3A;
use settings::CameraSettings;

use crate::{CameraModel, PinholeCamera};

/// A camera at one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraView {
    /// Optical frame (x right, y down, z forward) to the snapshot's local frame, now.
    pub local_from_optical: Affine3A,
    /// The same one frame period ago, in the same local frame; for flow.
    pub previous_local_from_optical: Affine3A,
    /// Picture size, intrinsics and lens.
    pub model: Arc<CameraModel>,
    /// Aperture, encoding and wanted images.
    pub settings: CameraSettings,
}

impl CameraView {
    /// The camera as renderers know it.
    #[must_use]
    pub fn pinhole(&self) -> PinholeCamera {
        self.model.pinhole(self.local_from_optical)
    }
}
