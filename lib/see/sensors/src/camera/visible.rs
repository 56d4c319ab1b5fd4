//! Which objects the instance images of an agent show.

use std::collections::BTreeMap;

use schema::ImageKind;
use schema::tables::{VISIBLE_TABLE, VisibleRow};
use settings::Rig;

use super::labels::pixel_counts;
use crate::error::SensorError;
use crate::observation::Observation;
use crate::sensor::{Layout, Sensor, SensorTable};

/// Counts the pixels of every object and tag in all cameras of an agent.
pub(crate) struct VisibleObjects {
    every_n_frames: u32,
}

impl VisibleObjects {
    /// For rigs that make instance images.
    pub(crate) fn of(rig: &Rig) -> Option<Self> {
        let every_n_frames = rig.camera.every_n_frames;
        rig.camera.images.has(ImageKind::Instance).then_some(Self { every_n_frames })
    }
}

impl Sensor for VisibleObjects {
    type Row = VisibleRow;

    fn table(&self) -> SensorTable {
        SensorTable::new(VISIBLE_TABLE, None, Layout::Whole, self.every_n_frames)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<VisibleRow>, SensorError> {
        let snapshot = at.scene.snapshot();
        let mut visible = BTreeMap::new();
        let sights = at.sights.iter().flatten();
        for (part, pixels) in sights.flat_map(|sight| pixel_counts(snapshot, &sight.seen)) {
            *visible.entry(part).or_insert(0) += pixels;
        }
        let row = |((id, tag), pixels)| VisibleRow { frame: at.frame, id, tag: tag as u8, pixels };
        Ok(visible.into_iter().map(row).collect())
    }
}
