//! Where sensors are, as the layout has room for: one place for each name, one matrix for all cameras of
//! vehicles and one for those of RSUs.

use std::collections::BTreeMap;

use frames::{Agent, Optical, Pose, Sensor, flu_from_optical};
use scene::{SensorEntry, SensorKind};
use schema::calibration::Calibration;
use schema::{AgentId, AgentKind};
use serde::{Deserialize, Serialize};
use settings::Lens;

use super::names::{self, LIDAR, SEMANTIC_LIDAR, VOXELS};
use super::pytext::Node;
use crate::ExportError;

/// Mounts of the published rig, for sensors that the store has not: x, y, z, m, and yaw, degrees.
const VEHICLE_MOUNTS: [(&str, [f64; 4]); 12] = [
    ("CAM_FRONT_LEFT", [0.4, 0.4, 1.6, 55.0]),
    ("CAM_FRONT", [0.6, 0.0, 1.6, 0.0]),
    ("CAM_FRONT_RIGHT", [0.4, -0.4, 1.6, -55.0]),
    ("CAM_BACK_LEFT", [0.0, 0.4, 1.6, 110.0]),
    ("CAM_BACK", [-1.0, 0.0, 1.6, 180.0]),
    ("CAM_BACK_RIGHT", [0.0, -0.4, 1.6, -110.0]),
    (LIDAR, [0.0, 0.0, 1.8, 0.0]),
    ("RAD_LEFT", [0.0, 1.0, 0.6, 90.0]),
    ("RAD_FRONT", [2.4, 0.0, 0.6, 0.0]),
    ("RAD_RIGHT", [0.0, -1.0, 0.6, -90.0]),
    ("RAD_BACK", [-2.4, 0.0, 0.6, 180.0]),
    (VOXELS, [0.0, 0.0, 0.02, 0.0]),
];
const RSU_MOUNTS: [(&str, [f64; 4]); 6] = [
    ("CAM_FRONT_LEFT", [0.0, 0.0, 1.6, 55.0]),
    ("CAM_FRONT", [0.0, 0.0, 1.6, 0.0]),
    ("CAM_FRONT_RIGHT", [0.0, 0.0, 1.6, -55.0]),
    (LIDAR, [0.0, 0.0, 3.2, 0.0]),
    ("RAD_FRONT", [0.0, 0.0, 1.2, 0.0]),
    (VOXELS, [0.0, 0.0, 0.02, 0.0]),
];
/// 1600 x 900 pixels, 80 degrees wide.
const INTRINSICS: [[f64; 3]; 3] =
    [[953.4028740753681, 0.0, 800.0], [0.0, 953.4028740753681, 450.0], [0.0, 0.0, 1.0]];

/// Bounds and cell of the voxel grids of a kind of agents, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Voxels {
    pub(super) range_m: f64,
    pub(super) voxel_m: f64,
    pub(super) upper_m: f64,
    pub(super) lower_m: f64,
    pub(super) mount_z_m: f64,
}

impl Default for Voxels {
    fn default() -> Self {
        Self { range_m: 64.0, voxel_m: 0.1, upper_m: 7.0, lower_m: -1.0, mount_z_m: 0.02 }
    }
}

/// What is said of the sensors of one kind of agents. Numbers are kept as texts that read back exactly.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Rig {
    /// Translation and quaternion of each place (`CAM_FRONT`, `LIDAR`, `RAD_BACK`, `VOXEL-GRID`), with who
    /// says so.
    mounts: BTreeMap<String, (String, String)>,
    /// The matrix of the cameras.
    intrinsics: Option<(String, String)>,
    /// Bounds of the voxel grids.
    voxels: Option<(String, String)>,
}

/// Rigs of vehicles and of RSUs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Rigs {
    vehicle: Rig,
    rsu: Rig,
}

