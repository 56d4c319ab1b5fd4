//! Sensor rigs. Poses are free per sensor; the defaults are the published ones.

use frames::{Agent, Pose, Sensor, deg};
use serde::Serialize;

/// Where a sensor sits on its agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mount {
    /// Position in the agent's frame (FLU), metres.
    pub xyz_m: [f64; 3],
    /// Roll, pitch (positive nose down), yaw (positive left), radians.
    pub rpy_rad: [f64; 3],
}

impl Mount {
    /// Upright at a position, turned to the left by an angle in degrees.
    #[must_use]
    pub fn upright(xyz_m: [f64; 3], yaw_deg: f64) -> Self {
        Self { xyz_m, rpy_rad: [0.0, 0.0, deg(yaw_deg)] }
    }

    /// The mount as a transform.
    #[must_use]
    pub fn agent_from_sensor(&self) -> Pose<Agent, Sensor> {
        Pose::from_xyz_rpy(self.xyz_m, self.rpy_rad)
    }
}

/// What all cameras of a rig share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSettings {
    /// Image width, pixels (1600).
    pub width: u32,
    /// Image height, pixels (900).
    pub height: u32,
    /// Horizontal field of view, radians (80 degrees).
    pub horizontal_fov_rad: f64,
    /// Aperture of the RGB images (1.8).
    pub f_stop: f64,
    /// JPEG quality of the RGB images, 1 to 100 (80).
    pub jpeg_quality: u8,
    /// Write RGB images.
    pub rgb: bool,
    /// Write semantic images.
    pub semantic: bool,
    /// Write instance images.
    pub instance: bool,
    /// Write depth images.
    pub depth: bool,
    /// Write optical flow.
    pub flow: bool,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            width: 1600,
            height: 900,
            horizontal_fov_rad: deg(80.0),
            f_stop: 1.8,
            jpeg_quality: 80,
            rgb: true,
            semantic: false,
            instance: true,
            depth: false,
            flow: false,
        }
    }
}

impl CameraSettings {
    /// Focal length in pixels: `width / (2 tan(fov / 2))`; pixels are square, the principal point is the centre.
    #[must_use]
    pub fn focal_px(&self) -> f64 {
        f64::from(self.width) / (2.0 * frames::math::tan(0.5 * self.horizontal_fov_rad))
    }

    /// Whether any image is wanted.
    #[must_use]
    pub fn any(&self) -> bool {
        self.rgb || self.semantic || self.instance || self.depth || self.flow
    }
}

/// One camera position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSpec {
    /// `CAM_FRONT` and so on.
    pub name: String,
    /// Where it sits (FLU; it looks along the mount's x axis).
    pub mount: Mount,
}

/// The rays of a lidar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScanPattern {
    /// Beams, the highest first (128).
    pub channels: u32,
    /// Azimuth steps per beam and frame (2048 vehicle, 1024 RSU).
    pub columns: u32,
    /// Highest beam, radians above the horizon.
    pub upper_rad: f64,
    /// Lowest beam, radians.
    pub lower_rad: f64,
    /// Horizontal field of view, radians, centred ahead.
    pub horizontal_fov_rad: f64,
}

impl ScanPattern {
    /// Most rays of a sweep: a fixed bound on memory, 16 times the densest published lidar.
    pub const MAX_RAYS: u64 = 1 << 22;
    /// Most beams: rings are numbered in 16 bits.
    pub const MAX_CHANNELS: u32 = 65_535;

    /// Rays of a sweep.
    #[must_use]
    pub fn rays(&self) -> u64 {
        u64::from(self.channels) * u64::from(self.columns)
    }

    /// Why no lidar can have this pattern, if none can.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let Self { channels, columns, .. } = self;
        (self.rays() > Self::MAX_RAYS || *channels > Self::MAX_CHANNELS).then(|| {
            format!(
                "{channels} channels x {columns} columns are {} rays a frame, at most {} are possible",
                self.rays(),
                Self::MAX_RAYS
            )
        })
    }
}

