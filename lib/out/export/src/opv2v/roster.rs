//! Which agents of a scene are exported, with which sensors, at which frames.

use std::collections::BTreeSet;

use frames::{Agent, Optical, Pose, Sensor, flu_from_optical};
use nalgebra::Vector3;
use scene::{SensorEntry, SensorKind, sensors_of};
use schema::{AgentId, AgentKind, ImageKind};
use serde::Serialize;
use settings::Lens;

use super::beams::Rings;
use super::options::{Options, Variant};
use crate::{ExportError, Omission, SceneSource};

/// Names of all agents and objects are their ids above this, so that their order as texts is that of numbers.
pub(super) const FIRST_NAME: i64 = 10_000;
/// Names of further RSUs, if they are wanted, are above those of all objects (75,535).
const FIRST_RSU_NAME: i64 = 80_000;

/// Directions of the cameras 0 to 3: ahead, right, left, back; degrees to the left.
const VIEWS_DEG: [f64; 4] = [0.0, -100.0, 100.0, 180.0];
/// A camera that looks farther from its direction than this does not stand for it, degrees.
const MAX_OFF_DEG: f64 = 60.0;

/// The exported agents of a scene.
#[derive(Clone, Debug)]
pub(super) struct AgentRoster {
    pub(super) members: Vec<Member>,
    /// Frames 0, n, 2 n, ... are exported.
    pub(super) every_n_frames: u32,
    /// What of the scene is not, by name.
    pub(super) omissions: BTreeSet<Omission>,
}

/// Pictures for a member that has no four cameras, where others of the export have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct StandIns {
    /// Columns and rows of the others' pictures.
    pub(super) size_px: [u32; 2],
    /// Whether the others have depths, too.
    pub(super) have_depths: bool,
}

/// An exported agent.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) agent: AgentId,
    /// Its object id in the store.
    pub(super) id: u16,
    /// Its folder; negative for RSUs.
    pub(super) name: i64,
    pub(super) lidar: SensorEntry,
    pub(super) rings: Rings,
    /// Ahead, right, left, back.
    pub(super) cameras: Option<[CameraPair; 4]>,
    /// At every how many frames pixels say what it sees; else points do.
    pub(super) pixels_every_n_frames: Option<u32>,
}

impl Member {
    /// Whether there are thinned clouds of its lidar.
    pub(super) fn is_thinned(&self) -> bool {
        !matches!(self.rings, Rings::Unknown)
    }
}

/// A camera's pictures and, if it has them, depths.
#[derive(Clone, Debug)]
pub(super) struct CameraPair {
    pub(super) color: SensorEntry,
    pub(super) depth: Option<SensorEntry>,
}

impl CameraPair {
    /// Columns and rows.
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.color.about.width, self.color.about.height].map(Option::unwrap_or_default)
    }
}

impl AgentRoster {
    /// Chooses from a scene.
    ///
    /// # Errors
    /// Nobody of it can be exported, or the store cannot be read.
    pub(super) fn of(scene: &SceneSource, options: &Options) -> Result<Self, ExportError> {
        let mut omissions = BTreeSet::new();
        let mut members = Vec::new();
        for (agent, name) in named(scene, options)? {
            let Some(name) = name else {
                let why = "the layout has one RSU, the one nearest to the ego: --all-rsus gives the others positive ids";
                omissions.insert(Omission::new(agent.to_string(), why));
                continue;
            };
            members.extend(member(scene, agent, name, options, &mut omissions)?);
        }
        if members.is_empty() {
            return Err(ExportError::Refused(format!(
                "scene {}: no agent has a lidar among the sensors that are wanted, and the layout needs one each",
                scene.number()
            )));
        }
        // Folders are read in the order of their texts.
        members.sort_by_key(|member| member.name.to_string());
        let rates = members.iter().map(|member| member.lidar.about.every_n_frames);
        let rates = rates.chain([scene.info().label_every_n_frames, scene.every_n_frames()]);
        let mut roster = Self { every_n_frames: rates.fold(1, least_common_multiple), members, omissions };
        roster.drop_slow_pictures();
        Ok(roster)
    }

    /// The frames that all members have.
    pub(super) fn frames(&self, scene: &SceneSource) -> impl Iterator<Item = u32> + use<> {
        schema::rate::due(scene.info().frames, self.every_n_frames)
    }

    pub(super) fn member(&self, agent: AgentId) -> Option<&Member> {
        self.members.iter().find(|member| member.agent == agent)
    }

