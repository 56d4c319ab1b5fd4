//! The sensors of one agent, and their tables: readings are made in any order and written frame by frame.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use runner::frames::Writer;
use runner::{Place, Stage, StageError};
use schema::calibration::METADATA_KEY;
use schema::measures::counts::PartialCounts;
use schema::measures::sensors::{IMAGES, SENSOR_BYTES, SWEEPS};
use schema::{AgentId, rate};
use sensors::{Layout, Observation, Sensor, SensorContext, SensorError, SensorTable, SensorVisitor};
use settings::Rig;
use settings::stages::SensorSettings;
use store::{Finished, TableOptions, TableWriter, Unit, keys};

/// All sensors of one agent; any thread reads them.
pub(crate) struct Channels(Vec<Arc<dyn Channel>>);

/// The tables of one agent's sensors, with the unit that they belong to.
pub(crate) struct Recorder<'u> {
    unit: Unit<'u>,
    scene: u32,
    agent: AgentId,
    tables: Vec<Box<dyn Table>>,
    counts: PartialCounts,
}

/// A sensor that keeps what it read until it is written, whatever its rows are.
pub(crate) trait Channel: Send + Sync {
    /// Name of the table.
    fn name(&self) -> &str;

    /// Whether the sensor is read at a frame.
    fn is_due(&self, frame: u32) -> bool;

    /// Reads the sensor and keeps the rows.
    fn sense(&self, at: &Observation<'_>) -> Result<(), SensorError>;
}

/// The open table of a sensor.
trait Table: Send {
    /// Appends what was kept of a frame.
    fn write(&mut self, frame: u32, agent: &str, counts: &mut PartialCounts) -> Result<(), StageError>;

    /// Ends the table; tells what its bytes are counted as.
    fn finish(self: Box<Self>) -> Result<(String, Finished), StageError>;
}

struct Reading<S: Sensor> {
    sensor: S,
    about: SensorTable,
    /// Rows that wait for those of earlier frames, by frame.
    waiting: Mutex<BTreeMap<u32, Vec<S::Row>>>,
}

impl<S: Sensor> Reading<S> {
    /// What a panic elsewhere left is never written: the unit is not finished.
    fn waiting(&self) -> MutexGuard<'_, BTreeMap<u32, Vec<S::Row>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<S: Sensor> Channel for Reading<S> {
    fn name(&self) -> &str {
        &self.about.name
    }

    fn is_due(&self, frame: u32) -> bool {
        rate::is_due(frame, self.about.every_n_frames)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<(), SensorError> {
        let rows = self.sensor.sense(at)?;
        self.waiting().insert(at.frame, rows);
        Ok(())
    }
}

struct Written<S: Sensor> {
    reading: Arc<Reading<S>>,
    table: TableWriter<S::Row>,
}

impl<S: Sensor> Table for Written<S> {
    fn write(&mut self, frame: u32, agent: &str, counts: &mut PartialCounts) -> Result<(), StageError> {
        let Some(rows) = self.reading.waiting().remove(&frame) else { return Ok(()) };
        if let Some(amount) = self.reading.sensor.amount(&rows) {
            let counted_as = &self.reading.about.counted_as;
            counts.add(agent, amount.measure, counted_as, 0, amount.count);
            if amount.measure != IMAGES {
                counts.add(agent, SWEEPS, counted_as, 0, 1);
            }
        }
        self.table.push(&rows)?;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(String, Finished), StageError> {
        Ok((self.reading.about.counted_as.clone(), self.table.finish()?))
    }
}

/// Opens a table for every sensor that it is shown.
struct TableOpener<'a, 'u> {
    unit: &'a Unit<'u>,
    scene: u32,
    agent: AgentId,
    channels: Vec<Arc<dyn Channel>>,
    tables: Vec<Box<dyn Table>>,
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

impl SensorVisitor for TableOpener<'_, '_> {
    type Error = Unopened;

    fn visit<S: Sensor + 'static>(&mut self, sensor: S) -> Result<(), Unopened> {
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
        let reading = Arc::new(Reading { sensor, about, waiting: Mutex::default() });
        self.channels.push(Arc::clone(&reading) as Arc<dyn Channel>);
        self.tables.push(Box::new(Written { reading, table }));
        Ok(())
    }
}

/// Opens a table for every sensor of a rig.
///
/// # Errors
/// A sensor's settings are impossible, or the store cannot be written.
pub(crate) fn open<'u>(
    unit: Unit<'u>,
    rig: &Rig,
    carrier: &SensorContext,
) -> Result<(Channels, Recorder<'u>), StageError> {
    let SensorContext { scene, agent, .. } = *carrier;
    let mut opening = TableOpener { unit: &unit, scene, agent, channels: Vec::new(), tables: Vec::new() };
    sensors::visit_sensors(rig, carrier, &mut opening).map_err(|e| match e {
        Unopened::Sensor(e) => {
            StageError::Failed { place: Box::new(Place::scene(scene).agent(agent)), source: e.into() }
        }
        Unopened::Stage(e) => e,
    })?;
    let TableOpener { channels, tables, .. } = opening;
    Ok((Channels(channels), Recorder { unit, scene, agent, tables, counts: PartialCounts::new() }))
}

impl Channels {
    /// The sensors that are to be read at a frame, each once.
    pub(crate) fn at(&self, frame: u32) -> impl Iterator<Item = &dyn Channel> {
        self.0.iter().map(AsRef::as_ref).filter(move |channel| channel.is_due(frame))
    }

    /// Those of the frames `0..frames` at which some sensor is read.
    pub(crate) fn due_frames(&self, frames: u32) -> Vec<u32> {
        (0..frames).filter(|&frame| self.at(frame).next().is_some()).collect()
    }
}

impl Writer<()> for Recorder<'_> {
    /// Writes a frame's readings, which must have been made, after those of all earlier frames.
    fn take(&mut self, frame: u32, (): ()) -> Result<(), StageError> {
        let agent = self.agent.to_string();
        self.tables.iter_mut().try_for_each(|table| table.write(frame, &agent, &mut self.counts))
    }

    /// Ends all tables, counts their bytes, and ends the unit.
    fn finish(self) -> Result<(), StageError> {
        let Self { mut unit, scene, agent, tables, mut counts } = self;
        for table in tables {
            let (counted_as, shard) = table.finish()?;
            counts.add(&agent.to_string(), SENSOR_BYTES, &counted_as, 0, shard.output().bytes);
            unit.add(shard);
        }
        unit.rows(
            &keys::partial_stats(scene, &format!("{}.{agent}", Stage::<SensorSettings>::NAME)),
            &counts.rows(),
        )?;
        unit.finish()?;
        Ok(())
    }
}