/// Whether the layout has a place for a sensor of an agent; why not, if not.
pub(super) fn place_of(agent: AgentId, sensor: &SensorEntry) -> Result<&'static str, &'static str> {
    let known = |names: &'static [&'static str], name: &str, why| {
        names.iter().copied().find(|known| *known == name).ok_or(why)
    };
    match sensor.kind {
        SensorKind::Image(_) => {
            if sensor.about.lens.as_ref().is_some_and(|lens| !matches!(lens, Lens::Pinhole)) {
                return Err("the layout knows pinhole cameras alone");
            }
            let why = "the layout has no camera of this name for such agents";
            known(names::cameras(agent.kind), sensor.camera().unwrap_or_default(), why)
        }
        SensorKind::Lidar => known(&[LIDAR], &sensor.name, "the layout has one lidar, `LIDAR`"),
        SensorKind::SemanticLidar => {
            let why = "the layout has one semantic lidar, `SEG-LIDAR`";
            known(&[SEMANTIC_LIDAR], &sensor.name, why)
        }
        SensorKind::Radar => known(
            names::radars(agent.kind),
            &sensor.name,
            "the layout has no radar of this name for such agents",
        ),
        SensorKind::Gnss | SensorKind::Imu => match agent.kind {
            AgentKind::Vehicle => known(&["GNSS", "IMU"], &sensor.name, "the layout has one such sensor"),
            AgentKind::Rsu => Err("RSUs have no such sensor in the layout"),
        },
    }
}

impl Rigs {
    fn of(&mut self, kind: AgentKind) -> &mut Rig {
        match kind {
            AgentKind::Vehicle => &mut self.vehicle,
            AgentKind::Rsu => &mut self.rsu,
        }
    }

    /// Adds a sensor of an agent, of the place that [`place_of`] names. Nothing is said of receivers.
    pub(super) fn add(
        &mut self,
        who: &str,
        kind: AgentKind,
        place: &str,
        about: &Calibration,
    ) -> Result<(), ExportError> {
        if matches!(place, "GNSS" | "IMU") {
            return Ok(());
        }
        // Both lidars stand in one place.
        let place = if place == SEMANTIC_LIDAR { LIDAR } else { place };
        let rig = self.of(kind);
        let mount = &about.agent_from_sensor;
        let text = words(mount.translation.iter().chain(&mount.quaternion));
        let found = rig.mounts.entry(place.to_owned()).or_insert_with(|| (text.clone(), who.to_owned()));
        agree(found, &text, who, place, "place on the agent")?;
        if let (Some(matrix), "optical") = (&about.intrinsics, about.frame.as_str()) {
            let text = words(matrix.iter().flatten());
            let found = rig.intrinsics.get_or_insert_with(|| (text.clone(), who.to_owned()));
            agree(found, &text, who, place, "matrix of intrinsics for all cameras")?;
        }
        Ok(())
    }

    /// Adds the bounds of an agent's voxel grids.
    pub(super) fn add_voxels(
        &mut self,
        who: &str,
        kind: AgentKind,
        voxels: &Voxels,
    ) -> Result<(), ExportError> {
        let Voxels { range_m, voxel_m, upper_m, lower_m, mount_z_m } = *voxels;
        let rig = self.of(kind);
        let text = words(&[range_m, voxel_m, upper_m, lower_m, mount_z_m]);
        let found = rig.voxels.get_or_insert_with(|| (text.clone(), who.to_owned()));
        agree(found, &text, who, VOXELS, "size")
    }

