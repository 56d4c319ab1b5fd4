//! What agents have of a frame, read in frame order.

use std::collections::BTreeMap;

use arguments::viz::ShownBoxes;
use export_core::SceneSource;
use frames::Sensor;
use nalgebra::{Isometry3, Point3};
use pictures::{BoxShape, Camera, Cloud, ColourBy};
use scene::{BoxFrames, LabelledBox, SensorEntry, SensorFrames, SensorKind};
use schema::calibration::Calibration;
use schema::table::Row;
use schema::tables::{AgentRow, CameraRow, FlowRow, LidarRow, RadarRow, SemanticLidarRow};
use schema::{AgentId, DetectionClass, Difficulty, ImageKind};

use crate::error::VizError;

/// What is read of an agent.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wants {
    /// Tables of sensors, by name.
    pub(crate) sensors: Vec<String>,
    /// Which boxes.
    pub(crate) boxes: ShownBoxes,
}

/// What an agent has of a frame.
#[derive(Debug)]
pub(crate) struct AgentFrame {
    pub(crate) agent: AgentId,
    /// Its place in the scene's list.
    pub(crate) position: usize,
    /// Its object id: its own body.
    pub(crate) id: u16,
    pub(crate) world_from_agent: Isometry3<f64>,
    /// Corners of its own box in the world, where boxes are read.
    pub(crate) body: Option<[Point3<f64>; 8]>,
    /// Encoded images, by the name of their table.
    pub(crate) images: BTreeMap<String, Vec<u8>>,
    pub(crate) flows: BTreeMap<String, FlowRow>,
    /// Points in the frames of their sensors, by name.
    pub(crate) clouds: BTreeMap<String, Cloud>,
    /// Boxes, each with whether the agent saw it.
    pub(crate) boxes: Vec<(BoxShape, bool)>,
    /// How many boxes there are, drawn or not.
    pub(crate) box_count: usize,
}

/// Readings of a sensor, one after another.
enum Readings {
    Image(SensorFrames<CameraRow>),
    Flow(SensorFrames<FlowRow>),
    Lidar(SensorFrames<LidarRow>),
    SemanticLidar(SensorFrames<SemanticLidarRow>),
    Radar(SensorFrames<RadarRow>),
}

/// Reads what is wanted of an agent. Frames must be asked for in ascending order.
pub(crate) struct Feed {
    agent: AgentId,
    position: usize,
    rows: Vec<AgentRow>,
    sensors: Vec<SensorEntry>,
    readings: Vec<(String, Readings, Vec<ColourBy>)>,
    boxes: Option<BoxFrames>,
    shown: ShownBoxes,
}

impl Feed {
    pub(crate) fn open(
        source: &SceneSource,
        (position, agent): (usize, AgentId),
        rows: Vec<AgentRow>,
        wants: &Wants,
    ) -> Result<Self, VizError> {
        let sensors = if source.has(CameraRow::STAGE) { source.sensors(agent)? } else { Vec::new() };
        let mut readings = Vec::new();
        for entry in sensors.iter().filter(|s| wants.sensors.contains(&s.name)) {
            let open = match entry.kind {
                SensorKind::Image(ImageKind::Flow) => Readings::Flow(source.readings(agent, entry)?),
                SensorKind::Image(_) => Readings::Image(source.readings(agent, entry)?),
                SensorKind::Lidar => Readings::Lidar(source.readings(agent, entry)?),
                SensorKind::SemanticLidar => Readings::SemanticLidar(source.readings(agent, entry)?),
                SensorKind::Radar => Readings::Radar(source.readings(agent, entry)?),
                SensorKind::Gnss | SensorKind::Imu => continue,
            };
            readings.push((entry.name.clone(), open, unknown_colours(source, agent, entry)?));
        }
        let boxes = if wants.boxes == ShownBoxes::None { None } else { Some(source.boxes(agent)?) };
        Ok(Self { agent, position, rows, sensors, readings, boxes, shown: wants.boxes })
    }

    /// What its sensors say of themselves.
    pub(crate) fn rig(&self) -> Rig {
        let about = self.sensors.iter().map(|s| (s.name.clone(), (s.kind, s.about.clone())));
        Rig { agent: self.agent, about: about.collect() }
    }

    /// What it has of a frame.
    pub(crate) fn at(&mut self, frame: u32) -> Result<AgentFrame, VizError> {
        let row = self.rows.get(frame as usize).ok_or_else(|| {
            let last = self.rows.len().saturating_sub(1);
            VizError::Refused(format!("there is no frame {frame}: frames are 0 to {last}"))
        })?;
        let pose = frames::Pose::<frames::World, frames::Agent>::from_xyz_wxyz(row.xyz_m, row.quaternion);
        let mut found = AgentFrame {
            agent: self.agent,
            position: self.position,
            id: row.id,
            world_from_agent: *pose.isometry(),
            body: None,
            images: BTreeMap::new(),
            flows: BTreeMap::new(),
            clouds: BTreeMap::new(),
            boxes: Vec::new(),
            box_count: 0,
        };
        for (name, readings, unknown) in &mut self.readings {
            let name = name.clone();
            let known = |cloud: Cloud| unknown.iter().fold(cloud, |cloud, by| cloud.without(*by));
            match readings {
                Readings::Image(rows) => {
                    found.images.extend(rows.at(frame)?.map(|row| (name, row.image.0)));
                }
                Readings::Flow(rows) => found.flows.extend(rows.at(frame)?.map(|row| (name, row))),
                Readings::Lidar(rows) => {
                    found.clouds.extend(rows.at(frame)?.map(|row| (name, known(lidar_cloud(row)))));
                }
                Readings::SemanticLidar(rows) => {
                    found.clouds.extend(rows.at(frame)?.map(|row| (name, known(semantic_cloud(row)))));
                }
                Readings::Radar(rows) => {
                    found.clouds.extend(rows.at(frame)?.map(|row| (name, known(radar_cloud(row)))));
                }
            }
        }
        if let Some(boxes) = &mut self.boxes {
            let labelled = boxes.at(frame)?;
            found.box_count = labelled.len();
            let shapes: Vec<(BoxShape, bool)> = labelled.iter().filter_map(shape_of).collect();
            found.body =
                shapes.iter().find(|(shape, _)| shape.id == row.id).map(|(shape, _)| shape.corners_m);
            let shapes = shapes.into_iter();
            found.boxes = shapes.filter(|(_, is_seen)| *is_seen || self.shown == ShownBoxes::All).collect();
        }
        Ok(found)
    }
}

