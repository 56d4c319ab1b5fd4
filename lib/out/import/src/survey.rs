//! What a dataset holds, scene by scene, before anything is written.

use std::collections::BTreeSet;
use std::path::Path;

use frames::{Agent, Pose, World};
use rayon::prelude::*;
use schema::AgentId;
use schema::tables::{PlanAgentRow, PlanSceneRow, Weather};
use settings::Split;
use store::hash_bytes;

use crate::error::{ImportError, SourceFault};
use crate::folder::Folder;
use crate::infos::{Entry, Infos, Scene};
use crate::names::{FILLED_VOXELS, MASKS, VOXELS};
use crate::rig::Rigs;
use crate::{arrays, cast, facts, sensors};

/// Most bytes of the configuration of a scene.
const MAX_CONFIG_BYTES: u64 = 4 << 20;
/// Size of a cell of the published masks, m.
const PUBLISHED_CELL_M: f64 = 0.4;

/// A dataset that may be imported.
#[derive(Debug)]
pub struct Source {
    pub(crate) folder: Folder,
    pub(crate) infos: Infos,
    pub(crate) rigs: Rigs,
}

impl Source {
    /// Looks through the infos of a dataset: the folder `simbev2x`, or that which holds it.
    ///
    /// # Errors
    /// It is none, or its infos are broken.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let folder = Folder::open(path)?;
        let infos = Infos::open(&folder)?;
        let rigs = Rigs::of(&infos.metadata)
            .map_err(|problem| ImportError::source(&infos.metadata_path, problem))?;
        Ok(Self { folder, infos, rigs })
    }

    /// Numbers of its scenes, ascending.
    pub fn scenes(&self) -> impl Iterator<Item = u32> + '_ {
        self.infos.entries.iter().map(|entry| entry.number)
    }

    /// Where it is.
    #[must_use]
    pub fn root(&self) -> &Path {
        self.folder.root()
    }

    /// Digest of what is said of all sensors.
    pub(crate) fn digest(&self) -> String {
        hash_bytes(&self.infos.metadata_text)
    }
}

/// What is known of a scene from the infos and the headers of some files.
#[derive(Clone, Debug)]
pub struct SceneSurvey {
    /// Its number.
    pub number: u32,
    /// Its split.
    pub split: Split,
    /// Frames, 20 a second.
    pub frames: u32,
    /// Its agents, each with the keys of its files.
    pub agents: Vec<(AgentId, BTreeSet<String>)>,
    /// Whether post-processing has been done.
    pub is_processed: bool,
    /// Digest of all that infos say of it.
    pub(crate) digest: String,
    /// Cells of its masks along a side, where it has some, and their size, m.
    pub(crate) bev_cells: Option<u32>,
    pub(crate) bev_cell_m: f64,
    pub(crate) plan: PlanSceneRow,
    pub(crate) plan_agents: Vec<PlanAgentRow>,
}

/// A scene with its survey, or why there is none.
pub(crate) type Surveyed = (u32, Result<SceneSurvey, ImportError>);

impl Source {
    /// Looks through some scenes.
    pub(crate) fn survey(&self, wanted: impl Fn(u32) -> bool + Sync) -> Vec<Surveyed> {
        let entries: Vec<&Entry> = self.infos.entries.iter().filter(|entry| wanted(entry.number)).collect();
        entries.into_par_iter().map(|entry| (entry.number, self.survey_of(entry))).collect()
    }

