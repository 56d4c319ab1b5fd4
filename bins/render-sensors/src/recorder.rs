//! The sensors of one agent, and their tables: readings are made and encoded in any order, on any thread, and
//! appended frame by frame.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use runner::frames::Writer;
use runner::{At, Place, StageError};
use schema::calibration::METADATA_KEY;
use schema::measures::counts::PartialCounts;
use schema::measures::sensors::{IMAGES, SENSOR_BYTES, SWEEPS};
use schema::{AgentId, rate};
use sensors::{Amount, Layout, Observation, Sensor, SensorContext, SensorError, SensorTable, SensorVisitor};
use settings::Rig;
use store::{EncodedGroup, Finished, GroupEncoder, Output, TableOptions, TableWriter, keys};

use crate::due::{AgentTables, counts_key};

/// All sensors of one agent whose tables are made; any thread reads them.
pub(crate) struct Channels(Vec<Arc<dyn Channel>>);

/// The tables of one agent's sensors.
pub(crate) struct Recorder<'u> {
    tables: AgentTables<'u>,
    scene: u32,
    agent: AgentId,
    open: Vec<Box<dyn Table>>,
    /// What the bytes of tables that were kept are counted as.
    kept: Vec<(String, Output)>,
}

/// A sensor that keeps what it read until it is written, whatever its rows are.
pub(crate) trait Channel: Send + Sync {
    /// Name of the table.
    fn name(&self) -> &str;

    /// Whether the sensor is read at a frame.
    fn is_due(&self, frame: u32) -> bool;

    /// Reads the sensor and keeps what it read. `place` is where, for messages.
    fn sense(&self, at: &Observation<'_>, place: &dyn Fn() -> Place) -> Result<(), StageError>;
}

/// The open table of a sensor.
trait Table: Send {
    /// Appends what was kept of a frame.
    fn write(&mut self, frame: u32) -> Result<(), StageError>;

    /// Ends the table; tells what its bytes are counted as, and what was counted of it.
    fn finish(self: Box<Self>) -> Result<(String, Finished, BTreeMap<String, u64>), StageError>;
}

struct Reading<S: Sensor> {
    sensor: S,
    about: SensorTable,
    /// For tables of which a frame is a group.
    encoder: Option<GroupEncoder<S::Row>>,
    /// What waits for earlier frames, by frame.
    waiting: Mutex<BTreeMap<u32, Waiting<S::Row>>>,
}

/// What a sensor read at a frame, until it is written.
struct Waiting<R> {
    rows: Rows<R>,
    amount: Option<Amount>,
}

enum Rows<R> {
    /// They fill groups together with those of other frames.
    Plain(Vec<R>),
    Encoded(Vec<EncodedGroup>),
}

impl<S: Sensor> Reading<S> {
    /// What a panic elsewhere left is never written: the unit is not finished.
    fn waiting(&self) -> MutexGuard<'_, BTreeMap<u32, Waiting<S::Row>>> {
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

