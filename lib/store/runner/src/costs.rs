//! What scenes of a plan cost, by the forecast's rates.

use std::collections::{BTreeMap, BTreeSet};

use schema::AgentId;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use settings::DatasetSettings;
use store::{Manifest, Scope, Store, StoreError, keys};

use crate::editions::Editions;
use crate::forecast::{Work, work_by_stage, work_of_sensors};

/// Estimated work of each scene of a plan, by stage.
pub type PlannedWork = BTreeMap<u32, BTreeMap<&'static str, Work>>;

/// Work by scene and stage; the plan is read when it is asked for first.
#[derive(Default)]
pub(crate) struct Costs {
    scenes: Option<PlannedWork>,
    /// Agents of each scene, with its frames.
    agents: Option<BTreeMap<u32, Vec<(AgentId, u32)>>>,
}

impl Costs {
    /// By the forecast's rates; nothing where the plan's tables cannot be read.
    pub(crate) fn of(
        &mut self,
        store: &Store,
        plan: Option<&Manifest>,
        editions: &Editions,
        (scene, stage): (u32, &str),
    ) -> Work {
        let read = || plan.and_then(|plan| Self::read(store, plan, editions).ok()).unwrap_or_default();
        let scenes = self.scenes.get_or_insert_with(read);
        scenes.get(&scene).and_then(|stages| stages.get(stage).copied()).unwrap_or_default()
    }

    /// The same of some tables of sensors, by their keys.
    pub(crate) fn of_tables(
        &mut self,
        store: &Store,
        plan: Option<&Manifest>,
        settings: &DatasetSettings,
        (scene, tables): (u32, &BTreeSet<String>),
    ) -> Work {
        let read = || plan.and_then(|plan| Self::agents(store, plan).ok()).unwrap_or_default();
        let (rigs, mut all) = (settings.scenario.rigs(), Work::default());
        for &(agent, frames) in self.agents.get_or_insert_with(read).get(&scene).into_iter().flatten() {
            let is_wanted = |name: &str| tables.contains(&keys::sensor(scene, agent, name));
            all += work_of_sensors(&rigs.of(agent).of_tables(is_wanted), frames);
        }
        all
    }

    fn agents(store: &Store, plan: &Manifest) -> Result<BTreeMap<u32, Vec<(AgentId, u32)>>, StoreError> {
        let scenes: Vec<PlanSceneRow> = store.read_rows(plan, keys::PLAN_SCENES)?;
        let agents: Vec<PlanAgentRow> = store.read_rows(plan, keys::PLAN_AGENTS)?;
        let frames: BTreeMap<u32, u32> = scenes.iter().map(|row| (row.scene, row.frames)).collect();
        let mut found: BTreeMap<u32, Vec<(AgentId, u32)>> = BTreeMap::new();
        for agent in &agents {
            if let Some(frames) = frames.get(&agent.scene) {
                found.entry(agent.scene).or_default().push((agent.agent, *frames));
            }
        }
        Ok(found)
    }

    /// All of a plan.
    ///
    /// # Errors
    /// The plan's tables cannot be read.
    pub(crate) fn read(
        store: &Store,
        plan: &Manifest,
        editions: &Editions,
    ) -> Result<PlannedWork, StoreError> {
        let mut costs = PlannedWork::new();
        for (scene, agents) in Self::agents(store, plan)? {
            let (of_scene, settings) = (costs.entry(scene).or_default(), editions.of(Scope::Scene(scene)));
            for (agent, frames) in agents {
                for (stage, work) in work_by_stage(settings, agent, frames) {
                    *of_scene.entry(stage).or_default() += work;
                }
            }
        }
        Ok(costs)
    }
}