    /// What would stand in for pictures beside those of its first member that has some.
    pub(super) fn stand_ins(&self) -> Option<StandIns> {
        let cameras = self.members.iter().find_map(|member| member.cameras.as_ref())?;
        let have_depths = cameras.iter().all(|camera| camera.depth.is_some());
        Some(StandIns { size_px: cameras[0].size_px(), have_depths })
    }

    /// Cameras must have a picture of every exported frame.
    fn drop_slow_pictures(&mut self) {
        let every = self.every_n_frames;
        let is_slow = |sensor: &SensorEntry| !every.is_multiple_of(sensor.about.every_n_frames.max(1));
        for member in &mut self.members {
            let agent = member.agent;
            if member.cameras.iter().flatten().any(|camera| is_slow(&camera.color)) {
                member.cameras = None;
                let why = format!("they have no picture at every {every}. frame: see --every");
                self.omissions.insert(Omission::new(format!("cameras of {agent}"), why));
            }
            if !member.pixels_every_n_frames.is_some_and(|n| every.is_multiple_of(n)) {
                member.pixels_every_n_frames = None;
                let why = "there are no instance images of the exported frames: what it has a point of counts as seen";
                self.omissions.insert(Omission::new(format!("what pictures of {agent} show"), why));
            }
            for camera in member.cameras.iter_mut().flatten() {
                if camera.depth.as_ref().is_some_and(is_slow) {
                    camera.depth = None;
                    let why = format!("there is no image at every {every}. frame: see --every");
                    self.omissions.insert(Omission::new(format!("depth of {agent}"), why));
                }
            }
        }
    }
}

fn least_common_multiple(a: u32, b: u32) -> u32 {
    let (a, b) = (a.max(1), b.max(1));
    let (mut divisor, mut rest) = (a, b);
    while rest != 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (a / divisor).saturating_mul(b)
}

/// The wanted agents with the names of their folders; none for an RSU that has no place.
fn named(scene: &SceneSource, options: &Options) -> Result<Vec<(AgentId, Option<i64>)>, ExportError> {
    let is_rsu = |agent: &AgentId| agent.kind == AgentKind::Rsu;
    let id_of = |agent: AgentId| object_id(scene, agent).map(i64::from);
    let mut named = Vec::new();
    for &agent in scene.agents().iter().filter(|agent| !is_rsu(agent)) {
        named.push((agent, Some(FIRST_NAME + id_of(agent)?)));
    }
    let ego = named.iter().min_by_key(|(_, name)| *name).map(|(agent, _)| *agent);
    let mut rsus: Vec<AgentId> = scene.agents().iter().copied().filter(is_rsu).collect();
    if let (Some(ego), true) = (ego, rsus.len() > 1) {
        let rows = scene.agent_rows()?;
        let middle = scene.info().frames as usize / 2;
        let place = |agent: AgentId| {
            let at = scene.agents().iter().position(|other| *other == agent);
            let row = at.and_then(|at| rows.get(at)?.get(middle));
            row.map_or_else(Vector3::zeros, |row| Vector3::from(row.xyz_m))
        };
        let distance = |agent: &AgentId| (place(*agent) - place(ego)).norm();
        rsus.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
    }
    for (number, rsu) in (0_i64..).zip(rsus) {
        let name = match (options.variant, number) {
            (Variant::V2xReal, _) | (_, 0) => Some(-1 - number),
            _ => options.chosen.all_rsus.then_some(FIRST_RSU_NAME + number),
        };
        named.push((rsu, name));
    }
    Ok(named)
}

/// The object that an agent is.
fn object_id(scene: &SceneSource, agent: AgentId) -> Result<u16, ExportError> {
    let name = agent.to_string();
    let info = scene.info().agents.iter().find(|info| info.agent == name);
    info.map(|info| info.id).ok_or_else(|| ExportError::Content {
        scene: scene.number(),
        frame: None,
        agent: Some(name),
        problem: "log/scene.json does not list it: run `convoy verify` on the store".into(),
    })
}

