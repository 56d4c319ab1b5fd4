//! An agent of a scene: its files, and its rows for the tables of the end.

use frames::{Pose, Sensor};
use nalgebra::Isometry3;
use scene::SensorFrames;
use schema::AgentId;
use schema::tables::{AgentRow, CameraRow};
use serde::{Deserialize, Serialize};

use super::boxes::{Annotations, Objects, Sight, is_annotated};
use super::clouds::{Returns, Sweep, lidar_file, radar_file, radar_velocity, sensor_from_layout};
use super::mask::merge;
use super::options::NuScenesOptions;
use super::rig::{Channel, Rig, is_labelled, sample_step};
use super::rows::{
    CalibratedSensor, EgoPose, LidarSeg, Log, POSE_STEPS, Row, Sample, SampleData, Scene, rounded, token,
};
use super::vocabulary::Modality;
use crate::{ExportError, SceneSource, UnitFiles};

/// When scene 0 begins, microseconds since 1970. Simulations have no date.
const EPOCH_US: u64 = 1_500_000_000_000_000;
/// From the beginning of a scene to that of the next: readers sort samples by time, and scenes must not mix.
const SCENE_US: u64 = 10_000_000_000;

/// What an agent of a scene leaves for the end; its rows are in a file of their own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fragment {
    /// The folder of its tables.
    pub(crate) version: String,
    pub(crate) split: String,
    pub(crate) map: String,
    pub(crate) scene_name: String,
    pub(crate) log_token: String,
    /// Frame, moment of the scene (microseconds) and token of each sample.
    pub(crate) samples: Vec<(u32, u64, String)>,
    /// Channels with their modalities.
    pub(crate) channels: Vec<(String, String)>,
    /// Least and greatest x and y of the agent's ways, and of the boxes, m, in the world.
    pub(crate) way: [f64; 4],
    pub(crate) boxes: Option<[f64; 4]>,
    /// The file with its rows.
    pub(crate) rows: String,
}

/// The name of an agent's scene.
pub(crate) fn scene_name(scene: u32, agent: AgentId) -> String {
    format!("{scene:04}-{agent}")
}

/// An open table of readings.
enum Readings {
    Camera(SensorFrames<CameraRow>),
    Lidar(SensorFrames<Sweep>),
    Radar(SensorFrames<Returns>),
}

/// A channel in the making.
struct Source {
    channel: Channel,
    readings: Readings,
    calibration_token: String,
    /// Whether its points have labels.
    is_labelled: bool,
    /// Frames of its readings in the export, ascending, and how many are done.
    frames: Vec<u32>,
    done: usize,
}

/// An agent in the making.
struct Unit<'a, 'f> {
    scene: &'a SceneSource,
    agent: AgentId,
    options: &'a NuScenesOptions,
    /// What all its tokens begin with.
    words: String,
    name: String,
    version: String,
    /// Frames of its samples.
    samples: Vec<u32>,
    poses: Vec<AgentRow>,
    objects: Objects,
    rows: Vec<Row>,
    files: &'a mut UnitFiles<'f>,
}

