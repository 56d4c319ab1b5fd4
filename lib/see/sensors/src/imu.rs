//! Inertial measurement units.

use frames::math;
use nalgebra::Vector3;
use random::Stream;
use schema::FRAME_PERIOD_S;
use schema::tables::{IMU_TABLE, ImuRow};
use settings::ImuSpec;

use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::motion::Motion;
use crate::noise::normals;
use crate::observation::Observation;
use crate::sensor::{Layout, Sensor, SensorContext, SensorTable};

/// Standard acceleration of free fall as the sensor knows it, m/s2.
const GRAVITY_MPS2: f64 = 9.81;

/// One reading, with noise and bias, in the sensor's frame (FLU, right-handed).
///
/// The acceleration is the change of the sensor's velocity over the last frame period; what is measured is
/// the specific force, which at rest is 9.81 m/s2 upwards. Without a `previous` motion (the first frame of a
/// log that does not reach back) the velocity is taken to be steady. The compass is the heading of the
/// agent's x axis, clockwise from north (+y), and has no noise.
#[must_use]
pub fn imu(
    spec: &ImuSpec,
    current: &Motion,
    previous: Option<&Motion>,
    stream: &random::Stream,
    frame: u32,
) -> ImuRow {
    let agent_from_sensor = spec.mount.agent_from_sensor();
    let lever_m = agent_from_sensor.translation();
    let sensor_from_world = (current.world_from_agent * agent_from_sensor).inverse();
    let acceleration = previous.map_or_else(Vector3::zeros, |previous| {
        (current.velocity_at(lever_m) - previous.velocity_at(lever_m)) / FRAME_PERIOD_S
    });
    let force = sensor_from_world.rotate(acceleration + Vector3::new(0.0, 0.0, GRAVITY_MPS2));
    let rate = sensor_from_world.rotate(current.angular_velocity_radps);
    let [a0, a1, a2, g0] = normals(stream, 2 * u64::from(frame));
    let [g1, g2, ..] = normals(stream, 2 * u64::from(frame) + 1);
    let noisy_rate = |value: f64, noise: f64| value + spec.gyro_bias_radps + spec.noise_gyro_radps * noise;
    let ahead = current.world_from_agent.forward();
    let heading = math::atan2(ahead.x, ahead.y);
    ImuRow {
        frame,
        time_s: crate::frame_time_s(frame),
        acceleration_mps2: [
            force.x + spec.noise_accel_mps2 * a0,
            force.y + spec.noise_accel_mps2 * a1,
            force.z + spec.noise_accel_mps2 * a2,
        ],
        gyroscope_radps: [noisy_rate(rate.x, g0), noisy_rate(rate.y, g1), noisy_rate(rate.z, g2)],
        compass_rad: if heading < 0.0 { heading + std::f64::consts::TAU } else { heading },
    }
}

/// The IMU of an agent.
pub(crate) struct Imu {
    spec: ImuSpec,
    stream: Stream,
}

impl Imu {
    pub(crate) fn new(spec: &ImuSpec, carrier: &SensorContext) -> Self {
        Self { spec: spec.clone(), stream: carrier.stream(IMU_TABLE) }
    }
}

impl Sensor for Imu {
    type Row = ImuRow;

    fn table(&self) -> SensorTable {
        let every = self.spec.every_n_frames;
        let about = sensor_metadata(IMU_TABLE, &self.spec.mount, every);
        SensorTable::new(IMU_TABLE, Some(about), Layout::Whole, every)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<ImuRow>, SensorError> {
        let agent = &at.agent;
        Ok(vec![imu(&self.spec, &agent.motion, agent.previous.as_ref(), &self.stream, at.frame)])
    }
}
