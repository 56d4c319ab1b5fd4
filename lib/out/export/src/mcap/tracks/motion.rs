//! Where agents and their sensors are, how agents move, what their inertial sensors and receivers say, and
//! the weather.

use std::collections::BTreeMap;

use frames::{Agent, Pose as TypedPose, World};
use scene::{SensorEntry, SensorFrames, SensorKind};
use schema::AgentId;
use schema::calibration::Calibration;
use schema::tables::{AgentRow, FrameRow, GnssRow, ImuRow};

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::messages::{
    AgentState, CovarianceType, FrameTransform, FrameTransforms, Imu, LocationFix, Pose, Quaternion,
    Timestamp, Weather,
};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// Poses and velocities of the agents, and the weather.
pub(crate) struct MotionTrack {
    /// By agent, by frame.
    agents: Vec<(Topic<AgentState>, Vec<AgentRow>)>,
    moving: Topic<FrameTransforms>,
    /// What never moves, until it is written with the first frame.
    mounted: Option<(Topic<FrameTransforms>, FrameTransforms)>,
    weather: Vec<FrameRow>,
    weather_topic: Topic<Weather>,
}

impl MotionTrack {
    /// Of a scene, with the sensors of its agents.
    pub(crate) fn open(
        scene: &SceneSource,
        sensors: &[(AgentId, Vec<SensorEntry>)],
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let moving = topics.add("/tf".into(), &[])?;
        let fixed = topics.add("/tf_static".into(), &[])?;
        let weather_topic = topics.add("/weather".into(), &[])?;
        let mut agents = Vec::new();
        for (agent, rows) in scene.agents().iter().zip(scene.agent_rows()?) {
            agents.push((topics.add(format!("/{agent}/state"), &[])?, rows));
        }
        let mut mounted = BTreeMap::new();
        for (agent, entries) in sensors {
            for entry in entries {
                mounted.entry((*agent, entry.about.name.clone())).or_insert_with(|| &entry.about);
            }
        }
        let transforms = mounted.into_iter().map(|((agent, name), about)| mounting(agent, &name, about));
        let mounted = Some((fixed, FrameTransforms { transforms: transforms.collect() }));
        Ok(Self { agents, moving, mounted, weather: scene.reader().rows()?, weather_topic })
    }
}

impl Track for MotionTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        let timestamp = Timestamp::at(frame);
        let mut transforms = Vec::new();
        for (topic, rows) in &self.agents {
            let Some(row) = rows.get(frame as usize) else { continue };
            let world_from_agent: TypedPose<World, Agent> =
                TypedPose::from_xyz_wxyz(row.xyz_m, row.quaternion);
            let pose = Pose::of(&world_from_agent);
            transforms.push(FrameTransform {
                timestamp: timestamp.clone(),
                parent_frame_id: "world".into(),
                child_frame_id: row.agent.clone(),
                translation: pose.position.clone(),
                rotation: pose.orientation.clone(),
            });
            let state = AgentState {
                timestamp: timestamp.clone(),
                frame_id: "world".into(),
                object_id: u32::from(row.id),
                pose,
                velocity_mps: row.velocity_mps.into(),
                angular_velocity_radps: row.angular_velocity_radps.into(),
            };
            topic.send(frame, &state, out);
        }
        self.moving.send(frame, &FrameTransforms { transforms }, out);
        if let Some((topic, mut mounted)) = self.mounted.take() {
            mounted.transforms.iter_mut().for_each(|t| t.timestamp = timestamp.clone());
            topic.send(frame, &mounted, out);
        }
        if let Some(row) = self.weather.get(frame as usize) {
            self.weather_topic.send(frame, &weather_of(row), out);
        }
        Ok(())
    }
}

/// Where a sensor is on its agent.
fn mounting(agent: AgentId, name: &str, about: &Calibration) -> FrameTransform {
    let mount = &about.agent_from_sensor;
    FrameTransform {
        timestamp: Timestamp::default(),
        parent_frame_id: agent.to_string(),
        child_frame_id: format!("{agent}/{name}"),
        translation: mount.translation.into(),
        rotation: Quaternion::from_wxyz(mount.quaternion),
    }
}

fn weather_of(row: &FrameRow) -> Weather {
    Weather {
        timestamp: Timestamp::at(row.frame),
        cloudiness: row.cloudiness,
        precipitation: row.precipitation,
        precipitation_deposits: row.precipitation_deposits,
        wind_intensity: row.wind_intensity,
        sun_azimuth_deg: row.sun_azimuth_deg,
        sun_altitude_deg: row.sun_altitude_deg,
        wetness: row.wetness,
        fog_density: row.fog_density,
        fog_distance_m: row.fog_distance_m,
        fog_falloff: row.fog_falloff,
        scattering_intensity: row.scattering_intensity,
        mie_scattering_scale: row.mie_scattering_scale,
        rayleigh_scattering_scale: row.rayleigh_scattering_scale,
        dust_storm: row.dust_storm,
    }
}

/// What an agent's receiver or IMU says.
pub(crate) enum ReadingTrack {
    /// A satellite receiver.
    Gnss(Topic<LocationFix>, SensorFrames<GnssRow>, String),
    /// An IMU.
    Imu(Topic<Imu>, SensorFrames<ImuRow>, String),
}

impl ReadingTrack {
    /// Of a sensor; none of other kinds.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        sensor: &SensorEntry,
        topics: &mut Topics,
    ) -> Result<Option<Self>, ExportError> {
        let name = format!("/{agent}/{}", sensor.name);
        let frame_id = format!("{agent}/{}", sensor.about.name);
        let facts = [("every_n_frames", sensor.about.every_n_frames.to_string())];
        Ok(match sensor.kind {
            SensorKind::Gnss => {
                Some(Self::Gnss(topics.add(name, &facts)?, scene.readings(agent, sensor)?, frame_id))
            }
            SensorKind::Imu => {
                Some(Self::Imu(topics.add(name, &facts)?, scene.readings(agent, sensor)?, frame_id))
            }
            SensorKind::Image(_) | SensorKind::Lidar | SensorKind::SemanticLidar | SensorKind::Radar => None,
        })
    }
}

impl Track for ReadingTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        match self {
            Self::Gnss(topic, readings, frame_id) => {
                let Some(row) = readings.at(frame)? else { return Ok(()) };
                let fix = LocationFix {
                    latitude: row.latitude_deg,
                    longitude: row.longitude_deg,
                    altitude: row.altitude_m,
                    position_covariance: vec![0.0; 9],
                    position_covariance_type: CovarianceType::Unknown,
                    timestamp: Timestamp::at(frame),
                    frame_id: frame_id.clone(),
                };
                topic.send(frame, &fix, out);
            }
            Self::Imu(topic, readings, frame_id) => {
                let Some(row) = readings.at(frame)? else { return Ok(()) };
                let reading = Imu {
                    timestamp: Timestamp::at(frame),
                    frame_id: frame_id.clone(),
                    acceleration_mps2: row.acceleration_mps2.into(),
                    gyroscope_radps: row.gyroscope_radps.into(),
                    compass_rad: row.compass_rad,
                };
                topic.send(frame, &reading, out);
            }
        }
        Ok(())
    }
}