/// What the points of a sensor cannot be coloured by, because the dataset that was imported did not say it.
pub(crate) fn unknown_colours(
    source: &SceneSource,
    agent: AgentId,
    sensor: &SensorEntry,
) -> Result<Vec<ColourBy>, VizError> {
    let columns = source.unknown_columns(agent, sensor)?;
    let is_unknown = |by: &ColourBy| by.column().is_some_and(|column| columns.contains(column));
    Ok(ColourBy::ALL.into_iter().filter(is_unknown).collect())
}

/// A box as it is drawn, and whether the agent saw it; as if easy and seen where nobody has looked.
fn shape_of(found: &LabelledBox) -> Option<(BoxShape, bool)> {
    let raw = &found.raw;
    let class = DetectionClass::from_name(&raw.class)?;
    let corner =
        |i: usize| Point3::new(raw.corners_m[3 * i], raw.corners_m[3 * i + 1], raw.corners_m[3 * i + 2]);
    let difficulty = match found.seen.as_ref().map(|seen| seen.difficulty.as_str()) {
        None | Some("easy") => Difficulty::Easy,
        Some("medium") => Difficulty::Medium,
        Some(_) => Difficulty::Hard,
    };
    let is_seen = found.seen.as_ref().is_none_or(|seen| seen.valid_flag);
    let corners_m = std::array::from_fn(corner);
    Some((BoxShape { id: raw.id, corners_m, class, difficulty }, is_seen))
}

fn places(x: &[f32], y: &[f32], z: &[f32]) -> Vec<[f32; 3]> {
    x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect()
}

fn lidar_cloud(row: LidarRow) -> Cloud {
    let xyz_m = places(&row.x, &row.y, &row.z);
    Cloud { xyz_m, tag: row.tag, id: row.id, intensity: row.intensity, velocity: Vec::new() }
}

fn semantic_cloud(row: SemanticLidarRow) -> Cloud {
    let xyz_m = places(&row.x, &row.y, &row.z);
    Cloud { xyz_m, tag: row.tag, id: row.id, intensity: row.intensity, velocity: Vec::new() }
}

fn radar_cloud(row: RadarRow) -> Cloud {
    let cloud = Cloud::from_polar(&row.depth, &row.altitude, &row.azimuth, &row.velocity);
    Cloud { tag: row.tag, id: row.id, ..cloud }
}

/// Where an agent's sensors are.
#[derive(Clone, Debug)]
pub(crate) struct Rig {
    agent: AgentId,
    about: BTreeMap<String, (SensorKind, Calibration)>,
}

/// Height of the lidar over the agent's origin where there is none, metres: vehicles' and RSUs'.
const LIDAR_HEIGHTS_M: [f64; 2] = [1.8, 3.2];

impl Rig {
    /// What a sensor says of itself.
    pub(crate) fn sensor(&self, name: &str) -> Option<&Calibration> {
        self.about.get(name).map(|(_, about)| about)
    }

    /// Names of the sensors of a kind.
    pub(crate) fn names(&self, kind: SensorKind) -> impl Iterator<Item = &str> {
        self.about.iter().filter(move |(_, (k, _))| *k == kind).map(|(name, _)| name.as_str())
    }

    /// A camera in the frame of reference in which the agent has a pose.
    pub(crate) fn camera(&self, name: &str, space_from_agent: &Isometry3<f64>) -> Option<Camera> {
        Camera::of(self.sensor(name)?, space_from_agent)
    }

    /// Where a sensor with axes of its own (FLU) is.
    pub(crate) fn agent_from(&self, name: &str) -> Isometry3<f64> {
        let mounted = self.sensor(name).map(|about| about.agent_from_sensor.agent_from_sensor::<Sensor>());
        mounted.map_or_else(Isometry3::identity, |pose| *pose.isometry())
    }

    /// Where the first lidar is (a plain one before a semantic one): the place that views are about.
    pub(crate) fn agent_from_lidar(&self) -> Isometry3<f64> {
        let kinds = [SensorKind::Lidar, SensorKind::SemanticLidar];
        match kinds.into_iter().find_map(|kind| self.names(kind).next()) {
            Some(name) => self.agent_from(name),
            None => {
                let height_m = LIDAR_HEIGHTS_M[usize::from(self.agent.kind == schema::AgentKind::Rsu)];
                Isometry3::translation(0.0, 0.0, height_m)
            }
        }
    }
}
