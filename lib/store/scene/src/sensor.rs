//! Tables of a sensor, one row a reading.

use schema::calibration::{Calibration, METADATA_KEY};
use schema::table::{Framed, Row};
use schema::{AgentId, rate};
use store::{RowGroups, keys};

use crate::{SceneError, SceneReader};

/// The rows of a sensor's table, frame by frame.
pub struct SensorFrames<R> {
    path: String,
    groups: RowGroups<R>,
    ready: std::vec::IntoIter<R>,
    next: u32,
    frames: u32,
    every_n_frames: u32,
}

impl<R: Row + Framed> SensorFrames<R> {
    /// Opens a table of an agent's sensor, by its name (`LIDAR`, `RGB-CAM_FRONT`). It gives the rows of
    /// frames 0, n, 2 n, ... of a scene of so many frames, a few at a time in memory. The n of a sensor
    /// stands in its calibration ([`read_calibration`]).
    ///
    /// # Errors
    /// Its stage has not made it, or it is not as the manifest says.
    pub fn open(
        scene: &SceneReader,
        agent: AgentId,
        name: &str,
        (frames, every_n_frames): (u32, u32),
    ) -> Result<Self, SceneError> {
        let key = keys::sensor(scene.scene(), agent, name);
        let groups = scene.store().row_groups(scene.manifest(R::STAGE)?, &key)?;
        let path = scene.store().location(&key);
        Ok(Self {
            path,
            groups,
            ready: Vec::new().into_iter(),
            next: 0,
            frames,
            every_n_frames: every_n_frames.max(1),
        })
    }

    /// The row of a frame; none where the sensor has no reading then. Frames must be asked for in ascending
    /// order; those between are passed over, and not decoded where they are groups of their own, as a
    /// sensor's are.
    ///
    /// # Errors
    /// The table cannot be read, or has another frame there.
    pub fn at(&mut self, frame: u32) -> Result<Option<R>, SceneError> {
        if frame >= self.frames || !rate::is_due(frame, self.every_n_frames) {
            return Ok(None);
        }
        let Some(ahead) = frame.checked_sub(self.next) else {
            return Err(SceneError::Frame { path: self.path.clone(), expected: frame, found: None });
        };
        let rows = (ahead / self.every_n_frames) as usize;
        let held = rows.min(self.ready.len());
        self.ready.by_ref().take(held).for_each(drop);
        self.groups.pass(rows - held)?;
        self.next = frame;
        self.next().transpose()
    }

    fn row(&mut self) -> Result<R, SceneError> {
        let wrong = |found| SceneError::Frame { path: self.path.clone(), expected: self.next, found };
        let row = loop {
            if let Some(row) = self.ready.next() {
                break row;
            }
            match self.groups.next() {
                Some(group) => self.ready = group?.into_iter(),
                None => return Err(wrong(None)),
            }
        };
        if row.frame() == i64::from(self.next) { Ok(row) } else { Err(wrong(Some(row.frame()))) }
    }
}

impl<R: Row + Framed> Iterator for SensorFrames<R> {
    type Item = Result<R, SceneError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next >= self.frames {
            return None;
        }
        let row = self.row();
        // After an error nothing more can be trusted.
        self.next = if row.is_ok() { self.next.saturating_add(self.every_n_frames) } else { self.frames };
        Some(row)
    }
}

/// A whole table of an agent that is no sensor's own (`visible`): any number of rows a frame.
///
/// # Errors
/// As [`SensorFrames::open`].
pub fn agent_rows<R: Row>(scene: &SceneReader, agent: AgentId, name: &str) -> Result<Vec<R>, SceneError> {
    let key = keys::sensor(scene.scene(), agent, name);
    Ok(scene.store().read_rows(scene.manifest(R::STAGE)?, &key)?)
}

/// What the table of an agent's sensor says of the sensor: its pose and intrinsics.
///
/// # Errors
/// As [`SensorFrames::open`], or it says nothing of it.
pub fn read_calibration<R: Row>(
    scene: &SceneReader,
    agent: AgentId,
    name: &str,
) -> Result<Calibration, SceneError> {
    let key = keys::sensor(scene.scene(), agent, name);
    let path = || scene.store().location(&key);
    let text = scene.store().table_metadata(scene.manifest(R::STAGE)?, &key, METADATA_KEY)?;
    let text = text.ok_or_else(|| SceneError::NoCalibration { path: path() })?;
    serde_json::from_str(&text).map_err(|source| SceneError::Calibration { path: path(), source })
}