/// Writes the files of an agent of a scene, and its rows.
pub(crate) fn write(
    scene: &SceneSource,
    agent: AgentId,
    options: &NuScenesOptions,
    files: &mut UnitFiles<'_>,
) -> Result<Fragment, ExportError> {
    let place = scene.agents().iter().position(|a| *a == agent).unwrap_or_default();
    let info = scene.info();
    let step = sample_step(scene, options)?;
    let mut unit = Unit {
        scene,
        agent,
        options,
        words: format!("{} {} {} {agent}", info.map_hash, info.seed, info.scene),
        name: scene_name(info.scene, agent),
        version: options.version_of(&info.split, &info.map),
        samples: scene.frames().filter(|frame| frame % step == 0).collect(),
        poses: scene.agent_rows()?.swap_remove(place),
        objects: Objects::read(scene)?,
        rows: Vec::new(),
        files,
    };
    let channels = Rig::of(scene, agent)?.channels;
    let named = channels.iter().map(|c| (c.name.clone(), c.modality.name().to_owned())).collect();
    let mut sources = channels.into_iter().map(|c| unit.open(c)).collect::<Result<Vec<_>, _>>()?;
    unit.describe();
    let annotations = unit.frames(&mut sources)?;
    let boxes = annotations.bounds();
    unit.rows.extend(annotations.finish());
    let rows = unit.put_rows()?;
    let samples = unit.samples.iter().map(|f| (*f, unit.moment_us(*f), unit.sample_token(*f))).collect();
    let way = unit.poses.iter().map(|pose| [pose.xyz_m[0], pose.xyz_m[1]]);
    Ok(Fragment {
        split: info.split.clone(),
        map: info.map.clone(),
        log_token: unit.log_token(),
        samples,
        channels: named,
        way: super::mask::bounds(way).unwrap_or_default(),
        boxes,
        rows,
        scene_name: unit.name,
        version: unit.version,
    })
}

impl Unit<'_, '_> {
    fn token(&self, what: &str) -> String {
        token(&format!("{what} {}", self.words))
    }

    fn log_token(&self) -> String {
        self.token("log")
    }

    fn scene_token(&self) -> String {
        self.token("scene")
    }

    fn sample_token(&self, frame: u32) -> String {
        self.token(&format!("sample {frame}"))
    }

    fn data_token(&self, channel: &str, frame: u32) -> String {
        self.token(&format!("data {channel} {frame}"))
    }

    fn pose_token(&self, frame: u32) -> String {
        self.token(&format!("pose {frame}"))
    }

    /// When a frame is, microseconds since 1970, for all agents of the scene.
    fn moment_us(&self, frame: u32) -> u64 {
        let time_s = self.poses.get(frame as usize).map_or(0.0, |pose| pose.time_s);
        EPOCH_US + u64::from(self.scene.number()) * SCENE_US + (time_s * 1e6).round() as u64
    }

    /// The same for this agent: devkits sort scenes by their time and fail where two begin at the same.
    fn time_us(&self, frame: u32) -> u64 {
        let name = self.agent.to_string();
        let place = self.scene.info().agents.iter().position(|own| own.agent == name);
        self.moment_us(frame) + place.unwrap_or_default() as u64
    }

    fn fault(&self, frame: Option<u32>, problem: String) -> ExportError {
        let agent = Some(self.agent.to_string());
        ExportError::Content { scene: self.scene.number(), frame, agent, problem }
    }

    /// Opens a channel and writes its calibration down.
    fn open(&mut self, channel: Channel) -> Result<Source, ExportError> {
        let sensor = &channel.sensor;
        let readings = match channel.modality {
            Modality::Camera => Readings::Camera(self.scene.readings(self.agent, sensor)?),
            Modality::Lidar => Readings::Lidar(self.scene.readings(self.agent, sensor)?),
            Modality::Radar => Readings::Radar(self.scene.readings(self.agent, sensor)?),
        };
        let mut pose = agent_from_sensor(&channel);
        if channel.modality == Modality::Lidar {
            pose.rotation *= sensor_from_layout();
        }
        let pose = Pose::<frames::Agent, Sensor>::from_isometry(pose);
        let calibration_token = self.token(&format!("calibration {}", channel.name));
        self.rows.push(Row::CalibratedSensor(CalibratedSensor {
            token: calibration_token.clone(),
            sensor_token: channel.sensor_token(),
            translation: pose.xyz(),
            rotation: rounded(pose.wxyz(), POSE_STEPS),
            camera_intrinsic: sensor.about.intrinsics.map(|rows| rows.to_vec()).unwrap_or_default(),
        }));
        let sweeps = self.options.sweeps.contains(&channel.modality);
        let every = sensor.about.every_n_frames;
        let is_wanted = |frame: &u32| {
            schema::rate::is_due(*frame, every) && (sweeps || self.samples.binary_search(frame).is_ok())
        };
        let frames = self.scene.frames().filter(is_wanted).collect();
        let is_labelled = is_labelled(self.scene, self.agent, &channel, self.options)?;
        Ok(Source { channel, readings, calibration_token, is_labelled, frames, done: 0 })
    }