    /// Adds what is said elsewhere.
    pub(super) fn merge(&mut self, other: &Self) -> Result<(), ExportError> {
        for kind in [AgentKind::Vehicle, AgentKind::Rsu] {
            let from = match kind {
                AgentKind::Vehicle => &other.vehicle,
                AgentKind::Rsu => &other.rsu,
            };
            let to = self.of(kind);
            for (place, (text, who)) in &from.mounts {
                let found = to.mounts.entry(place.clone()).or_insert_with(|| (text.clone(), who.clone()));
                agree(found, text, who, place, "place on the agent")?;
            }
            let matrix = "matrix of intrinsics for all cameras";
            for (mine, theirs, place, what) in [
                (&mut to.intrinsics, &from.intrinsics, "cameras", matrix),
                (&mut to.voxels, &from.voxels, VOXELS, "size"),
            ] {
                if let Some((text, who)) = theirs {
                    let found = mine.get_or_insert_with(|| (text.clone(), who.clone()));
                    agree(found, text, who, place, what)?;
                }
            }
        }
        Ok(())
    }

    /// The `metadata` of infos files. What no agent has is as on the published rig: readers want every key.
    pub(super) fn metadata(&self) -> Node {
        let matrix = |rig: &Rig| {
            let own = rig.intrinsics.as_ref().and_then(|(text, _)| numbers::<9>(text));
            let rows =
                own.map_or(INTRINSICS, |m| std::array::from_fn(|r| std::array::from_fn(|c| m[3 * r + c])));
            Node::List(rows.iter().map(|row| Node::floats(row)).collect())
        };
        let detector = |rig: &Rig| {
            let Voxels { range_m, voxel_m, upper_m, lower_m, .. } = rig.voxels();
            Node::object([
                ("range", Node::Float(range_m)),
                ("voxel_size", Node::Float(voxel_m)),
                ("upper_limit", Node::Float(upper_m)),
                ("lower_limit", Node::Float(lower_m)),
            ])
        };
        let (vehicle, rsu) = (&self.vehicle, &self.rsu);
        let mut entries = vec![
            ("camera_intrinsics".to_owned(), matrix(vehicle)),
            ("rsu_camera_intrinsics".to_owned(), matrix(rsu)),
            ("voxel_detector_properties".to_owned(), detector(vehicle)),
            ("rsu_voxel_detector_properties".to_owned(), detector(rsu)),
        ];
        let mut place =
            |key: String, rig: &Rig, kind, place: &str| entries.push((key, rig.record(kind, place)));
        let (car, unit) = (AgentKind::Vehicle, AgentKind::Rsu);
        place(LIDAR.to_owned(), vehicle, car, LIDAR);
        place(format!("RSU-{LIDAR}"), rsu, unit, LIDAR);
        for kinds in [names::cameras, names::radars] {
            kinds(car).iter().for_each(|name| place((*name).to_owned(), vehicle, car, name));
            kinds(unit).iter().for_each(|name| place(format!("RSU-{name}"), rsu, unit, name));
        }
        place(VOXELS.to_owned(), vehicle, car, VOXELS);
        place(format!("RSU-{VOXELS}"), rsu, unit, VOXELS);
        Node::Object(entries)
    }
}

impl Rig {
    fn voxels(&self) -> Voxels {
        let own = self.voxels.as_ref().and_then(|(text, _)| numbers::<5>(text));
        own.map_or_else(Voxels::default, |[range_m, voxel_m, upper_m, lower_m, mount_z_m]| Voxels {
            range_m,
            voxel_m,
            upper_m,
            lower_m,
            mount_z_m,
        })
    }

    /// Translation and quaternion of a place, in the axes of its sensor.
    fn mount(&self, kind: AgentKind, place: &str) -> ([f64; 3], [f64; 4]) {
        if place == VOXELS {
            return ([0.0, 0.0, self.voxels().mount_z_m], [1.0, 0.0, 0.0, 0.0]);
        }
        let own = self.mounts.get(place).and_then(|(text, _)| numbers::<7>(text));
        own.map_or_else(|| published(kind, place), |[x, y, z, a, b, c, d]| ([x, y, z], [a, b, c, d]))
    }

