//! Kinds of images.

use std::marker::PhantomData;

use schema::geometry::Snapshot;
use schema::images::{ImageEncoding, OfKind};
use schema::measures::sensors::IMAGES;
use schema::table::Row;
use settings::Rig;

use crate::error::SensorError;
use crate::metadata::camera_metadata;
use crate::observation::Observation;
use crate::sensor::{Amount, Layout, Sensor, SensorTable};
use shading::Sight;

/// A kind of image that is made of what a camera saw.
pub trait Image: OfKind + Send + Sync + 'static {
    /// A row of its tables.
    type Row: Row + Send + 'static;

    /// The image at a frame; `snapshot` must be the one that was seen.
    ///
    /// # Errors
    /// An encoder refused.
    fn of(snapshot: &Snapshot, sight: &Sight, frame: u32) -> Result<Self::Row, SensorError>;
}

/// Images of one kind of one camera.
pub(super) struct Images<I> {
    /// The camera's place in the rig.
    camera: usize,
    table: SensorTable,
    kind: PhantomData<fn() -> I>,
}

impl<I: Image> Images<I> {
    pub(super) fn new(rig: &Rig, camera: usize) -> Self {
        let spec = I::KIND.spec();
        let about = camera_metadata(&rig.cameras[camera], &rig.camera);
        let table = SensorTable {
            name: I::KIND.table(&rig.cameras[camera].name),
            counted_as: spec.prefix.to_owned(),
            metadata: Some(about),
            layout: match spec.encoding {
                ImageEncoding::Jpeg | ImageEncoding::Png => Layout::CompressedFrames,
                ImageEncoding::Columns => Layout::Frames,
            },
            every_n_frames: rig.camera.every_n_frames,
        };
        Self { camera, table, kind: PhantomData }
    }

    /// What its camera saw, if it looked.
    pub(super) fn sight<'s>(&self, at: &'s Observation<'_>) -> Option<&'s Sight> {
        at.sights.get(self.camera)?.as_ref()
    }
}

impl<I: Image> Sensor for Images<I> {
    type Row = I::Row;

    fn table(&self) -> SensorTable {
        self.table.clone()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<I::Row>, SensorError> {
        let Some(sight) = self.sight(at) else { return Ok(Vec::new()) };
        Ok(vec![I::of(at.scene.snapshot(), sight, at.frame)?])
    }

    fn amount(&self, rows: &[I::Row]) -> Option<Amount> {
        Some(Amount { measure: IMAGES, count: rows.len() as u64 })
    }
}
