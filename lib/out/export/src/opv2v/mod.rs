//! The layouts of OPV2V (OpenCOOD, HEAL, CoBEVT) and V2X-Real: scenarios of agents, a YAML, a cloud and four
//! pictures a frame.
//!
//! ```text
//! OPV2V/{train,validate,test}/scene_NNNN/data_protocol.yaml
//! OPV2V/{train,validate,test}/scene_NNNN/AGENT/FFFFFF.{yaml,json,pcd}  _camera0.png .. _camera3.png
//!     FFFFFF_bev_{dynamic,static,lane,visibility,visibility_corp}.png
//! OPV2V_Hetero/{train,validate,test}/scene_NNNN/AGENT/FFFFFF_{32,16}.pcd  FFFFFF_depth0.png .. 3
//! heter_modality_assign.json  hypes/
//! ```
//!
//! V2X-Real: below `V2X-Real/`, clouds are `FFFFFF.bin`, objects have an `obj_type`, and there is nothing
//! more.

mod beams;
mod bev;
mod clouds;
mod finish;
mod handedness;
mod lanes;
mod options;
mod record;
mod roster;
mod unit;
mod vehicles;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use scene::{SensorEntry, SensorKind, sensors_of};
use schema::ImageKind;
use schema::arrays::BEV_MASKS;
use schema::scene_info::LOG_STAGE;
use schema::table::Row;
use schema::tables::{LidarRow, ValidBoxRow};

use crate::{Cost, ExportError, Layout, Omission, SceneSource, Source, UnitFiles, UnitName};
pub use options::{Opv2vOptions, SharedOptions};

use options::{Options, Variant};

use crate::asked::by_option;
use crate::source::NO_MAP;
use bev::RoadChannel;
use roster::{AgentRoster, Member, StandIns};

/// Why lanes are left out of pictures of scenes that were made here.
const NO_LINES: &str = "the store has no lines of it: `convoy run` writes them";

/// Words in paths that HEAL replaces by others.
const REPLACED: [&str; 5] = ["OPV2V", "train", "validate", "test", "yaml"];

/// One of the layouts, with its options.
#[derive(Debug)]
pub struct Opv2v {
    options: Options,
    /// What was chosen of scenes.
    crews: Mutex<BTreeMap<u32, Arc<AgentRoster>>>,
    /// What stands in for pictures in scenes that have none at all, if others have; known after the
    /// preflight.
    of_others: OnceLock<Option<StandIns>>,
}

impl Opv2v {
    /// OPV2V with what HEAL and CoBEVT add.
    #[must_use]
    pub fn for_heal(options: Opv2vOptions) -> Self {
        Self::new(Variant::Opv2v, options)
    }

    /// V2X-Real, where all RSUs are agents.
    #[must_use]
    pub fn v2x_real(shared: SharedOptions) -> Self {
        Self::new(Variant::V2xReal, Opv2vOptions { shared, all_rsus: false })
    }

    fn new(variant: Variant, options: Opv2vOptions) -> Self {
        let options = Options::new(variant, options);
        Self { options, crews: Mutex::default(), of_others: OnceLock::new() }
    }

    /// The agents of a scene that are exported; looked up once.
    fn roster(&self, scene: &SceneSource) -> Result<Arc<AgentRoster>, ExportError> {
        let held = |crews: &Mutex<BTreeMap<u32, Arc<AgentRoster>>>| {
            crews.lock().unwrap_or_else(PoisonError::into_inner).get(&scene.number()).cloned()
        };
        if let Some(roster) = held(&self.crews) {
            return Ok(roster);
        }
        let roster = Arc::new(AgentRoster::of(scene, &self.options)?);
        let mut crews = self.crews.lock().unwrap_or_else(PoisonError::into_inner);
        crews.insert(scene.number(), Arc::clone(&roster));
        Ok(roster)
    }

    /// What stands in for a member's pictures: HEAL opens four of every agent, whatever it uses of them, as
    /// soon as one of them has some.
    fn stand_ins(&self, roster: &AgentRoster, member: &Member) -> Option<StandIns> {
        if member.cameras.is_some() || self.options.variant != Variant::Opv2v {
            return None;
        }
        roster.stand_ins().or_else(|| self.of_others.get().copied().flatten())
    }