/// A lidar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LidarSpec {
    /// `LIDAR` or `SEG-LIDAR`.
    pub name: String,
    /// Where it sits.
    pub mount: Mount,
    /// Its rays.
    pub scan: ScanPattern,
    /// Reach, metres (120).
    pub range_m: f64,
    /// Share of rays that return nothing at random (0.14; semantic 0).
    pub dropoff_rate: f64,
    /// Returns with an intensity above this are never dropped for weakness (0.8).
    pub dropoff_intensity_limit: f64,
    /// Chance that a return of intensity 0 is dropped (0.4; semantic 0).
    pub dropoff_zero_intensity: f64,
    /// Attenuation per metre (0.004): intensity is `exp(-attenuation * distance)` times the surface's reflectance
    /// in the dataset's `intensity` column; the drop rule uses the bare exponential.
    pub attenuation_per_m: f64,
    /// Standard deviation of the distance, metres (0.03; semantic 0).
    pub noise_m: f64,
    /// A semantic lidar: no drops, no noise, and the incidence cosine is written.
    pub semantic: bool,
}

/// A radar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RadarSpec {
    /// `RAD_FRONT` and so on.
    pub name: String,
    /// Where it sits.
    pub mount: Mount,
    /// Reach, metres (120).
    pub range_m: f64,
    /// Width of the cone, radians (100 degrees; RSU 120).
    pub horizontal_fov_rad: f64,
    /// Height of the cone, radians (20 degrees).
    pub vertical_fov_rad: f64,
    /// Rays per frame (2000; RSU 2400).
    pub rays: u32,
}

/// A GNSS receiver.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GnssSpec {
    /// Where its antenna sits.
    pub mount: Mount,
    /// Standard deviation of latitude and longitude, degrees (4e-7).
    pub noise_deg: [f64; 2],
    /// Standard deviation of the altitude, metres (0.04).
    pub noise_altitude_m: f64,
}

/// An inertial measurement unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImuSpec {
    /// Where it sits.
    pub mount: Mount,
    /// Standard deviation of each acceleration, m/s2 (1.7e-4).
    pub noise_accel_mps2: f64,
    /// Constant bias of each rate, rad/s (1.7e-4).
    pub gyro_bias_radps: f64,
    /// Standard deviation of each rate, rad/s (5.6e-6).
    pub noise_gyro_radps: f64,
}

/// All sensors of one kind of agent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rig {
    /// What the cameras share.
    pub camera: CameraSettings,
    /// Camera positions.
    pub cameras: Vec<CameraSpec>,
    /// Lidars, semantic ones among them.
    pub lidars: Vec<LidarSpec>,
    /// Radars.
    pub radars: Vec<RadarSpec>,
    /// GNSS, if any.
    pub gnss: Option<GnssSpec>,
    /// IMU, if any.
    pub imu: Option<ImuSpec>,
}

impl Rig {
    /// The published vehicle rig: six cameras, a lidar, four radars, GNSS and IMU.
    #[must_use]
    pub fn vehicle() -> Self {
        let camera = |name: &str, xyz, yaw| CameraSpec { name: name.into(), mount: Mount::upright(xyz, yaw) };
        let radar = |name: &str, xyz, yaw| RadarSpec {
            name: name.into(),
            mount: Mount::upright(xyz, yaw),
            range_m: 120.0,
            horizontal_fov_rad: deg(100.0),
            vertical_fov_rad: deg(20.0),
            rays: 2000,
        };
        Self {
            camera: CameraSettings::default(),
            cameras: vec![
                camera("CAM_FRONT_LEFT", [0.4, 0.4, 1.6], 55.0),
                camera("CAM_FRONT", [0.6, 0.0, 1.6], 0.0),
                camera("CAM_FRONT_RIGHT", [0.4, -0.4, 1.6], -55.0),
                camera("CAM_BACK_LEFT", [0.0, 0.4, 1.6], 110.0),
                camera("CAM_BACK", [-1.0, 0.0, 1.6], 180.0),
                camera("CAM_BACK_RIGHT", [0.0, -0.4, 1.6], -110.0),
            ],
            lidars: vec![LidarSpec::vehicle()],
            radars: vec![
                radar("RAD_LEFT", [0.0, 1.0, 0.6], 90.0),
                radar("RAD_FRONT", [2.4, 0.0, 0.6], 0.0),
                radar("RAD_RIGHT", [0.0, -1.0, 0.6], -90.0),
                radar("RAD_BACK", [-2.4, 0.0, 0.6], 180.0),
            ],
            gnss: Some(GnssSpec::default()),
            imu: Some(ImuSpec::default()),
        }
    }

