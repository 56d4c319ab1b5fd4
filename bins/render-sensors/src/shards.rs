//! The tables of one agent's sensors, written frame by frame.

use std::collections::BTreeMap;

use counts::PartialCounts;
use pipeline::{At, Place, StageError};
use schema::settings::{Mount, Rig};
use schema::table::Row;
use schema::tables::{
    CameraRow, FlowRow, GNSS_TABLE, GnssRow, IMU_TABLE, ImuRow, LidarRow, PartialRow, RadarRow,
    SemanticLidarRow, VISIBLE_TABLE, VisibleRow, camera_table,
};
use schema::{AgentId, measures};
use sensors::SENSOR_METADATA_KEY;
use store::{Finished, TableOptions, TableWriter, Unit, keys};

use crate::error::KindError;
use crate::frame::{LidarReading, Readings};

/// Kind of the tables of optical flow.
const FLOW: &str = "FLW";

/// Open tables.
pub(crate) struct Shards {
    agent: String,
    cameras: Vec<CameraTables>,
    lidars: Vec<(String, LidarTable)>,
    radars: Vec<(String, TableWriter<RadarRow>)>,
    gnss: Option<TableWriter<GnssRow>>,
    imu: Option<TableWriter<ImuRow>>,
    visible: Option<TableWriter<VisibleRow>>,
    counts: PartialCounts,
}

/// Open tables of one camera, images by their kind.
struct CameraTables {
    images: BTreeMap<&'static str, TableWriter<CameraRow>>,
    flow: Option<TableWriter<FlowRow>>,
}

enum LidarTable {
    Plain(TableWriter<LidarRow>),
    Semantic(TableWriter<SemanticLidarRow>),
}

fn metadata(json: String) -> Vec<(String, String)> {
    vec![(SENSOR_METADATA_KEY.to_owned(), json)]
}