    /// Rows of the log, the scene and its samples.
    fn describe(&mut self) {
        let info = self.scene.info();
        let own = info.agents.iter().find(|a| a.agent == self.agent.to_string());
        let partners: Vec<String> =
            self.scene.agents().iter().filter(|a| **a != self.agent).map(ToString::to_string).collect();
        let partners = if partners.is_empty() { "nobody".to_owned() } else { partners.join(", ") };
        let tokens: Vec<String> = self.samples.iter().map(|frame| self.sample_token(*frame)).collect();
        self.rows.push(Row::Log(Log {
            token: self.log_token(),
            logfile: self.name.clone(),
            vehicle: own.map_or_else(|| self.agent.to_string(), |own| own.model.clone()),
            date_captured: "2017-07-14".to_owned(),
            location: info.map.clone(),
        }));
        self.rows.push(Row::Scene(Scene {
            token: self.scene_token(),
            log_token: self.log_token(),
            nbr_samples: tokens.len() as u32,
            first_sample_token: tokens.first().cloned().unwrap_or_default(),
            last_sample_token: tokens.last().cloned().unwrap_or_default(),
            name: self.name.clone(),
            description: format!(
                "{} scene on {}, as {} has it, with {partners}",
                info.split, info.map, self.agent
            ),
        }));
        for (i, frame) in self.samples.iter().enumerate() {
            let beside = |i: Option<usize>| i.and_then(|i| tokens.get(i)).cloned().unwrap_or_default();
            self.rows.push(Row::Sample(Sample {
                token: tokens[i].clone(),
                timestamp: self.time_us(*frame),
                prev: beside(i.checked_sub(1)),
                next: beside(Some(i + 1)),
                scene_token: self.scene_token(),
            }));
        }
    }

    /// All frames, one after the other.
    fn frames(&mut self, sources: &mut [Source]) -> Result<Annotations, ExportError> {
        let mut annotations = Annotations::new(&self.words);
        let sight = Sight::read(self.scene, self.agent)?;
        let mut boxes = self.scene.boxes(self.agent)?;
        for frame in self.scene.frames() {
            let mut any = false;
            for source in sources.iter_mut() {
                if source.frames.get(source.done) == Some(&frame) {
                    self.reading(source, frame)?;
                    source.done += 1;
                    any = true;
                }
            }
            if any {
                self.pose(frame);
            }
            if self.samples.binary_search(&frame).is_ok() {
                let sample = self.sample_token(frame);
                for found in boxes.at(frame)? {
                    if is_annotated(&found, &self.poses[frame as usize], self.options) {
                        let added = annotations.add((frame, &sample), &found, (&self.objects, &sight));
                        added.map_err(|problem| self.fault(Some(frame), problem))?;
                    }
                }
                self.files.advance(1)?;
            }
        }
        Ok(annotations)
    }

    fn pose(&mut self, frame: u32) {
        let pose = &self.poses[frame as usize];
        let row = EgoPose {
            token: self.pose_token(frame),
            timestamp: self.time_us(frame),
            rotation: rounded(pose.quaternion, POSE_STEPS),
            translation: pose.xyz_m,
        };
        self.rows.push(Row::EgoPose(row));
    }