    fn survey_of(&self, entry: &Entry) -> Result<SceneSurvey, ImportError> {
        let text = entry.text()?;
        let scene = entry.read(&text)?;
        let place = |e: ImportError| e.within(format!("scene {}", entry.number));
        let wrong = |problem: SourceFault| place(ImportError::source(entry.path(), problem));
        let info = facts::scene_info(entry, &scene, None).map_err(wrong)?;
        let mut digest = self.infos.metadata_text.clone();
        digest.extend_from_slice(&text);
        let weather = |named: &std::collections::BTreeMap<String, f64>| {
            Weather::from_array(Weather::NAMES.map(|name| named.get(name).copied().unwrap_or(0.0)))
        };
        let keys = |(agent, records): &(AgentId, Vec<crate::infos::Record>)| {
            let known = sensors::of_agent(*agent, &records[0]).into_iter().map(|(key, _)| key);
            let arrays = [MASKS, VOXELS, FILLED_VOXELS].map(str::to_owned).into_iter();
            let arrays = arrays.filter(|key| records[0].files.contains_key(key));
            (*agent, known.chain(arrays).collect())
        };
        Ok(SceneSurvey {
            number: entry.number,
            split: entry.split,
            frames: scene.frames(),
            agents: scene.agents.iter().map(keys).collect(),
            is_processed: cast::is_processed(&scene),
            digest: hash_bytes(&digest),
            bev_cells: self.bev_cells(&scene).map_err(place)?,
            bev_cell_m: self.bev_cell_m(&scene),
            plan: PlanSceneRow {
                scene: entry.number,
                split: info.split.clone(),
                map: info.map.clone(),
                seed: info.seed,
                duration_s: info.duration_s,
                frames: info.frames,
                dynamic_weather: info.dynamic_weather,
                initial_weather: weather(&info.initial_weather),
                final_weather: weather(&info.final_weather),
                background_vehicles: i32::try_from(info.n_vehicles).ok(),
                walkers: info.n_walkers,
                walker_cross_factor: info.walker_cross_factor,
                street_light_change_lm: info.street_light_intensity_change_lm,
                hazard_attempts: info.n_hazard_attempts,
                pivot_xyz_m: info.pivot_xyz_m,
                ..PlanSceneRow::default()
            },
            plan_agents: scene.agents.iter().map(|agent| plan_agent(entry.number, &scene, agent)).collect(),
        })
    }

    fn bev_cells(&self, scene: &Scene) -> Result<Option<u32>, ImportError> {
        let first = scene.agents.iter().find_map(|(_, records)| records[0].files.get(MASKS));
        let Some(said) = first else { return Ok(None) };
        let path = self.folder.find(said)?;
        let shape = arrays::mask_shape(&path).map_err(|problem| ImportError::source(&path, problem))?;
        Ok(Some(shape[1] as u32))
    }

    /// Size of a cell of the masks: it stands in the scene's configuration alone.
    fn bev_cell_m(&self, scene: &Scene) -> f64 {
        let said = scene.info.get("config").and_then(crate::value::Value::text);
        let text = said.and_then(|said| self.folder.read(said, MAX_CONFIG_BYTES).ok());
        let found = text.and_then(|(_, text)| cell_of(&String::from_utf8_lossy(&text)));
        found.unwrap_or(PUBLISHED_CELL_M)
    }

    /// An entry by its number.
    pub(crate) fn entry(&self, number: u32) -> Option<&Entry> {
        let entries = &self.infos.entries;
        entries.binary_search_by_key(&number, |entry| entry.number).ok().map(|place| &entries[place])
    }
}

/// The size of a cell in a configuration: `bev_res` of the original's, `cell_m` below `bev` of ours.
fn cell_of(text: &str) -> Option<f64> {
    let mut block = "";
    for line in text.lines() {
        let Some((key, value)) = line.split_once(':') else { continue };
        if !line.starts_with([' ', '-', '#']) {
            block = key;
        }
        if key.trim() == "bev_res" || (block == "bev" && key.trim() == "cell_m") {
            return value.trim().parse().ok().filter(|size: &f64| size.is_finite() && *size > 0.0);
        }
    }
    None
}

fn plan_agent(
    number: u32,
    scene: &Scene,
    (agent, records): &(AgentId, Vec<crate::infos::Record>),
) -> PlanAgentRow {
    let said = scene.info.get(&agent.to_string());
    let flag =
        |key: &str| said.and_then(|said| said.get(key)).and_then(crate::value::Value::flag).unwrap_or(false);
    let model =
        said.and_then(|said| said.get("vehicle")).and_then(crate::value::Value::text).unwrap_or_default();
    let pose = Pose::<World, Agent>::from_xyz_wxyz(records[0].xyz_m, records[0].quaternion);
    PlanAgentRow {
        scene: number,
        agent: *agent,
        model: model.strip_prefix("vehicle.").unwrap_or(model).to_owned(),
        xyz_m: records[0].xyz_m,
        rpy_rad: pose.rpy(),
        reckless: flag("reckless_ego"),
        distracted: flag("distracted_ego"),
        ..PlanAgentRow::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_cell_stands_in_either_configuration() {
        assert_eq!(cell_of("a: 1\nbev_dim: 400\nbev_res: 0.5\n"), Some(0.5));
        assert_eq!(cell_of("bev:\n  cells: 200\n  cell_m: 0.8\nother:\n  cell_m: 3\n"), Some(0.8));
        assert_eq!(cell_of("other:\n  cell_m: 3\nbev:\n  cells: 2\n"), None);
        assert_eq!((cell_of("bev_res: -1"), cell_of("bev_res: x"), cell_of("")), (None, None, None));
    }
}