    /// The pose record of a place.
    fn record(&self, kind: AgentKind, place: &str) -> Node {
        let (xyz, wxyz) = self.mount(kind, place);
        let (lidar_xyz, lidar_wxyz) = self.mount(kind, LIDAR);
        let upright = lidar_wxyz == [1.0, 0.0, 0.0, 0.0];
        let (to_xyz, to_wxyz) = if upright {
            (std::array::from_fn(|axis| xyz[axis] - lidar_xyz[axis]), wxyz)
        } else {
            let agent_from_lidar = Pose::<Agent, Sensor>::from_xyz_wxyz(lidar_xyz, lidar_wxyz);
            let lidar_from_sensor =
                agent_from_lidar.inverse() * Pose::<Agent, Sensor>::from_xyz_wxyz(xyz, wxyz);
            (lidar_from_sensor.xyz(), lidar_from_sensor.wxyz())
        };
        Node::object([
            ("sensor2lidar_translation", Node::floats(&to_xyz)),
            ("sensor2lidar_rotation", Node::floats(&to_wxyz)),
            ("sensor2ego_translation", Node::floats(&xyz)),
            ("sensor2ego_rotation", Node::floats(&wxyz)),
        ])
    }
}

/// A place of the published rig.
fn published(kind: AgentKind, place: &str) -> ([f64; 3], [f64; 4]) {
    let mounts: &[(&str, [f64; 4])] = match kind {
        AgentKind::Vehicle => &VEHICLE_MOUNTS,
        AgentKind::Rsu => &RSU_MOUNTS,
    };
    let found = mounts.iter().find(|(name, _)| *name == place);
    let [x, y, z, yaw_deg] = found.map_or([0.0; 4], |(_, mount)| *mount);
    let pose = Pose::<Agent, Sensor>::from_xyz_rpy([x, y, z], [0.0, 0.0, frames::deg(yaw_deg)]);
    if place.starts_with("CAM") {
        let optical: Pose<Agent, Optical> = pose * flu_from_optical();
        return ([x, y, z], optical.wxyz());
    }
    ([x, y, z], pose.wxyz())
}

/// The layout has room for one value: all must say the same.
fn agree(
    found: &(String, String),
    text: &str,
    who: &str,
    place: &str,
    what: &str,
) -> Result<(), ExportError> {
    if found.0 == text {
        return Ok(());
    }
    let (first, other) = (&found.1, &found.0);
    Err(ExportError::Refused(format!(
        "{place}: the layout has one {what} for all vehicles and one for all RSUs, but {first} has [{other}] and {who} [{text}]: \
         leave one of them out with --agents, --scenes or --sensors"
    )))
}

/// Numbers as a text that reads back exactly.
fn words<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    numbers.into_iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let found: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
    found.try_into().ok()
}

#[cfg(test)]
mod tests {
    use schema::calibration::Mounting;

    use super::*;

    fn about(translation: [f64; 3], quaternion: [f64; 4]) -> Calibration {
        let intrinsics = Some([[100.0, 0.0, 80.0], [0.0, 100.0, 45.0], [0.0, 0.0, 1.0]]);
        Calibration {
            name: "x".into(),
            frame: "optical".into(),
            agent_from_sensor: Mounting { translation, quaternion },
            every_n_frames: 1,
            width: Some(160),
            height: Some(90),
            intrinsics,
            lens: None,
        }
    }