    /// What the first scene that has pictures has: of those that are wanted, else of the others of the store,
    /// so that the same is made whether an export grows scene by scene or not.
    fn stand_ins_of_others(&self, source: &Source) -> Result<Option<StandIns>, ExportError> {
        if self.options.variant != Variant::Opv2v {
            return Ok(None);
        }
        for scene in &source.scenes {
            let found = self.roster(scene)?.stand_ins();
            if found.is_some() {
                return Ok(found);
            }
        }
        for scene in source.other_scenes(&self.needs())? {
            match AgentRoster::of(&scene?, &self.options).map(|roster| roster.stand_ins()) {
                Ok(Some(found)) => return Ok(Some(found)),
                // Nobody of it can be exported.
                Ok(None) | Err(ExportError::Refused(_)) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(None)
    }
}

impl Layout for Opv2v {
    fn name(&self) -> &'static str {
        match self.options.variant {
            Variant::Opv2v => "opv2v",
            Variant::V2xReal => "v2x-real",
        }
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!(self.options)
    }

    fn by_option(&self) -> BTreeMap<String, String> {
        by_option(&self.options.chosen)
    }

    /// HEAL replaces words wherever they are in a path.
    fn caution(&self, dest: &Path) -> Option<String> {
        let dest = std::path::absolute(dest).unwrap_or_default().display().to_string();
        let word =
            REPLACED.iter().find(|word| self.options.variant == Variant::Opv2v && dest.contains(**word))?;
        Some(format!(
            "{dest}: HEAL replaces `{word}` in whole paths: read it from a folder without that word"
        ))
    }

    /// 10 a second, as its loaders count delays.
    fn every_n_frames(&self) -> u32 {
        2
    }

    fn needs(&self) -> Vec<&'static str> {
        vec![LOG_STAGE, LidarRow::STAGE, ValidBoxRow::STAGE]
    }

    fn preflight(&self, source: &Source) -> Result<Vec<Omission>, ExportError> {
        let variant = self.options.variant;
        if variant == Variant::V2xReal
            && let Some(class) =
                self.options.shared().classes.iter().find(|class| vehicles::type_of(**class).is_none())
        {
            return Err(ExportError::Refused(format!("V2X-Real has no type for the class {}", class.name())));
        }
        let of_others = self.stand_ins_of_others(source)?;
        self.of_others.get_or_init(|| of_others);
        let mut omissions = BTreeSet::new();
        let mut sizes: BTreeMap<[u32; 2], String> = BTreeMap::new();
        for scene in &source.scenes {
            if variant == Variant::Opv2v && !scene.has_vector_map()? {
                let why = if scene.is_imported() { NO_MAP } else { NO_LINES };
                omissions.insert(Omission::new(format!("bev_lane on {}", scene.info().map), why));
            }
            let roster = self.roster(scene)?;
            omissions.extend(roster.omissions.iter().cloned());
            if roster.every_n_frames > scene.every_n_frames() {
                let (n, wanted) = (roster.every_n_frames, scene.every_n_frames());
                let why = format!("lidars and boxes of all agents go together at every {n}. frame only");
                omissions.insert(Omission::new(format!("frames between, of every {wanted}."), why));
            }
            for member in &roster.members {
                omissions.extend(unplaced(scene, member, variant)?);
                if self.stand_ins(&roster, member).is_some() {
                    let what = format!("pictures of {} are black", member.agent);
                    omissions.insert(Omission::note(
                        what,
                        "it has no four cameras, and HEAL opens four of every agent",
                    ));
                }
                for camera in member.cameras.iter().flatten() {
                    let whose = || format!("scene {} {}", scene.number(), member.agent);
                    sizes.entry(camera.size_px()).or_insert_with(whose);
                }
                if variant == Variant::Opv2v && !scene.has_arrays(&BEV_MASKS, member.agent) {
                    omissions.insert(Omission::new("bev_static", "bev-gt has made no masks"));
                }
            }
        }
        omissions.extend(self.about_pictures(source, &sizes)?);
        omissions.insert(Omission::new(
            "boxes that the agent has no lidar point of, and its own",
            "lists have what an agent sees",
        ));
        let listed: Vec<&str> = self.options.shared().classes.iter().map(|class| class.name()).collect();
        let why = format!("listed are {}: see --classes", listed.join(", "));
        omissions.insert(Omission::new("boxes of other classes", why));
        Ok(omissions.into_iter().collect())
    }

    fn cost(&self, scene: &SceneSource, unit: UnitName) -> Result<Cost, ExportError> {
        let roster = self.roster(scene)?;
        let Some(member) = unit.agent.and_then(|agent| roster.member(agent)) else {
            return Ok(Cost::default());
        };
        let frames = roster.frames(scene).count() as u64;
        let per_frame = unit::cost(scene, member, self.options.variant);
        let all = |of_one: f64| of_one * frames as f64;
        Ok(Cost { agent_frames: frames, bytes: all(per_frame[0]) as u64, cpu_s: all(per_frame[1]) })
    }

