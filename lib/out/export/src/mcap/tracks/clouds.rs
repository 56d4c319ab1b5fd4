//! Lidars and radars as point clouds in the sensor's frame.

use frames::math;
use scene::{SensorEntry, SensorFrames};
use schema::AgentId;
use schema::table::Row;
use schema::tables::{LidarReturnsRow, LidarRow, RadarRow};
use store::keys;

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::messages::{PointCloud, Pose, Quaternion, Timestamp};
use crate::mcap::packed::{Packed, Values, pack};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

schema::columns! {
    /// What of a sweep becomes points.
    Sweep of LidarRow {
        frame: u32,
        x: Vec<f32>,
        y: Vec<f32>,
        z: Vec<f32>,
        intensity: Vec<f32>,
        ring: Vec<u16>,
        time_offset_s: Vec<f32>,
        id: Vec<u16>,
        tag: Vec<u8>,
    }
}
schema::columns! {
    /// What more there is where beams have several returns.
    SweepReturns of LidarReturnsRow {
        frame: u32,
        return_number: Vec<u8>,
        return_count: Vec<u8>,
        return_kind: Vec<u8>,
    }
}
schema::framed!(Sweep, SweepReturns);

/// Where a sensor's points go.
struct Cloud {
    topic: Topic<PointCloud>,
    frame_id: String,
    scene: u32,
    agent: AgentId,
}

impl Cloud {
    fn new(
        scene: &SceneSource,
        agent: AgentId,
        sensor: &SensorEntry,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let facts = [("every_n_frames", sensor.about.every_n_frames.to_string())];
        let topic = topics.add(format!("/{agent}/{}", sensor.name), &facts)?;
        let frame_id = format!("{agent}/{}", sensor.about.name);
        Ok(Self { topic, frame_id, scene: scene.number(), agent })
    }

    fn send(
        &self,
        frame: u32,
        columns: &[(&str, Values<'_>)],
        out: &mut Messages,
    ) -> Result<(), ExportError> {
        let Some(Packed { fields, stride, data }) = pack(columns) else {
            let problem = format!(
                "{}: lists of a frame are not of one length (run render-sensors again with --force)",
                self.frame_id
            );
            let agent = Some(self.agent.to_string());
            return Err(ExportError::Content { scene: self.scene, frame: Some(frame), agent, problem });
        };
        let cloud = PointCloud {
            timestamp: Timestamp::at(frame),
            frame_id: self.frame_id.clone(),
            pose: Pose { orientation: Quaternion::from_wxyz([1.0, 0.0, 0.0, 0.0]), ..Pose::default() },
            point_stride: stride,
            fields,
            data,
        };
        self.topic.send(frame, &cloud, out);
        Ok(())
    }
}

/// A lidar.
pub(crate) struct LidarTrack {
    cloud: Cloud,
    sweeps: SensorFrames<Sweep>,
    returns: Option<SensorFrames<SweepReturns>>,
}

impl LidarTrack {
    /// Of an agent's lidar, with labels or without.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        sensor: &SensorEntry,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let reader = scene.reader();
        let key = keys::sensor(scene.number(), agent, &sensor.name);
        let columns = reader.store().table_columns(reader.manifest(LidarRow::STAGE)?, &key)?;
        let has_returns = columns.iter().any(|column| column == "return_number");
        let returns = if has_returns { Some(scene.readings(agent, sensor)?) } else { None };
        let cloud = Cloud::new(scene, agent, sensor, topics)?;
        Ok(Self { cloud, sweeps: scene.readings(agent, sensor)?, returns })
    }
}

impl Track for LidarTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        let Some(sweep) = self.sweeps.at(frame)? else { return Ok(()) };
        let returns = self.returns.as_mut().map(|returns| returns.at(frame)).transpose()?.flatten();
        let mut columns = vec![
            ("x", Values::F32(&sweep.x)),
            ("y", Values::F32(&sweep.y)),
            ("z", Values::F32(&sweep.z)),
            ("intensity", Values::F32(&sweep.intensity)),
            ("time_offset_s", Values::F32(&sweep.time_offset_s)),
            ("ring", Values::U16(&sweep.ring)),
            ("id", Values::U16(&sweep.id)),
            ("tag", Values::U8(&sweep.tag)),
        ];
        if let Some(returns) = &returns {
            columns.extend([
                ("return_number", Values::U8(&returns.return_number)),
                ("return_count", Values::U8(&returns.return_count)),
                ("return_kind", Values::U8(&returns.return_kind)),
            ]);
        }
        self.cloud.send(frame, &columns, out)
    }
}

/// A radar.
pub(crate) struct RadarTrack {
    cloud: Cloud,
    readings: SensorFrames<RadarRow>,
}

impl RadarTrack {
    /// Of an agent's radar.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        sensor: &SensorEntry,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let cloud = Cloud::new(scene, agent, sensor, topics)?;
        Ok(Self { cloud, readings: scene.readings(agent, sensor)? })
    }
}

impl Track for RadarTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        let Some(row) = self.readings.at(frame)? else { return Ok(()) };
        let places = row.depth.iter().zip(&row.altitude).zip(&row.azimuth);
        let places: Vec<[f32; 3]> =
            places.map(|((depth, altitude), azimuth)| place(*depth, *altitude, *azimuth)).collect();
        let [x, y, z] = [0, 1, 2].map(|axis| places.iter().map(|p| p[axis]).collect::<Vec<f32>>());
        let columns = [
            ("x", Values::F32(&x)),
            ("y", Values::F32(&y)),
            ("z", Values::F32(&z)),
            ("velocity", Values::F32(&row.velocity)),
            ("rcs_dbsm", Values::F32(&row.rcs_dbsm)),
            ("snr_db", Values::F32(&row.snr_db)),
            ("id", Values::U16(&row.id)),
            ("tag", Values::U8(&row.tag)),
        ];
        self.cloud.send(frame, &columns, out)
    }
}

/// Where a radar return is in the sensor's frame (x forward, y left, z up): metres and radians.
fn place(depth_m: f32, altitude_rad: f32, azimuth_rad: f32) -> [f32; 3] {
    let (sin_altitude, cos_altitude) = math::sin_cos(f64::from(altitude_rad));
    let (sin_azimuth, cos_azimuth) = math::sin_cos(f64::from(azimuth_rad));
    let depth = f64::from(depth_m);
    [depth * cos_altitude * cos_azimuth, depth * cos_altitude * sin_azimuth, depth * sin_altitude]
        .map(|value| value as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radar_returns_lie_left_and_up_of_the_axis() {
        let near = |found: [f32; 3], want: [f32; 3]| {
            assert!(found.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} {want:?}");
        };
        near(place(10.0, 0.0, 0.0), [10.0, 0.0, 0.0]);
        near(place(2.0, 0.0, std::f32::consts::FRAC_PI_2), [0.0, 2.0, 0.0]);
        near(place(4.0, std::f32::consts::FRAC_PI_6, 0.0), [4.0 * 0.75_f32.sqrt(), 0.0, 2.0]);
    }
}
