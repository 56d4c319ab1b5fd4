//! Which objects are annotated.

use crate::key::settings;

settings! {
    /// Which objects are annotated.
    pub struct AnnotationSettings {
        /// Boxes within this 3-D distance of an agent are collected, m.
        box_radius_m: f64 = 200.0, within(1.0..=2000.0), yaml("bbox_collection_radius");
        /// An object without points is valid when an instance image shows it.
        valid_by_image: bool = true;
        /// Boxes, map records and tracks are written at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
}