    fn of_others(&self, scene: &SceneSource, unit: UnitName) -> Result<Option<String>, ExportError> {
        let roster = self.roster(scene)?;
        // Pictures of its own scene follow from that.
        if roster.stand_ins().is_some() {
            return Ok(None);
        }
        let member = unit.agent.and_then(|agent| roster.member(agent));
        let stand_ins = member.and_then(|member| self.stand_ins(&roster, member));
        Ok(stand_ins.map(|stand_ins| format!("stand-ins {}", serde_json::json!(stand_ins))))
    }

    fn write_piece(
        &self,
        scene: &SceneSource,
        unit: UnitName,
        _piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError> {
        let roster = self.roster(scene)?;
        let Some(member) = unit.agent.and_then(|agent| roster.member(agent)) else { return Ok(Vec::new()) };
        let stand_ins = self.stand_ins(&roster, member);
        unit::write(scene, &roster, (member, stand_ins), &self.options, files)
    }

    fn finish(
        &self,
        _source: &Source,
        units: &[(UnitName, Vec<u8>)],
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        finish::write(self.options.variant, units, files)
    }
}

impl Opv2v {
    /// What of the pictures cannot be as the loaders know them.
    fn about_pictures(
        &self,
        source: &Source,
        sizes: &BTreeMap<[u32; 2], String>,
    ) -> Result<Vec<Omission>, ExportError> {
        let mut found = Vec::new();
        let told = |([width, height], whose): (&[u32; 2], &String)| format!("{width} x {height} of {whose}");
        match sizes.iter().map(told).collect::<Vec<_>>().as_slice() {
            // Black ones stand in for all.
            [] if self.of_others.get().copied().flatten().is_some() => {}
            [] if !has_color(source)? => {
                found.push(Omission::note("there are no camera pictures", "the store has none"));
            }
            [] => found.push(Omission::new("camera pictures", "no agent has four color cameras that are wanted")),
            [_] if sizes.contains_key(&[800, 600]) => {}
            [size] => found.push(Omission::note(
                format!("pictures are {size}, not 800 x 600"),
                "the store has them so; hypes/adapt_hypes.py says it to HEAL, and configs/rigs/opv2v.toml is the original rig",
            )),
            several => {
                return Err(ExportError::Refused(format!(
                    "loaders take pictures of one size, the store has {}: choose by --agents or --scenes, or leave cameras out by --sensors LIDAR",
                    several.join(", ")
                )));
            }
        }
        if self.options.variant == Variant::Opv2v
            && let Err(why) = RoadChannel::read(&source.store)?
        {
            found.push(Omission::new("bev_static", why));
        }
        Ok(found)
    }
}

/// Whether some agent has a color camera, wanted or not.
fn has_color(source: &Source) -> Result<bool, ExportError> {
    for scene in &source.scenes {
        for agent in scene.agents() {
            let is_color = |sensor: &SensorEntry| sensor.kind == SensorKind::Image(ImageKind::Rgb);
            if sensors_of(scene.reader(), *agent)?.iter().any(is_color) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// An agent's sensors that the layout has no place for.
fn unplaced(scene: &SceneSource, member: &Member, variant: Variant) -> Result<Vec<Omission>, ExportError> {
    let chosen: Vec<&str> =
        member.cameras.iter().flatten().filter_map(|camera| camera.color.camera()).collect();
    // Where an agent has no four cameras that is told, with its reason.
    let is_spare = |sensor: &SensorEntry| {
        !chosen.is_empty() && sensor.camera().is_some_and(|camera| !chosen.contains(&camera))
    };
    let what = |sensor: &SensorEntry| match sensor.kind {
        SensorKind::Lidar => None,
        SensorKind::Image(ImageKind::Depth) if variant == Variant::V2xReal => Some("depth images".into()),
        SensorKind::Image(ImageKind::Rgb | ImageKind::Depth) => is_spare(sensor).then(|| sensor.name.clone()),
        SensorKind::Image(kind) => Some(kind.spec().plural.to_owned()),
        SensorKind::SemanticLidar => Some("semantic lidars".into()),
        SensorKind::Radar => Some("radars".into()),
        SensorKind::Gnss => Some("GNSS".into()),
        SensorKind::Imu => Some("IMU".into()),
    };
    let sensors = scene.sensors(member.agent)?;
    let names = sensors.iter().filter_map(what);
    Ok(names.map(|name| Omission::new(name, "the layout has no place for them")).collect())
}