/// The sensors of an agent; nobody where it has no lidar.
fn member(
    scene: &SceneSource,
    agent: AgentId,
    name: i64,
    options: &Options,
    omissions: &mut BTreeSet<Omission>,
) -> Result<Option<Member>, ExportError> {
    let sensors = scene.sensors(agent)?;
    let mut omit = |what: String, why: &str| omissions.insert(Omission::new(what, why));
    let lidars = || sensors.iter().filter(|sensor| sensor.kind == SensorKind::Lidar);
    let wanted = options.shared().lidar.as_deref();
    let lidar = match wanted {
        Some(wanted) => lidars().find(|lidar| lidar.name == wanted),
        None => lidars().find(|lidar| lidar.name == "LIDAR").or_else(|| lidars().next()),
    };
    let Some(lidar) = lidar.cloned() else {
        let why = format!("it has no lidar{}", wanted.map_or(String::new(), |name| format!(" {name}")));
        omit(agent.to_string(), &why);
        return Ok(None);
    };
    for other in lidars().filter(|other| other.name != lidar.name) {
        omit(format!("{} of {agent}", other.name), "the layout has one lidar an agent: --lidar names it");
    }
    let cameras = match cameras(&sensors, options) {
        Ok(cameras) => Some(cameras),
        Err(None) => None,
        Err(Some(why)) => {
            omit(format!("cameras of {agent}"), &why);
            None
        }
    };
    // What the pixels of instance images say is in the labels, whether the images themselves are wanted or
    // not.
    let all = sensors_of(scene.reader(), agent)?;
    let instance = all.iter().find(|sensor| sensor.kind == SensorKind::Image(ImageKind::Instance));
    let pixels_every_n_frames = instance.map(|sensor| sensor.about.every_n_frames.max(1));
    let rings = match options.variant {
        Variant::Opv2v => Rings::of(scene, agent, &lidar)?,
        // It has no thinned clouds.
        Variant::V2xReal => Rings::Known,
    };
    if matches!(rings, Rings::Unknown) {
        let why =
            "nobody knows the rings of imported scenes, and elevations of these points tell no beams apart";
        omissions.insert(Omission::new(format!("thinned clouds (_32, _16) of {agent}"), why));
    }
    Ok(Some(Member {
        agent,
        id: object_id(scene, agent)?,
        name,
        lidar,
        rings,
        cameras,
        pixels_every_n_frames,
    }))
}

/// The four cameras of an agent, or why it has not; none where it has none at all.
fn cameras(sensors: &[SensorEntry], options: &Options) -> Result<[CameraPair; 4], Option<String>> {
    let of_kind = |kind| sensors.iter().filter(move |sensor| sensor.kind == SensorKind::Image(kind));
    let color: Vec<&SensorEntry> = of_kind(ImageKind::Rgb).collect();
    if color.is_empty() {
        return Err(None);
    }
    let by_name = |name: &str| color.iter().position(|sensor| sensor.camera() == Some(name));
    let chosen: Vec<usize> = match &options.shared().cameras {
        Some(names) => {
            let found = names.iter().map(|name| by_name(name).ok_or_else(|| format!("there is no {name}")));
            found.collect::<Result<_, _>>().map_err(Some)?
        }
        None => {
            let usual = (0..4).map(|n| by_name(&format!("camera{n}"))).collect::<Option<Vec<_>>>();
            usual.or_else(|| by_direction(&color)).ok_or_else(|| {
                Some("the layout has four: ahead, right, left, back (--cameras names them)".to_owned())
            })?
        }
    };
    let pair = |at: usize| {
        let color = color[at];
        match (&color.about.lens, color.about.intrinsics) {
            (None | Some(Lens::Pinhole), Some(_)) => {}
            _ => return Err(Some(format!("{}: the layout has pinhole cameras only", color.name))),
        }
        let depth = of_kind(ImageKind::Depth).find(|depth| depth.camera() == color.camera());
        Ok(CameraPair { color: color.clone(), depth: depth.cloned() })
    };
    let pairs: Vec<CameraPair> = chosen.into_iter().map(pair).collect::<Result<_, _>>()?;
    pairs.try_into().map_err(|_| Some("the layout has four".into()))
}

/// For each of the four directions the camera that looks nearest to it; none where one is missing.
fn by_direction(cameras: &[&SensorEntry]) -> Option<Vec<usize>> {
    let mut chosen = Vec::new();
    for view_deg in VIEWS_DEG {
        let off_deg = |at: &usize| {
            let ahead = agent_from_camera(cameras[*at]).forward();
            let yaw = frames::math::atan2(ahead.y, ahead.x);
            frames::to_deg(frames::wrap_pi(yaw - frames::deg(view_deg))).abs()
        };
        let free = (0..cameras.len()).filter(|at| !chosen.contains(at) && off_deg(at) <= MAX_OFF_DEG);
        chosen.push(free.min_by(|a, b| off_deg(a).total_cmp(&off_deg(b)))?);
    }
    Some(chosen)
}

