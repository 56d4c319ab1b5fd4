//! Which objects are annotated.

use serde::Serialize;

/// Which objects are annotated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnnotationSettings {
    /// Boxes within this 3-D distance of an agent are collected, metres (200).
    pub box_radius_m: f64,
    /// An object without points counts as valid when an instance image shows it.
    pub valid_by_image: bool,
    /// Boxes and map records are written at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}

impl Default for AnnotationSettings {
    fn default() -> Self {
        Self { box_radius_m: 200.0, valid_by_image: true, every_n_frames: 1 }
    }
}
