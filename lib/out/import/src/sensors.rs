//! The sensors of an agent: a table each, and what instance images show.

use std::collections::BTreeMap;

use rayon::prelude::*;
use schema::calibration::METADATA_KEY;
use schema::measures::counts::PartialCounts;
use schema::measures::sensors::{IMAGES, LIDAR_POINTS, RADAR_POINTS, SENSOR_BYTES, SWEEPS};
use schema::tables::{
    CameraRow, FlowRow, GnssRow, ImuRow, LidarRow, RadarRow, SemanticLidarRow, VISIBLE_TABLE, VisibleRow,
};
use schema::{AgentId, ImageKind, SensorKind, ZERO_COLUMNS};
use store::{Finished, StoreError, TableOptions, TableWriter, Unit, keys};

use crate::error::ImportError;
use crate::names::sensor_of;
use crate::pictures;
use crate::readings::{self, Reading, zero_columns};
use crate::work::Work;

/// Frames that are read at once: those of six cameras with flow take 80 MB each.
const BATCH: usize = 4;

/// A table in hand.
enum Table {
    Image(TableWriter<CameraRow>, (u32, u32)),
    Flow(TableWriter<FlowRow>, (u32, u32)),
    Lidar(TableWriter<LidarRow>),
    SemanticLidar(TableWriter<SemanticLidarRow>),
    Radar(TableWriter<RadarRow>),
    Gnss(TableWriter<GnssRow>),
    Imu(TableWriter<ImuRow>),
}

/// The sensors of an agent, by their keys.
pub(crate) fn of_agent(agent: AgentId, record: &crate::infos::Record) -> Vec<(String, SensorKind)> {
    let known = |key: &String| Some((key.clone(), sensor_of(agent.kind, key)?));
    record.files.keys().filter_map(known).collect()
}

/// Pixels of each object and tag of a frame.
type Pixels = BTreeMap<(u16, u8), u32>;

/// Writes the tables of an agent's sensors into a unit.
pub(crate) fn write(
    work: &Work<'_>,
    position: usize,
    unit: &mut Unit<'_>,
) -> Result<PartialCounts, ImportError> {
    let (agent, records) = &work.scene.agents[position];
    let sensors = of_agent(*agent, &records[0]);
    let has_instances = sensors.iter().any(|(_, kind)| *kind == SensorKind::Image(ImageKind::Instance));
    let mut counts = PartialCounts::new();
    let mut tables: Vec<Table> = Vec::new();
    let mut visible: Vec<VisibleRow> = Vec::new();
    let frames: Vec<u32> = (0..work.scene.frames()).collect();
    for batch in frames.chunks(BATCH) {
        let read: Vec<Result<(Vec<Reading>, Pixels), ImportError>> =
            batch.par_iter().map(|&frame| read_frame(work, position, &sensors, frame)).collect();
        for (&frame, read) in batch.iter().zip(read) {
            let (readings, pixels) = read?;
            for (i, reading) in readings.into_iter().enumerate() {
                if tables.len() == i {
                    tables.push(open(work, *agent, &sensors[i], &reading, unit)?);
                }
                let (name, _) = &sensors[i];
                let place = |problem| work.wrong(position, frame, name, problem);
                count(&agent.to_string(), name, &reading, &mut counts);
                push(&mut tables[i], reading).map_err(|e| e.unwrap_or_else(place))?;
            }
            let row = |((id, tag), pixels)| VisibleRow { frame, id, tag, pixels };
            visible.extend(pixels.into_iter().map(row));
        }
        work.advance(batch.len() as u64)?;
    }
    let name = agent.to_string();
    for (table, (sensor, kind)) in tables.into_iter().zip(&sensors) {
        let shard = finish(table)?;
        let counted_as = counted_as(sensor, *kind);
        counts.add(&name, SENSOR_BYTES, counted_as, 0, shard.output().bytes);
        unit.add(shard);
    }
    if has_instances {
        let mut table = unit
            .table(&keys::sensor(work.order.entry.number, *agent, VISIBLE_TABLE), TableOptions::default())?;
        table.push(&visible)?;
        let shard = table.finish()?;
        counts.add(&name, SENSOR_BYTES, VISIBLE_TABLE, 0, shard.output().bytes);
        unit.add(shard);
    }
    Ok(counts)
}

fn read_frame(
    work: &Work<'_>,
    position: usize,
    sensors: &[(String, SensorKind)],
    frame: u32,
) -> Result<(Vec<Reading>, Pixels), ImportError> {
    let (agent, records) = &work.scene.agents[position];
    let files = &records[frame as usize].files;
    let mut pixels = Pixels::new();
    let mut found = Vec::with_capacity(sensors.len());
    for (name, kind) in sensors {
        let place = |e: ImportError| e.within(format!("{agent} frame {frame} {name}"));
        let said = files.get(name).map(String::as_str).unwrap_or_default();
        let reading = readings::read(work.order.folder, said, *kind, frame, work.cast).map_err(place)?;
        if let (Reading::Image(row, _), SensorKind::Image(ImageKind::Instance)) = (&reading, kind) {
            let counted = pictures::count_instances(&row.image.0, &mut pixels);
            counted.map_err(|problem| place(ImportError::source(std::path::Path::new(said), problem)))?;
        }
        found.push(reading);
    }
    Ok((found, pixels))
}