    fn entry<'a>(node: &'a Node, key: &str) -> &'a Node {
        let Node::Object(entries) = node else { panic!("an object") };
        &entries.iter().find(|(name, _)| name == key).expect("has the key").1
    }

    fn floats(node: &Node) -> Vec<f64> {
        let Node::List(items) = node else { panic!("a list") };
        items
            .iter()
            .map(|item| if let Node::Float(value) = item { *value } else { panic!("a number") })
            .collect()
    }

    #[test]
    fn the_published_rig_stands_in_for_what_is_not_there() {
        let metadata = Rigs::default().metadata();
        let Node::Object(entries) = &metadata else { panic!("an object") };
        assert_eq!(entries.len(), 4 + 2 + 6 + 3 + 4 + 1 + 2);
        // Quaternions and differences as in the published files, to seven digits.
        for (key, expected) in [
            ("CAM_FRONT_LEFT", [0.6743797, -0.6743797, 0.2126311, -0.2126311]),
            ("CAM_BACK", [0.5, -0.5, -0.5, 0.5]),
            ("RSU-CAM_FRONT_RIGHT", [0.2126311, -0.2126311, 0.6743797, -0.6743797]),
            ("RAD_LEFT", [std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2]),
            ("RAD_BACK", [0.0, 0.0, 0.0, 1.0]),
        ] {
            let found = floats(entry(entry(&metadata, key), "sensor2ego_rotation"));
            let same = |sign: f64| found.iter().zip(expected).all(|(a, b)| (sign * a - b).abs() < 2e-7);
            assert!(same(1.0) || same(-1.0), "{key}: {found:?}");
        }
        let below = floats(entry(entry(&metadata, "CAM_BACK"), "sensor2lidar_translation"));
        assert_eq!(below, [-1.0, 0.0, -0.19999999999999996]);
        let grid = floats(entry(entry(&metadata, "RSU-VOXEL-GRID"), "sensor2lidar_translation"));
        assert_eq!(grid, [0.0, 0.0, -3.18]);
    }

    #[test]
    fn sensors_of_the_store_come_first_and_must_agree() {
        let mut rigs = Rigs::default();
        let upright = [1.0, 0.0, 0.0, 0.0];
        rigs.add("a", AgentKind::Vehicle, "CAM_FRONT", &about([1.0, 2.0, 3.0], upright)).expect("the first");
        rigs.add("b", AgentKind::Vehicle, "CAM_FRONT", &about([1.0, 2.0, 3.0], upright)).expect("the same");
        rigs.add("c", AgentKind::Rsu, "CAM_FRONT", &about([9.0, 2.0, 3.0], upright))
            .expect("RSUs have their own");
        let error = rigs.add("d", AgentKind::Vehicle, "CAM_FRONT", &about([1.0, 2.0, 3.5], upright));
        let error = error.expect_err("another place").to_string();
        assert!(error.contains("a has [1 2 3 1 0 0 0] and d [1 2 3.5 1 0 0 0]"), "{error}");
        let metadata = rigs.metadata();
        let found = entry(&metadata, "CAM_FRONT");
        assert_eq!(floats(entry(found, "sensor2ego_translation")), [1.0, 2.0, 3.0]);
        assert_eq!(floats(entry(found, "sensor2lidar_translation")), [1.0, 2.0, 1.2]);
        let Node::List(rows) = entry(&metadata, "camera_intrinsics") else { panic!("rows") };
        assert_eq!(floats(&rows[1]), [0.0, 100.0, 45.0]);
    }

    #[test]
    fn a_turned_lidar_turns_what_is_seen_from_it() {
        // A lidar that looks to the left, 2 m up; a radar 1 m left of it that looks to the left, too: 1 m
        // ahead of the lidar.
        let left = [0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()];
        let mut rigs = Rigs::default();
        rigs.add("a", AgentKind::Vehicle, LIDAR, &about([0.0, 0.0, 2.0], left)).expect("fits");
        rigs.add("a", AgentKind::Vehicle, "RAD_LEFT", &about([0.0, 1.0, 2.0], left)).expect("fits");
        let metadata = rigs.metadata();
        let radar = entry(&metadata, "RAD_LEFT");
        let near = |found: Vec<f64>, expected: &[f64]| {
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(near(floats(entry(radar, "sensor2lidar_translation")), &[1.0, 0.0, 0.0]));
        assert!(near(floats(entry(radar, "sensor2lidar_rotation")), &[1.0, 0.0, 0.0, 0.0]));
    }
}
