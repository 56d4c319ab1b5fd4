//! The tables of one agent's sensors, written frame by frame.

use std::collections::BTreeMap;

use pipeline::StageError;
use schema::settings::{Mount, Rig};
use schema::table::Row;
use schema::tables::{
    CameraRow, FlowRow, GnssRow, ImuRow, LidarRow, PartialRow, RadarRow, SemanticLidarRow, VisibleRow,
};
use schema::{AgentId, measures};
use sensors::SENSOR_METADATA_KEY;
use store::{Finished, TableOptions, TableWriter, Unit, keys};
use truth::counts::Counts;

use crate::frame::{LidarReading, Readings};

/// Open tables.
pub(crate) struct Shards {
    agent: String,
    images: BTreeMap<String, TableWriter<CameraRow>>,
    flows: BTreeMap<String, TableWriter<FlowRow>>,
    camera_names: Vec<String>,
    lidars: Vec<(String, LidarTable)>,
    radars: Vec<(String, TableWriter<RadarRow>)>,
    gnss: Option<TableWriter<GnssRow>>,
    imu: Option<TableWriter<ImuRow>>,
    visible: Option<TableWriter<VisibleRow>>,
    counts: Counts,
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
        let (mut images, mut flows) = (BTreeMap::new(), BTreeMap::new());
        let settings = &rig.camera;
        let kinds = [
            ("RGB", settings.rgb),
            ("SEG", settings.semantic),
            ("IST", settings.instance),
            ("DPT", settings.depth),
        ];
        for camera in &rig.cameras {
            let about = metadata(sensors::camera_metadata(camera, settings));
            for (kind, _) in kinds.iter().filter(|(_, wanted)| *wanted) {
                let name = format!("{kind}-{}", camera.name);
                let table = unit.table(&key(&name), TableOptions::compressed_frames(about.clone()))?;
                images.insert(name, table);
            }
            if settings.flow {
                let name = format!("FLW-{}", camera.name);
                let table = unit.table(&key(&name), TableOptions::frames(about))?;
                flows.insert(name, table);
            }
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
        let gnss =
            rig.gnss.as_ref().map(|s| unit.table(&key("GNSS"), whole("GNSS", &s.mount))).transpose()?;
        let imu = rig.imu.as_ref().map(|s| unit.table(&key("IMU"), whole("IMU", &s.mount))).transpose()?;
        let visible =
            settings.instance.then(|| unit.table(&key("visible"), TableOptions::default())).transpose()?;
        let camera_names = rig.cameras.iter().map(|c| c.name.clone()).collect();
        let (agent, counts) = (agent.to_string(), Counts::new());
        Ok(Self { agent, images, flows, camera_names, lidars, radars, gnss, imu, visible, counts })
    }

    /// Appends a frame's readings.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn push(&mut self, readings: Readings) -> Result<(), StageError> {
        let Readings { frame, cameras, visible, lidars, radars, gnss, imu } = readings;
        for (mut camera, name) in cameras.into_iter().zip(&self.camera_names) {
            for (kind, row) in camera.image_rows(frame) {
                let bytes = row.image.0.len() as u64;
                self.counts.add(&self.agent, measures::IMAGES, kind, 0, 1);
                self.counts.add(&self.agent, measures::SENSOR_BYTES, kind, 0, bytes);
                push_to(self.images.get_mut(&format!("{kind}-{name}")), row)?;
            }
            if let Some(row) = camera.flow_row(frame) {
                self.counts.add(&self.agent, measures::IMAGES, "FLW", 0, 1);
                push_to(self.flows.get_mut(&format!("FLW-{name}")), row)?;
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
                _ => {
                    return Err(StageError::Failed(format!(
                        "{name}: reading and table are of different kinds"
                    )));
                }
            };
            self.counts.add(&self.agent, measures::LIDAR_POINTS, name, 0, points as u64);
        }
        for (row, (name, table)) in radars.into_iter().zip(&mut self.radars) {
            self.counts.add(&self.agent, measures::RADAR_POINTS, name, 0, row.depth.len() as u64);
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

    /// Ends all tables.
    ///
    /// # Errors
    /// The store cannot be written.
    pub(crate) fn finish(self) -> Result<(Vec<Finished>, Vec<PartialRow>), StageError> {
        let mut finished = Vec::new();
        for table in self.images.into_values() {
            finished.push(table.finish()?);
        }
        for table in self.flows.into_values() {
            finished.push(table.finish()?);
        }
        for (_, table) in self.lidars {
            finished.push(match table {
                LidarTable::Plain(table) => table.finish()?,
                LidarTable::Semantic(table) => table.finish()?,
            });
        }
        for (_, table) in self.radars {
            finished.push(table.finish()?);
        }
        for table in [self.gnss.map(TableWriter::finish), self.imu.map(TableWriter::finish)] {
            finished.extend(table.transpose()?);
        }
        finished.extend(self.visible.map(TableWriter::finish).transpose()?);
        Ok((finished, self.counts.rows()))
    }
}

fn push_to<R: Row>(table: Option<&mut TableWriter<R>>, row: R) -> Result<(), StageError> {
    if let Some(table) = table {
        table.push(std::slice::from_ref(&row))?;
    }
    Ok(())
}