/// Opens the table of a sensor when its first reading is there.
fn open(
    work: &Work<'_>,
    agent: AgentId,
    (name, kind): &(String, SensorKind),
    first: &Reading,
    unit: &Unit<'_>,
) -> Result<Table, ImportError> {
    let rig = work.order.rigs.rig(agent.kind);
    let camera = name.split_once('-').map_or(name.as_str(), |(_, camera)| camera);
    let about = match first {
        Reading::Image(_, size) => rig.camera(camera, *size),
        Reading::Flow(row) => rig.camera(camera, (row.width, row.height)),
        _ => rig.flat(name),
    };
    let key = keys::sensor(work.order.entry.number, agent, name);
    // Our own types and plain numbers: they always can be written.
    let mut metadata = vec![(METADATA_KEY.to_owned(), serde_json::to_string(&about).unwrap_or_default())];
    if !zero_columns(*kind).is_empty() {
        let named = serde_json::to_string(zero_columns(*kind)).unwrap_or_default();
        metadata.push((ZERO_COLUMNS.to_owned(), named));
    }
    let plain = TableOptions { metadata: metadata.clone(), ..TableOptions::default() };
    let framed = TableOptions::frames(metadata.clone());
    Ok(match first {
        Reading::Image(_, size) => {
            Table::Image(unit.table(&key, TableOptions::compressed_frames(metadata))?, *size)
        }
        Reading::Flow(row) => Table::Flow(unit.table(&key, framed)?, (row.width, row.height)),
        Reading::Lidar(_) => Table::Lidar(unit.table(&key, framed)?),
        Reading::SemanticLidar(_) => Table::SemanticLidar(unit.table(&key, framed)?),
        Reading::Radar(_) => Table::Radar(unit.table(&key, framed)?),
        Reading::Gnss(_) => Table::Gnss(unit.table(&key, plain)?),
        Reading::Imu(_) => Table::Imu(unit.table(&key, plain)?),
    })
}

/// Appends a reading; an error of the store, or what is wrong with the reading.
fn push(table: &mut Table, reading: Reading) -> Result<(), Fault> {
    let pushed = match (table, reading) {
        (Table::Image(table, size), Reading::Image(row, found)) if *size == found => table.push(&[row]),
        (Table::Flow(table, size), Reading::Flow(row)) if *size == (row.width, row.height) => {
            table.push(&[row])
        }
        (Table::Lidar(table), Reading::Lidar(row)) => table.push(&[row]),
        (Table::SemanticLidar(table), Reading::SemanticLidar(row)) => table.push(&[row]),
        (Table::Radar(table), Reading::Radar(row)) => table.push(&[row]),
        (Table::Gnss(table), Reading::Gnss(row)) => table.push(&[row]),
        (Table::Imu(table), Reading::Imu(row)) => table.push(&[row]),
        _ => return Err(Fault::Reading("has another size than that of frame 0")),
    };
    pushed.map_err(Fault::Store)
}

/// Why a reading is not in its table.
enum Fault {
    Store(StoreError),
    Reading(&'static str),
}

impl Fault {
    fn unwrap_or_else(self, place: impl FnOnce(&'static str) -> ImportError) -> ImportError {
        match self {
            Self::Store(e) => e.into(),
            Self::Reading(problem) => place(problem),
        }
    }
}

/// What a sensor's table is counted as: images by their kind.
fn counted_as(name: &str, kind: SensorKind) -> &str {
    match kind {
        SensorKind::Image(image) => image.spec().prefix,
        _ => name,
    }
}

fn count(agent: &str, name: &str, reading: &Reading, counts: &mut PartialCounts) {
    let (measure, points) = match reading {
        Reading::Image(..) | Reading::Flow(_) => {
            let kind = name.split('-').next().unwrap_or_default();
            counts.add(agent, IMAGES, kind, 0, 1);
            return;
        }
        Reading::Lidar(row) => (LIDAR_POINTS, row.x.len()),
        Reading::SemanticLidar(row) => (LIDAR_POINTS, row.x.len()),
        Reading::Radar(row) => (RADAR_POINTS, row.depth.len()),
        Reading::Gnss(_) | Reading::Imu(_) => return,
    };
    counts.add(agent, measure, name, 0, points as u64);
    counts.add(agent, SWEEPS, name, 0, 1);
}

fn finish(table: Table) -> Result<Finished, StoreError> {
    match table {
        Table::Image(table, _) => table.finish(),
        Table::Flow(table, _) => table.finish(),
        Table::Lidar(table) => table.finish(),
        Table::SemanticLidar(table) => table.finish(),
        Table::Radar(table) => table.finish(),
        Table::Gnss(table) => table.finish(),
        Table::Imu(table) => table.finish(),
    }
}