    /// Writes the file of a reading, and its row.
    fn reading(&mut self, source: &mut Source, frame: u32) -> Result<(), ExportError> {
        let Channel { name, modality, sensor } = &source.channel;
        let is_key_frame = self.samples.binary_search(&frame).is_ok();
        let folder = if is_key_frame { "samples" } else { "sweeps" };
        let time_us = self.time_us(frame);
        let filename = format!("{folder}/{name}/{}__{name}__{time_us}.{}", self.name, modality.extension());
        let bytes = match &mut source.readings {
            Readings::Camera(rows) => rows.at(frame)?.map(|row| row.image.0),
            Readings::Lidar(rows) => match rows.at(frame)? {
                None => None,
                Some(sweep) => {
                    if is_key_frame && source.is_labelled {
                        self.labels(&sweep, frame)?;
                    }
                    Some(lidar_file(&sweep))
                }
            },
            Readings::Radar(rows) => rows.at(frame)?.map(|returns| {
                let pose = &self.poses[frame as usize];
                let world = Pose::<frames::World, frames::Agent>::from_xyz_wxyz(pose.xyz_m, pose.quaternion);
                let mount = agent_from_sensor(&source.channel);
                let (velocity, turn) = (pose.velocity_mps, pose.angular_velocity_radps);
                radar_file(&returns, &radar_velocity(world.isometry(), &mount, velocity, turn))
            }),
        };
        let bytes =
            bytes.ok_or_else(|| self.fault(Some(frame), format!("{} has no reading", sensor.name)))?;
        self.files.put(&filename, &bytes)?;
        let beside = |at: Option<usize>| {
            let frame = at.and_then(|at| source.frames.get(at));
            frame.map(|frame| self.data_token(name, *frame)).unwrap_or_default()
        };
        // A reading between samples belongs to the next one; behind the last one to that.
        let sample = self.samples.partition_point(|sample| *sample < frame).min(self.samples.len() - 1);
        let row = SampleData {
            token: self.data_token(name, frame),
            sample_token: self.sample_token(self.samples[sample]),
            ego_pose_token: self.pose_token(frame),
            calibrated_sensor_token: source.calibration_token.clone(),
            timestamp: time_us,
            fileformat: modality.file_format().to_owned(),
            is_key_frame,
            height: sensor.about.height.unwrap_or_default(),
            width: sensor.about.width.unwrap_or_default(),
            filename,
            prev: beside(source.done.checked_sub(1)),
            next: beside(Some(source.done + 1)),
        };
        self.rows.push(Row::SampleData(row));
        Ok(())
    }

    /// Labels of a sweep: a category for each point.
    fn labels(&mut self, sweep: &Sweep, frame: u32) -> Result<(), ExportError> {
        let labels: Vec<u8> =
            sweep.id.iter().zip(&sweep.tag).map(|(id, tag)| self.objects.label(*id, *tag)).collect();
        let data = self.data_token("LIDAR_TOP", frame);
        let filename = format!("lidarseg/{}/{data}_lidarseg.bin", self.version);
        self.files.put(&filename, &labels)?;
        self.rows.push(Row::LidarSeg(LidarSeg { token: data.clone(), sample_data_token: data, filename }));
        Ok(())
    }

    /// Writes all rows into a file for the end, which reads them one by one.
    fn put_rows(&mut self) -> Result<String, ExportError> {
        let name = format!(".convoy-export/nuscenes/rows/{}.jsonl.zst", self.name);
        let rows = std::mem::take(&mut self.rows);
        let packed = super::parts::pack(&rows).map_err(|source| ExportError::Write {
            path: name.clone().into(),
            action: "compress",
            source,
        })?;
        self.files.put(&name, &packed)?;
        Ok(name)
    }
}

fn agent_from_sensor(channel: &Channel) -> Isometry3<f64> {
    *channel.sensor.about.agent_from_sensor.agent_from_sensor::<Sensor>().isometry()
}

/// The ground that an agent of a scene takes up: its ways with what a map around it shows, and its boxes.
pub(crate) fn ground(fragment: &Fragment) -> [f64; 4] {
    let [x0, y0, x1, y1] = fragment.way;
    let way = super::mask::widened([x0, y0, x1, y1], super::mask::WAY_MARGIN_M);
    fragment.boxes.map_or(way, |boxes| merge(way, super::mask::widened(boxes, super::mask::BOX_MARGIN_M)))
}