    fn sense(&self, at: &Observation<'_>, place: &dyn Fn() -> Place) -> Result<(), StageError> {
        let rows = self.sensor.sense(at).at(place)?;
        let amount = self.sensor.amount(&rows);
        let rows = match &self.encoder {
            Some(encoder) => Rows::Encoded(encoder.encode(&rows)?),
            None => Rows::Plain(rows),
        };
        self.waiting().insert(at.frame, Waiting { rows, amount });
        Ok(())
    }
}

struct Written<S: Sensor> {
    reading: Arc<Reading<S>>,
    table: TableWriter<S::Row>,
    /// By measure.
    counts: BTreeMap<String, u64>,
}

impl<S: Sensor> Table for Written<S> {
    fn write(&mut self, frame: u32) -> Result<(), StageError> {
        let Some(Waiting { rows, amount }) = self.reading.waiting().remove(&frame) else { return Ok(()) };
        if let Some(amount) = amount {
            let mut add = |measure: &str, count| {
                *self.counts.entry(measure.to_owned()).or_default() += count;
            };
            add(amount.measure, amount.count);
            if amount.measure != IMAGES {
                add(SWEEPS, 1);
            }
        }
        match rows {
            Rows::Plain(rows) => self.table.push(&rows)?,
            Rows::Encoded(groups) => groups.into_iter().try_for_each(|group| self.table.append(group))?,
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(String, Finished, BTreeMap<String, u64>), StageError> {
        Ok((self.reading.about.counted_as.clone(), self.table.finish()?, self.counts))
    }
}

/// Opens a table for every sensor that it is shown and whose table was not kept.
struct TableOpener<'a, 'u> {
    tables: &'a AgentTables<'u>,
    scene: u32,
    agent: AgentId,
    channels: Vec<Arc<dyn Channel>>,
    open: Vec<Box<dyn Table>>,
    kept: Vec<(String, Output)>,
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
        let key = keys::sensor(self.scene, self.agent, &about.name);
        if let Some(kept) = self.tables.kept(&key) {
            self.kept.push((about.counted_as, kept.clone()));
            return Ok(());
        }
        self.tables.made_from(&key).map_err(Unopened::Stage)?;
        let metadata: Vec<(String, String)> =
            about.metadata.iter().map(|json| (METADATA_KEY.to_owned(), json.clone())).collect();
        let options = match about.layout {
            Layout::Frames => TableOptions::frames(metadata),
            Layout::CompressedFrames => TableOptions::compressed_frames(metadata),
            Layout::Whole => TableOptions { metadata, ..TableOptions::default() },
        };
        let table = self.tables.unit.table(&key, options).map_err(|e| Unopened::Stage(e.into()))?;
        let is_framed = about.layout != Layout::Whole;
        let encoder = is_framed.then(|| table.encoder());
        let reading = Arc::new(Reading { sensor, about, encoder, waiting: Mutex::default() });
        self.channels.push(Arc::clone(&reading) as Arc<dyn Channel>);
        self.open.push(Box::new(Written { reading, table, counts: BTreeMap::new() }));
        Ok(())
    }
}

/// Opens a table for every sensor of a rig whose table was not kept.
///
/// # Errors
/// A sensor's settings are impossible, or the store cannot be written.
pub(crate) fn open<'u>(
    tables: AgentTables<'u>,
    rig: &Rig,
    carrier: &SensorContext,
) -> Result<(Channels, Recorder<'u>), StageError> {
    let SensorContext { scene, agent, .. } = *carrier;
    let mut opener = TableOpener {
        tables: &tables,
        scene,
        agent,
        channels: Vec::new(),
        open: Vec::new(),
        kept: Vec::new(),
    };
    sensors::visit_sensors(rig, carrier, &mut opener).map_err(|e| match e {
        Unopened::Sensor(e) => {
            StageError::Failed { place: Box::new(Place::scene(scene).agent(agent)), source: e.into() }
        }
        Unopened::Stage(e) => e,
    })?;
    let TableOpener { channels, open, kept, .. } = opener;
    Ok((Channels(channels), Recorder { tables, scene, agent, open, kept }))
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
        self.open.iter_mut().try_for_each(|table| table.write(frame))
    }

    /// Ends all tables, counts what is in them and in those that were kept, and ends the unit.
    fn finish(self) -> Result<(), StageError> {
        let Self { mut tables, scene, agent, open, kept } = self;
        let (mut counts, name) = (PartialCounts::new(), agent.to_string());
        let mut count = |counted_as: &str, bytes: u64, amounts: &BTreeMap<String, u64>| {
            counts.add(&name, SENSOR_BYTES, counted_as, 0, bytes);
            for (measure, amount) in amounts {
                counts.add(&name, measure, counted_as, 0, *amount);
            }
        };
        for (counted_as, output) in &kept {
            count(counted_as, output.bytes, &output.counts);
        }
        for table in open {
            let (counted_as, shard, amounts) = table.finish()?;
            count(&counted_as, shard.output().bytes, &amounts);
            tables.add(shard, amounts)?;
        }
        let key = counts_key(scene, agent);
        if tables.kept(&key).is_none() {
            let shard = tables.unit.finished_rows(&key, &counts.rows())?;
            tables.add(shard, BTreeMap::new())?;
        }
        tables.unit.finish()?;
        Ok(())
    }
}
