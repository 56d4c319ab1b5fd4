//! All sensors of an agent.

use frames::deg;
use schema::tables::{BOXES_2D_TABLE, GNSS_TABLE, IMU_TABLE, VISIBLE_TABLE};
use schema::{ImageKind, ImageSet};
use serde::{Deserialize, Serialize};

use crate::camera::{CameraSettings, CameraSpec};
use crate::inertial::{GnssSpec, ImuSpec};
use crate::lidar::LidarSpec;
use crate::mount::Mount;
use crate::occupancy::OccupancySettings;
use crate::radar::RadarSpec;

/// All sensors of one kind of agent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
        let camera = |name: &str, xyz, yaw| CameraSpec {
            name: name.into(),
            mount: Mount::upright(xyz, yaw),
            ..CameraSpec::default()
        };
        let radar = |name: &str, xyz, yaw| RadarSpec {
            name: name.into(),
            mount: Mount::upright(xyz, yaw),
            ..RadarSpec::default()
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
        let camera = |name: &str, yaw| CameraSpec {
            name: name.into(),
            mount: Mount::upright([0.0, 0.0, 1.6], yaw),
            ..CameraSpec::default()
        };
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
                horizontal_fov_rad: deg(120.0),
                rays: 2400,
                ..RadarSpec::default()
            }],
            gnss: None,
            imu: None,
        }
    }
}

impl Rig {
    /// The sensors of which some table is wanted, by the tables' names; of the cameras those kinds of images
    /// that any of them has to make.
    #[must_use]
    pub fn of_tables(&self, is_wanted: impl Fn(&str) -> bool) -> Self {
        let is_told = is_wanted(VISIBLE_TABLE) || is_wanted(BOXES_2D_TABLE);
        let makes = |kind: ImageKind, camera: &CameraSpec| is_wanted(&kind.table(&camera.name));
        let mut images = ImageSet::NONE;
        for kind in self.camera.images.iter() {
            images.set(kind, self.cameras.iter().any(|camera| makes(kind, camera)));
        }
        let looks = |camera: &&CameraSpec| is_told || images.iter().any(|kind| makes(kind, camera));
        Self {
            cameras: self.cameras.iter().filter(looks).cloned().collect(),
            camera: CameraSettings { images, ..self.camera.clone() },
            lidars: self.lidars.iter().filter(|lidar| is_wanted(&lidar.name)).cloned().collect(),
            radars: self.radars.iter().filter(|radar| is_wanted(&radar.name)).cloned().collect(),
            gnss: self.gnss.clone().filter(|_| is_wanted(GNSS_TABLE)),
            imu: self.imu.clone().filter(|_| is_wanted(IMU_TABLE)),
        }
    }
}

/// Sensors and voxel grid of some agents, instead of those of their kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OwnRig {
    /// `vehicle_1`, `rsu_0`, ...; all of one kind.
    pub agents: Vec<String>,
    /// Sensors.
    pub rig: Rig,
    /// Voxel grid.
    pub occupancy: OccupancySettings,
}
