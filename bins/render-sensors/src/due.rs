//! Which tables of a scene are to be made: those that an earlier run made from the same settings are kept.

use std::collections::{BTreeMap, BTreeSet};

use runner::{Job, MadeFrom, Place, Stage, StageError, StageSettings};
use schema::{AgentId, ImageKind};
use settings::stages::SensorSettings;
use store::{Finished, Output, Unit, keys};

/// The unit of an agent, with what its shards depend on.
pub(crate) struct AgentTables<'u> {
    pub(crate) unit: Unit<'u>,
    /// By key; of this agent alone.
    made_from: MadeFrom,
}

/// Key of an agent's counts.
pub(crate) fn counts_key(scene: u32, agent: AgentId) -> String {
    keys::partial_stats(scene, &format!("{}.{agent}", Stage::<SensorSettings>::NAME))
}

impl<'u> AgentTables<'u> {
    /// Opens the units of those agents that no run has finished, and keeps their shards that can be kept.
    ///
    /// # Errors
    /// A signal came, or the store cannot be read.
    pub(crate) fn open(
        job: &'u Job<'_, SensorSettings>,
        agents: &[AgentId],
    ) -> Result<Vec<(usize, AgentId, Self)>, StageError> {
        let mut open = Vec::new();
        for (position, &agent) in agents.iter().enumerate() {
            let Some(mut unit) = job.unit(&agent.to_string())? else { continue };
            let made_from = job.settings().made_from(job.scene(), &[agent])?;
            let mut kept = 0;
            for (key, digest) in &made_from {
                kept += usize::from(unit.keep(key, digest)?);
            }
            if kept > 0 {
                let (scene, all) = (job.scene(), made_from.len());
                tracing::info!("scene {scene:04}: {kept} of {all} tables of {agent} are kept");
            }
            open.push((position, agent, Self { unit, made_from }));
        }
        Ok(open)
    }

    /// A shard that was kept.
    pub(crate) fn kept(&self, key: &str) -> Option<&Output> {
        self.unit.kept().iter().find(|output| output.key == key)
    }

    /// Names of the sensors' tables that are to be made.
    pub(crate) fn due(&self, scene: u32, agent: AgentId) -> BTreeSet<String> {
        let folder = keys::sensor(scene, agent, "");
        let folder = folder.trim_end_matches(".parquet");
        let due = self.made_from.keys().filter(|key| self.kept(key).is_none());
        let name = |key: &String| Some(key.strip_prefix(folder)?.strip_suffix(".parquet")?.to_owned());
        due.filter_map(name).collect()
    }

    /// What a shard depends on.
    ///
    /// # Errors
    /// Nobody has said it.
    pub(crate) fn made_from(&self, key: &str) -> Result<&str, StageError> {
        let unknown = || StageError::Failed {
            place: Box::new(Place::default()),
            source: UnknownTable(key.to_owned()).into(),
        };
        self.made_from.get(key).map(String::as_str).ok_or_else(unknown)
    }

    /// Counts a finished shard among the unit's.
    ///
    /// # Errors
    /// Nobody has said what it depends on.
    pub(crate) fn add(&mut self, shard: Finished, counts: BTreeMap<String, u64>) -> Result<(), StageError> {
        let made_from = self.made_from(&shard.output().key)?.to_owned();
        self.unit.add(shard.made_from(&made_from, counts));
        Ok(())
    }
}

/// A table whose settings nobody has told: it could neither be kept nor be known to be due.
#[derive(Debug, thiserror::Error)]
#[error("a bug in Convoy: SensorSettings::tables does not list {0} (please report it)")]
struct UnknownTable(String);

/// Whether any of some tables holds pictures in colour.
pub(crate) fn has_colour(due: &BTreeSet<String>) -> bool {
    let prefix = ImageKind::Rgb.table("");
    due.iter().any(|name| name.starts_with(&prefix))
}
