//! The sensors of one agent with their tables: readings are made in any order and written frame by frame.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use counts::PartialCounts;
use pipeline::{Place, StageError};
use schema::calibration::METADATA_KEY;
use schema::measures::sensors::{IMAGES, SENSOR_BYTES, SWEEPS};
use schema::settings::Rig;
use schema::tables::PartialRow;
use schema::{AgentId, rate};
use sensors::{Carrier, Layout, Observation, Sensor, SensorError, SensorTable, SensorVisitor};
use store::{Finished, TableOptions, TableWriter, Unit, keys};

/// All sensors of one agent.
pub(crate) struct Recorder {
    agent: AgentId,
    channels: Vec<Box<dyn Channel>>,
}

/// A sensor and its open table, whatever its rows are.
pub(crate) trait Channel: Sync {
    /// Name of the table.
    fn name(&self) -> &str;

    /// Whether the sensor is read at a frame.
    fn is_due(&self, frame: u32) -> bool;

    /// Reads the sensor and keeps the rows.
    fn sense(&self, at: &Observation<'_>) -> Result<(), SensorError>;

    /// Appends what was kept of a frame to the table.
    fn write(&self, frame: u32, agent: &str, counts: &mut PartialCounts) -> Result<(), StageError>;

    /// Ends the table; tells what its bytes are counted as.
    fn finish(self: Box<Self>) -> Result<(String, Finished), StageError>;
}

struct Open<S: Sensor> {
    sensor: S,
    about: SensorTable,
    /// Rows that wait for those of earlier frames, by frame.
    waiting: Mutex<BTreeMap<u32, Vec<S::Row>>>,
    table: Mutex<TableWriter<S::Row>>,
}

/// What a panic elsewhere left is never written: the unit is not finished.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<S: Sensor> Channel for Open<S> {
    fn name(&self) -> &str {
        &self.about.name
    }

    fn is_due(&self, frame: u32) -> bool {
        rate::is_due(frame, self.about.every_n_frames)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<(), SensorError> {
        let rows = self.sensor.sense(at)?;
        lock(&self.waiting).insert(at.frame, rows);
        Ok(())
    }

    fn write(&self, frame: u32, agent: &str, counts: &mut PartialCounts) -> Result<(), StageError> {
        let Some(rows) = lock(&self.waiting).remove(&frame) else { return Ok(()) };
        if let Some(amount) = self.sensor.amount(&rows) {
            counts.add(agent, amount.measure, &self.about.counted_as, 0, amount.count);
            if amount.measure != IMAGES {
                counts.add(agent, SWEEPS, &self.about.counted_as, 0, 1);
            }
        }
        lock(&self.table).push(&rows)?;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(String, Finished), StageError> {
        let table = self.table.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok((self.about.counted_as, table.finish()?))
    }
}

/// Opens a table for every sensor that it is shown.
struct Opening<'a, 'u> {
    unit: &'a Unit<'u>,
    scene: u32,
    agent: AgentId,
    channels: Vec<Box<dyn Channel>>,
}

/// Why a sensor has no table.
enum Unopened {
    Sensor(SensorError),
    Stage(StageError),
}

impl From<SensorError> for Unopened {
    fn from(error: SensorError) -> Self {
        Self::Sensor(error)
    }
}

impl SensorVisitor for Opening<'_, '_> {
    type Error = Unopened;

    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), Unopened> {
        let about = sensor.table();
        let metadata: Vec<(String, String)> =
            about.metadata.iter().map(|json| (METADATA_KEY.to_owned(), json.clone())).collect();
        let options = match about.layout {
            Layout::Frames => TableOptions::frames(metadata),
            Layout::CompressedFrames => TableOptions::compressed_frames(metadata),
            Layout::Whole => TableOptions { metadata, ..TableOptions::default() },
        };
        let key = keys::sensor(self.scene, self.agent, &about.name);
        let table = self.unit.table(&key, options).map_err(|e| Unopened::Stage(e.into()))?;
        let (waiting, table) = (Mutex::default(), Mutex::new(table));
        self.channels.push(Box::new(Open { sensor, about, waiting, table }));
        Ok(())
    }
}

impl Recorder {
    /// Opens a table for every sensor of a rig.
    ///
    /// # Errors
    /// A sensor's settings are impossible, or the store cannot be written.
    pub(crate) fn open(unit: &Unit<'_>, rig: &Rig, carrier: &Carrier) -> Result<Self, StageError> {
        let Carrier { scene, agent, .. } = *carrier;
        let mut opening = Opening { unit, scene, agent, channels: Vec::new() };
        sensors::visit_sensors(rig, carrier, &mut opening).map_err(|e| match e {
            Unopened::Sensor(e) => {
                StageError::Failed { place: Box::new(Place::scene(scene).agent(agent)), source: e.into() }
            }
            Unopened::Stage(e) => e,
        })?;
        Ok(Self { agent, channels: opening.channels })
    }

    /// The sensors that are to be read at a frame, each once.
    pub(crate) fn channels_at(&self, frame: u32) -> impl Iterator<Item = &dyn Channel> {
        self.channels.iter().map(Box::as_ref).filter(move |channel| channel.is_due(frame))
    }

    /// Those of the frames `0..frames` at which some sensor is read.
    pub(crate) fn due_frames(&self, frames: u32) -> Vec<u32> {
        (0..frames).filter(|&frame| self.channels_at(frame).next().is_some()).collect()
    }

    /// Writes a frame's readings, which must have been made, after those of all earlier frames.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn write(&self, frame: u32, counts: &mut PartialCounts) -> Result<(), StageError> {
        let agent = self.agent.to_string();
        self.channels.iter().try_for_each(|channel| channel.write(frame, &agent, counts))
    }

    /// Ends all tables and counts their bytes.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn finish(
        self,
        mut counts: PartialCounts,
    ) -> Result<(Vec<Finished>, Vec<PartialRow>), StageError> {
        let agent = self.agent.to_string();
        let mut shards = Vec::with_capacity(self.channels.len());
        for channel in self.channels {
            let (counted_as, shard) = channel.finish()?;
            counts.add(&agent, SENSOR_BYTES, &counted_as, 0, shard.output().bytes);
            shards.push(shard);
        }
        Ok((shards, counts.rows()))
    }
}
