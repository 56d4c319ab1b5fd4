//! Where sensors are: the metadata of infos.

use frames::{Agent, Pose, Sensor, flu_from_optical};
use schema::AgentKind;
use schema::calibration::{Calibration, Mounting};
use settings::{Lens, Mount, OccupancySettings};

use crate::error::SourceFault;
use crate::names::{self, LIDAR, SEMANTIC_LIDAR, VOXELS};
use crate::value::Value;

/// What is said of the sensors of vehicles and of RSUs.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigs {
    vehicle: Rig,
    rsu: Rig,
}

/// What is said of the sensors of one kind of agents.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rig {
    /// Poses by place, as infos have them: `CAM_FRONT`, `LIDAR`, `RAD_BACK`.
    mounts: Vec<(&'static str, Mounting)>,
    /// The matrix of all cameras.
    pub(crate) intrinsics: [[f64; 3]; 3],
    /// Bounds of voxel grids.
    pub(crate) occupancy: OccupancySettings,
}

impl Rigs {
    /// Of the metadata.
    ///
    /// # Errors
    /// A key is missing, or holds no pose, matrix or bounds.
    pub fn of(metadata: &Value) -> Result<Self, SourceFault> {
        Ok(Self { vehicle: rig(metadata, AgentKind::Vehicle)?, rsu: rig(metadata, AgentKind::Rsu)? })
    }

    pub(crate) fn rig(&self, kind: AgentKind) -> &Rig {
        match kind {
            AgentKind::Vehicle => &self.vehicle,
            AgentKind::Rsu => &self.rsu,
        }
    }
}

fn rig(metadata: &Value, kind: AgentKind) -> Result<Rig, SourceFault> {
    let (upper, lower) = match kind {
        AgentKind::Vehicle => ("", ""),
        AgentKind::Rsu => ("RSU-", "rsu_"),
    };
    let mut mounts = Vec::new();
    for place in names::cameras(kind).iter().chain(names::radars(kind)).chain(&[LIDAR]) {
        mounts.push((*place, mounting(metadata, &format!("{upper}{place}"))?));
    }
    let key = format!("{lower}camera_intrinsics");
    let matrix = metadata.get(&key).and_then(Value::numbers::<9>);
    let matrix = matrix.filter(|m| m.iter().all(|v| v.is_finite()) && m[0] > 0.0 && m[4] > 0.0);
    let matrix = matrix.ok_or_else(|| format!("metadata: `{key}` is no matrix of a camera"))?;
    let key = format!("{lower}voxel_detector_properties");
    let number = |name: &str| {
        let found = metadata.get(&key).and_then(|all| all.get(name)).and_then(Value::number);
        found.ok_or_else(|| format!("metadata: `{key}` has no number `{name}`"))
    };
    let occupancy = OccupancySettings {
        range_m: number("range")?,
        voxel_m: number("voxel_size")?,
        upper_m: number("upper_limit")?,
        lower_m: number("lower_limit")?,
        mount_z_m: mounting(metadata, &format!("{upper}{VOXELS}"))?.translation[2],
        ..OccupancySettings::default()
    };
    if let Some(problem) = occupancy.problem() {
        return Err(format!("metadata: `{key}`: {problem}").into());
    }
    Ok(Rig {
        mounts,
        intrinsics: std::array::from_fn(|r| std::array::from_fn(|c| matrix[3 * r + c])),
        occupancy,
    })
}

fn mounting(metadata: &Value, key: &str) -> Result<Mounting, SourceFault> {
    let part = |name: &str| metadata.get(key).and_then(|pose| pose.get(name));
    let translation = part("sensor2ego_translation").and_then(Value::numbers::<3>);
    let quaternion = part("sensor2ego_rotation").and_then(Value::numbers::<4>);
    let (Some(translation), Some(quaternion)) = (translation, quaternion) else {
        return Err(format!("metadata: `{key}` has no pose of a sensor").into());
    };
    let norm2: f64 = quaternion.iter().map(|v| v * v).sum();
    let is_one = translation.iter().all(|v| v.is_finite()) && (norm2 - 1.0).abs() < 1e-3;
    if !is_one {
        return Err(format!("metadata: `{key}` has no pose of a sensor").into());
    }
    // The original has seven digits of them.
    let is_exact = (norm2 - 1.0).abs() < 1e-12;
    let unit = || Pose::<Agent, Sensor>::from_xyz_wxyz([0.0; 3], quaternion).wxyz();
    Ok(Mounting { translation, quaternion: if is_exact { quaternion } else { unit() } })
}

impl Rig {
    /// Where a place is on its agent; at its origin, ahead, where nothing is said (receivers).
    fn mounting(&self, place: &str) -> Mounting {
        let place = if place == SEMANTIC_LIDAR { LIDAR } else { place };
        let found = self.mounts.iter().find(|(name, _)| *name == place);
        found
            .map_or(Mounting { translation: [0.0; 3], quaternion: [1.0, 0.0, 0.0, 0.0] }, |(_, mount)| *mount)
    }

    /// The mount of a place in the agent's axes (of cameras not the optical ones).
    pub(crate) fn mount(&self, place: &str) -> Mount {
        let Mounting { translation, quaternion } = self.mounting(place);
        let mut pose = Pose::<Agent, Sensor>::from_xyz_wxyz(translation, quaternion);
        if place.starts_with("CAM") {
            let optical = Pose::<Agent, frames::Optical>::from_xyz_wxyz(translation, quaternion);
            pose = optical * flu_from_optical().inverse();
        }
        Mount { xyz_m: translation, rpy_rad: pose.rpy() }
    }

    /// What the table of a sensor says of it.
    pub(crate) fn flat(&self, name: &str) -> Calibration {
        Calibration {
            name: name.to_owned(),
            frame: "flu".to_owned(),
            agent_from_sensor: self.mounting(name),
            every_n_frames: 1,
            width: None,
            height: None,
            intrinsics: None,
            lens: None,
        }
    }

    /// What the tables of a camera say of it, with pictures of a size.
    pub(crate) fn camera(&self, camera: &str, (width, height): (u32, u32)) -> Calibration {
        Calibration {
            frame: "optical".to_owned(),
            width: Some(width),
            height: Some(height),
            intrinsics: Some(self.intrinsics),
            lens: Some(Lens::Pinhole),
            ..self.flat(camera)
        }
    }
}