impl Shards {
    /// Opens a table for every sensor of a rig.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn create(unit: &Unit<'_>, scene: u32, agent: AgentId, rig: &Rig) -> Result<Self, StageError> {
        let key = |name: &str| keys::sensor(scene, agent, name);
        let of_mount = |name: &str, mount: &Mount| metadata(sensors::sensor_metadata(name, mount));
        let mut cameras = Vec::new();
        let settings = &rig.camera;
        let kinds = [
            ("RGB", settings.rgb),
            ("SEG", settings.semantic),
            ("IST", settings.instance),
            ("DPT", settings.depth),
        ];
        for camera in &rig.cameras {
            let about = metadata(sensors::camera_metadata(camera, settings));
            let key_of = |kind| key(&camera_table(kind, &camera.name));
            let mut images = BTreeMap::new();
            for (kind, _) in kinds.iter().filter(|(_, wanted)| *wanted) {
                let options = TableOptions::compressed_frames(about.clone());
                images.insert(*kind, unit.table(&key_of(kind), options)?);
            }
            let flow =
                settings.flow.then(|| unit.table(&key_of(FLOW), TableOptions::frames(about))).transpose()?;
            cameras.push(CameraTables { images, flow });
        }
        let mut lidars = Vec::new();
        for spec in &rig.lidars {
            let options = TableOptions::frames(of_mount(&spec.name, &spec.mount));
            let table = if spec.semantic {
                LidarTable::Semantic(unit.table(&key(&spec.name), options)?)
            } else {
                LidarTable::Plain(unit.table(&key(&spec.name), options)?)
            };
            lidars.push((spec.name.clone(), table));
        }
        let mut radars = Vec::new();
        for spec in &rig.radars {
            let options = TableOptions::frames(of_mount(&spec.name, &spec.mount));
            radars.push((spec.name.clone(), unit.table(&key(&spec.name), options)?));
        }
        let whole = |name: &str, mount: &Mount| TableOptions {
            metadata: of_mount(name, mount),
            ..TableOptions::default()
        };
        let gnss = rig
            .gnss
            .as_ref()
            .map(|s| unit.table(&key(GNSS_TABLE), whole(GNSS_TABLE, &s.mount)))
            .transpose()?;
        let imu =
            rig.imu.as_ref().map(|s| unit.table(&key(IMU_TABLE), whole(IMU_TABLE, &s.mount))).transpose()?;
        let visible = settings
            .instance
            .then(|| unit.table(&key(VISIBLE_TABLE), TableOptions::default()))
            .transpose()?;
        let (agent, counts) = (agent.to_string(), PartialCounts::new());
        Ok(Self { agent, cameras, lidars, radars, gnss, imu, visible, counts })
    }

    /// Appends a frame's readings.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn push(&mut self, readings: Readings) -> Result<(), StageError> {
        let Readings { frame, cameras, visible, lidars, radars, gnss, imu } = readings;
        for (mut camera, tables) in cameras.into_iter().zip(&mut self.cameras) {
            for (kind, row) in camera.image_rows(frame) {
                self.counts.add(&self.agent, measures::sensors::IMAGES, kind, 0, 1);
                push_to(tables.images.get_mut(kind), row)?;
            }
            if let Some(row) = camera.flow_row(frame) {
                self.counts.add(&self.agent, measures::sensors::IMAGES, FLOW, 0, 1);
                push_to(tables.flow.as_mut(), row)?;
            }
        }
        for (reading, (name, table)) in lidars.into_iter().zip(&mut self.lidars) {
            let points = match (reading, table) {
                (LidarReading::Plain(row), LidarTable::Plain(table)) => {
                    let points = row.x.len();
                    table.push(&[row])?;
                    points
                }
                (LidarReading::Semantic(row), LidarTable::Semantic(table)) => {
                    let points = row.x.len();
                    table.push(&[row])?;
                    points
                }
                _ => return Err(KindError).at(|| Place::default().frame(frame).sensor(name)),
            };
            self.counts.add(&self.agent, measures::sensors::LIDAR_POINTS, name, 0, points as u64);
        }
        for (row, (name, table)) in radars.into_iter().zip(&mut self.radars) {
            self.counts.add(&self.agent, measures::sensors::RADAR_POINTS, name, 0, row.depth.len() as u64);
            table.push(&[row])?;
        }
        if let Some(row) = gnss {
            push_to(self.gnss.as_mut(), row)?;
        }
        if let Some(row) = imu {
            push_to(self.imu.as_mut(), row)?;
        }
        if let Some(table) = &mut self.visible {
            let row = |((id, tag), pixels)| VisibleRow { frame, id, tag: tag as u8, pixels };
            let rows: Vec<VisibleRow> = visible.into_iter().map(row).collect();
            table.push(&rows)?;
        }
        Ok(())
    }

    /// Ends all tables and counts their bytes, those of images by kind.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn finish(mut self) -> Result<(Vec<Finished>, Vec<PartialRow>), StageError> {
        let mut finished = Vec::new();
        for CameraTables { images, flow } in self.cameras {
            for (kind, table) in images {
                finished.push((kind.to_owned(), table.finish()?));
            }
            if let Some(table) = flow {
                finished.push((FLOW.to_owned(), table.finish()?));
            }
        }
        for (name, table) in self.lidars {
            let shard = match table {
                LidarTable::Plain(table) => table.finish()?,
                LidarTable::Semantic(table) => table.finish()?,
            };
            finished.push((name, shard));
        }
        for (name, table) in self.radars {
            finished.push((name, table.finish()?));
        }
        for (name, shard) in [
            (GNSS_TABLE, self.gnss.map(TableWriter::finish)),
            (IMU_TABLE, self.imu.map(TableWriter::finish)),
            (VISIBLE_TABLE, self.visible.map(TableWriter::finish)),
        ] {
            if let Some(shard) = shard {
                finished.push((name.to_owned(), shard?));
            }
        }
        for (sensor, shard) in &finished {
            self.counts.add(&self.agent, measures::sensors::SENSOR_BYTES, sensor, 0, shard.output().bytes);
        }
        Ok((finished.into_iter().map(|(_, shard)| shard).collect(), self.counts.rows()))
    }
}

fn push_to<R: Row>(table: Option<&mut TableWriter<R>>, row: R) -> Result<(), StageError> {
    if let Some(table) = table {
        table.push(std::slice::from_ref(&row))?;
    }
    Ok(())
}