    /// The published RSU rig: three cameras, a lidar and a radar.
    #[must_use]
    pub fn rsu() -> Self {
        let camera =
            |name: &str, yaw| CameraSpec { name: name.into(), mount: Mount::upright([0.0, 0.0, 1.6], yaw) };
        Self {
            camera: CameraSettings::default(),
            cameras: vec![
                camera("CAM_FRONT_LEFT", 55.0),
                camera("CAM_FRONT", 0.0),
                camera("CAM_FRONT_RIGHT", -55.0),
            ],
            lidars: vec![LidarSpec::rsu()],
            radars: vec![RadarSpec {
                name: "RAD_FRONT".into(),
                mount: Mount::upright([0.0, 0.0, 1.2], 0.0),
                range_m: 120.0,
                horizontal_fov_rad: deg(120.0),
                vertical_fov_rad: deg(20.0),
                rays: 2400,
            }],
            gnss: None,
            imu: None,
        }
    }
}

impl LidarSpec {
    /// The published vehicle lidar.
    #[must_use]
    pub fn vehicle() -> Self {
        Self {
            name: "LIDAR".into(),
            mount: Mount::upright([0.0, 0.0, 1.8], 0.0),
            scan: ScanPattern {
                channels: 128,
                columns: 2048,
                upper_rad: deg(10.67),
                lower_rad: deg(-30.67),
                horizontal_fov_rad: deg(360.0),
            },
            range_m: 120.0,
            dropoff_rate: 0.14,
            dropoff_intensity_limit: 0.8,
            dropoff_zero_intensity: 0.4,
            attenuation_per_m: 0.004,
            noise_m: 0.03,
            semantic: false,
        }
    }

    /// The published RSU lidar.
    #[must_use]
    pub fn rsu() -> Self {
        Self {
            mount: Mount::upright([0.0, 0.0, 3.2], 0.0),
            scan: ScanPattern {
                channels: 128,
                columns: 1024,
                upper_rad: 0.0,
                lower_rad: deg(-45.0),
                horizontal_fov_rad: deg(180.0),
            },
            ..Self::vehicle()
        }
    }

    /// The semantic lidar that goes with this one: the same rays, every return kept, nothing added.
    #[must_use]
    pub fn semantic(&self) -> Self {
        Self {
            name: format!("SEG-{}", self.name),
            dropoff_rate: 0.0,
            dropoff_zero_intensity: 0.0,
            noise_m: 0.0,
            semantic: true,
            ..self.clone()
        }
    }
}

impl Default for GnssSpec {
    fn default() -> Self {
        Self { mount: Mount::upright([0.0; 3], 0.0), noise_deg: [4e-7, 4e-7], noise_altitude_m: 0.04 }
    }
}

impl Default for ImuSpec {
    fn default() -> Self {
        Self {
            mount: Mount::upright([0.0; 3], 0.0),
            noise_accel_mps2: 1.7e-4,
            gyro_bias_radps: 1.7e-4,
            noise_gyro_radps: 5.6e-6,
        }
    }
}