/// Where a camera that stands in is on its agent: at its lidar, in the direction of its number.
pub(super) fn agent_from_stand_in(lidar: &SensorEntry, number: usize) -> Pose<Agent, Sensor> {
    let xyz_m = lidar.about.agent_from_sensor.agent_from_sensor::<Sensor>().xyz();
    Pose::from_xyz_rpy(xyz_m, [0.0, 0.0, frames::deg(VIEWS_DEG[number])])
}

/// Where a sensor's forward, left, up are on its agent; cameras look forward.
pub(super) fn agent_from_camera(sensor: &SensorEntry) -> Pose<Agent, Sensor> {
    sensor.about.agent_from_sensor.agent_from_sensor::<Optical>() * flu_from_optical().inverse()
}

#[cfg(test)]
mod tests {
    use frames::deg;
    use schema::calibration::{Calibration, Mounting};

    use super::*;
    use crate::command::usual;
    use crate::opv2v::{Opv2vOptions, SharedOptions};

    fn camera(name: &str, yaw_deg: f64) -> SensorEntry {
        let mount = Pose::<Agent, Sensor>::from_xyz_rpy([0.0; 3], [0.0, 0.1, deg(yaw_deg)]);
        SensorEntry {
            name: format!("RGB-{name}"),
            kind: SensorKind::Image(ImageKind::Rgb),
            about: Calibration {
                name: name.into(),
                frame: "optical".into(),
                agent_from_sensor: Mounting::new(&(mount * flu_from_optical())),
                every_n_frames: 1,
                width: Some(800),
                height: Some(600),
                intrinsics: Some([[1.0, 0.0, 400.0], [0.0, 1.0, 300.0], [0.0, 0.0, 1.0]]),
                lens: None,
            },
            bytes: 0,
        }
    }

    fn names(found: &[CameraPair; 4]) -> [&str; 4] {
        [0, 1, 2, 3].map(|n| found[n].color.camera().unwrap_or_default())
    }

    #[test]
    fn four_of_six_cameras_by_direction() {
        let six = [
            camera("FL", 55.0),
            camera("F", 0.0),
            camera("FR", -55.0),
            camera("BL", 110.0),
            camera("B", 180.0),
            camera("BR", -110.0),
        ];
        let options = Options::new(Variant::Opv2v, usual());
        assert_eq!(names(&cameras(&six, &options).expect("has four")), ["F", "BR", "BL", "B"]);
        let named = ["FL", "F", "FR", "B"].map(String::from);
        let with = |names: [String; 4]| {
            let shared = SharedOptions { cameras: Some(names), ..usual() };
            Options::new(Variant::Opv2v, Opv2vOptions { shared, all_rsus: false })
        };
        let chosen = with(named.clone());
        assert_eq!(names(&cameras(&six, &chosen).expect("are there")), ["FL", "F", "FR", "B"]);
        let [a, b, c, _] = named;
        let wrong = with([a, b, c, "X".into()]);
        assert_eq!(cameras(&six, &wrong).expect_err("X is missing"), Some("there is no X".into()));
        assert_eq!(cameras(&[], &options).expect_err("none"), None);
        let three = cameras(&six[..3], &options).expect_err("nothing looks back").expect("says why");
        assert!(three.contains("--cameras"), "{three}");
        let mut bent = six;
        bent[1].about.lens = Some(Lens::Fisheye { k: [0.0; 4] });
        let why = cameras(&bent, &options).expect_err("has a lens").expect("says why");
        assert!(why.contains("RGB-F: ") && why.contains("pinhole"), "{why}");
    }

    #[test]
    fn usual_names_come_before_directions() {
        let turned =
            [camera("camera0", 90.0), camera("camera1", 0.0), camera("camera2", 5.0), camera("camera3", 9.0)];
        let found = cameras(&turned, &Options::new(Variant::Opv2v, usual())).expect("has them");
        assert_eq!(names(&found), ["camera0", "camera1", "camera2", "camera3"]);
    }

    #[test]
    fn frames_are_those_of_all() {
        for (a, b, both) in [(1, 2, 2), (2, 3, 6), (4, 6, 12), (0, 5, 5), (3, 3, 3)] {
            assert_eq!(least_common_multiple(a, b), both);
        }
    }
}
