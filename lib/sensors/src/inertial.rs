//! GNSS receivers and inertial measurement units.

use frames::math;
use frames::{Agent, Pose, World};
use nalgebra::Vector3;
use schema::FRAME_PERIOD_S;
use schema::settings::{GnssSpec, ImuSpec};
use schema::tables::{AgentRow, GnssRow, ImuRow};

/// Radius of the sphere of the Mercator projection, metres.
const EARTH_RADIUS_M: f64 = 6_378_137.0;
/// Standard acceleration of free fall as the sensor knows it, m/s2.
const GRAVITY_MPS2: f64 = 9.81;

/// Where a map's origin is on the globe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GeoOrigin {
    /// Latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Altitude, metres.
    pub altitude_m: f64,
}

impl GeoOrigin {
    /// Latitude and longitude in degrees and altitude in metres of a world point.
    ///
    /// Spherical Mercator scaled by the cosine of the origin's latitude, so that a metre of the map is a metre
    /// at the origin: east is the world's x, north its y.
    #[must_use]
    pub fn geodetic_from_world(&self, world_xyz_m: [f64; 3]) -> [f64; 3] {
        let scaled_radius_m = EARTH_RADIUS_M * math::cos(frames::deg(self.latitude_deg));
        let north_rad = mercator_north(frames::deg(self.latitude_deg)) + world_xyz_m[1] / scaled_radius_m;
        let latitude = 2.0 * math::atan(math::exp(north_rad)) - std::f64::consts::FRAC_PI_2;
        [
            frames::to_deg(latitude),
            self.longitude_deg + frames::to_deg(world_xyz_m[0] / scaled_radius_m),
            self.altitude_m + world_xyz_m[2],
        ]
    }

    /// The inverse of [`GeoOrigin::geodetic_from_world`].
    #[must_use]
    pub fn world_from_geodetic(&self, geodetic: [f64; 3]) -> [f64; 3] {
        let scaled_radius_m = EARTH_RADIUS_M * math::cos(frames::deg(self.latitude_deg));
        let north_rad =
            mercator_north(frames::deg(geodetic[0])) - mercator_north(frames::deg(self.latitude_deg));
        [
            frames::deg(geodetic[1] - self.longitude_deg) * scaled_radius_m,
            north_rad * scaled_radius_m,
            geodetic[2] - self.altitude_m,
        ]
    }
}

/// Northing of a latitude on the unit sphere's Mercator map.
fn mercator_north(latitude_rad: f64) -> f64 {
    math::ln(math::tan(0.5 * latitude_rad + std::f64::consts::FRAC_PI_4))
}

/// How an agent moves at one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where it is.
    pub world_from_agent: Pose<World, Agent>,
    /// Velocity in the world, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Angular velocity in the world, rad/s.
    pub angular_velocity_radps: Vector3<f64>,
}

impl Motion {
    /// The motion that a table row tells.
    #[must_use]
    pub fn from_row(row: &AgentRow) -> Self {
        Self {
            world_from_agent: Pose::from_xyz_wxyz(row.xyz_m, row.quaternion),
            velocity_mps: row.velocity_mps.into(),
            angular_velocity_radps: row.angular_velocity_radps.into(),
        }
    }

    /// Velocity of a point of the body, m/s, world.
    fn velocity_at(&self, agent_point_m: Vector3<f64>) -> Vector3<f64> {
        self.velocity_mps + self.angular_velocity_radps.cross(&self.world_from_agent.rotate(agent_point_m))
    }
}

/// One fix, with noise: frame `f` reads the random words at `f`.
#[must_use]
pub fn gnss(
    spec: &GnssSpec,
    origin: &GeoOrigin,
    world_from_agent: &Pose<World, Agent>,
    stream: &random::Stream,
    frame: u32,
) -> GnssRow {
    let antenna = *world_from_agent * spec.mount.agent_from_sensor();
    let [latitude, longitude, altitude] = origin.geodetic_from_world(antenna.xyz());
    let [n0, n1, n2, _] = normals(stream, u64::from(frame));
    GnssRow {
        frame,
        time_s: crate::frame_time_s(frame),
        latitude_deg: latitude + spec.noise_deg[0] * n0,
        longitude_deg: longitude + spec.noise_deg[1] * n1,
        altitude_m: altitude + spec.noise_altitude_m * n2,
    }
}

/// One reading, with noise and bias, in the sensor's frame (FLU, right-handed).
///
/// The acceleration is the change of the sensor's velocity over the last frame period; what is measured is the
/// specific force, which at rest is 9.81 m/s2 upwards. Without a `previous` motion (the first frame of a log that
/// does not reach back) the velocity is taken to be steady. The compass is the heading of the agent's x axis,
/// clockwise from north (+y), and has no noise.
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

/// Four standard normal numbers of one index.
fn normals(stream: &random::Stream, index: u64) -> [f64; 4] {
    let [a, b, c, d] = stream.at(index);
    let (n0, n1) = random::normal_pair_f32(a, b);
    let (n2, n3) = random::normal_pair_f32(c, d);
    [n0, n1, n2, n3].map(f64::from)
}
