//! All sensors of an agent.

use frames::deg;
use serde::Serialize;

use super::camera::{CameraSettings, CameraSpec};
use super::inertial::{GnssSpec, ImuSpec};
use super::lidar::LidarSpec;
use super::mount::Mount;
use super::radar::RadarSpec;

/// What one reading of a sensor takes, within a factor of two: for forecasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingCost {
    /// What the readings are called, for people.
    pub output: &'static str,
    /// Bytes as stored, measured on four datasets of 240 agent-frames each (the demo town and three of CARLA's).
    pub bytes: f64,
    /// Seconds of one core, from the table of docs/performance.md.
    pub core_s: f64,
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
    /// What a frame of every sensor takes, cameras aside; receivers of a few numbers cost nothing to speak of.
    #[must_use]
    pub fn reading_costs(&self) -> Vec<ReadingCost> {
        let of_rays = |output, rays: f64, bytes_ray| ReadingCost {
            output,
            bytes: rays * bytes_ray,
            core_s: rays * 0.4e-6,
        };
        let lidars = self.lidars.iter().map(|lidar| {
            let (output, bytes_ray) =
                if lidar.semantic { ("semantic lidar sweeps", 6.0) } else { ("lidar sweeps", 7.3) };
            of_rays(output, lidar.scan.rays() as f64, bytes_ray)
        });
        let radars = self.radars.iter().map(|radar| of_rays("radar readings", f64::from(radar.rays), 14.0));
        lidars.chain(radars).collect()
    }

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
