//! A finished scene.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use scene::{
    ArrayReader, BoxFrames, SceneError, SceneReader, SensorEntry, SensorFrames, sensors_of, unknown_columns,
};
use schema::AgentId;
use schema::arrays::ArrayKind;
use schema::scene_info::{LOG_STAGE, SceneInfo};
use schema::table::{Framed, Row};
use schema::tables::{AgentRow, CameraRow, ValidBoxRow, VectorMapRow};
use store::{Scope, Store, hash_bytes, keys};

use crate::{ExportError, Selection};

/// A scene that is exported.
#[derive(Clone, Debug)]
pub struct SceneSource {
    reader: SceneReader,
    info: SceneInfo,
    agents: Vec<AgentId>,
    selection: Selection,
    digest: String,
    /// The wanted sensors of the agents that were asked for: planning, estimating and writing ask again and
    /// again.
    sensors: Arc<Mutex<BTreeMap<AgentId, Vec<SensorEntry>>>>,
}

impl SceneSource {
    /// Opens a scene; the stage that is missing, if one of those needed is.
    pub(crate) fn open(
        store: &Store,
        scene: u32,
        selection: &Selection,
        stages: &[&str],
        needs: &[&'static str],
    ) -> Result<Result<Self, &'static str>, ExportError> {
        let mut manifests = Vec::new();
        for stage in stages {
            manifests.extend(store.manifest(Scope::Scene(scene), stage)?);
        }
        if let Some(missing) = needs.iter().find(|need| manifests.iter().all(|m| m.stage != **need)) {
            return Ok(Err(missing));
        }
        let digests: Vec<String> = manifests.iter().map(store::Manifest::digest).collect();
        let digest = hash_bytes(digests.concat().as_bytes());
        let reader = SceneReader::new(store, scene, manifests);
        let (info, all) = (reader.info()?, reader.agents()?);
        let agents: Vec<AgentId> = all.iter().copied().filter(|agent| selection.has_agent(*agent)).collect();
        if agents.is_empty() {
            let has: Vec<String> = all.iter().map(ToString::to_string).collect();
            return Err(ExportError::Refused(format!(
                "--agents {}: scene {scene} has none of them; it has {}",
                selection.agents.join(","),
                has.join(", ")
            )));
        }
        Ok(Ok(Self { reader, info, agents, selection: selection.clone(), digest, sensors: Arc::default() }))
    }

    /// Its number.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.info.scene
    }

    /// Its facts.
    #[must_use]
    pub fn info(&self) -> &SceneInfo {
        &self.info
    }

    /// The wanted agents: vehicles, then RSUs.
    #[must_use]
    pub fn agents(&self) -> &[AgentId] {
        &self.agents
    }

    /// What of the store is wanted.
    #[must_use]
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// The wanted frames.
    pub fn frames(&self) -> impl Iterator<Item = u32> + use<> {
        self.selection.frames(self.info.frames)
    }

    /// Frames 0, n, 2 n, ... are wanted.
    #[must_use]
    pub fn every_n_frames(&self) -> u32 {
        self.selection.every_n_frames.max(1)
    }

    /// How many frames are wanted.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        schema::rate::count(self.info.frames, self.selection.every_n_frames)
    }

    /// Digest of what its stages have made.
    #[must_use]
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Whether the store has its map: that of an imported scene has none.
    ///
    /// # Errors
    /// The plan cannot be read.
    pub fn has_map(&self) -> Result<bool, ExportError> {
        self.has_planned(&[keys::map(&self.info.map), keys::vector_map(&self.info.map)])
    }

    /// Whether the store has the lines and polygons of its map.
    ///
    /// # Errors
    /// The plan cannot be read.
    pub fn has_vector_map(&self) -> Result<bool, ExportError> {
        self.has_planned(&[keys::vector_map(&self.info.map)])
    }

    /// Whether some files stand in the store's plan.
    fn has_planned(&self, keys: &[String]) -> Result<bool, ExportError> {
        let plan = self.reader.store().manifest(Scope::Plan, VectorMapRow::STAGE)?;
        Ok(plan.is_some_and(|plan| keys.iter().all(|key| plan.output(key).is_some())))
    }

    /// Whether it was imported from another layout.
    #[must_use]
    pub fn is_imported(&self) -> bool {
        self.reader.manifest(LOG_STAGE).is_ok_and(|log| schema::is_imported(&log.code_version))
    }

    /// Its reader, for tables and archives that have no function here.
    #[must_use]
    pub fn reader(&self) -> &SceneReader {
        &self.reader
    }

    /// Whether a stage has made its part.
    #[must_use]
    pub fn has(&self, stage: &'static str) -> bool {
        self.reader.manifest(stage).is_ok()
    }

    /// Whether an agent has arrays of a kind.
    #[must_use]
    pub fn has_arrays(&self, kind: &ArrayKind, agent: AgentId) -> bool {
        let key = keys::array(self.number(), kind, agent);
        self.reader.manifest(kind.stage).is_ok_and(|manifest| manifest.output(&key).is_some())
    }

    /// Where the wanted agents are: a list for each, by frame (all frames of the scene).
    ///
    /// # Errors
    /// The table cannot be read, or has other rows than one for each agent and frame.
    pub fn agent_rows(&self) -> Result<Vec<Vec<AgentRow>>, ExportError> {
        let rows: Vec<AgentRow> = self.reader.rows()?;
        let mut by_agent = Vec::with_capacity(self.agents.len());
        for agent in &self.agents {
            let name = agent.to_string();
            let own: Vec<AgentRow> = rows.iter().filter(|row| row.agent == name).cloned().collect();
            if own.len() != self.info.frames as usize {
                let path = self.reader.location(&format!("{}.parquet", AgentRow::TABLE));
                let (found, frames) = (own.len(), self.info.frames);
                return Err(SceneError::Rows { path, found, agents: 1, frames }.into());
            }
            by_agent.push(own);
        }
        Ok(by_agent)
    }

    /// The wanted sensors of an agent, by name.
    ///
    /// # Errors
    /// Their stage has not made its part, or a table cannot be read.
    pub fn sensors(&self, agent: AgentId) -> Result<Vec<SensorEntry>, ExportError> {
        let known = || self.sensors.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(sensors) = known().get(&agent) {
            return Ok(sensors.clone());
        }
        let mut sensors = sensors_of(&self.reader, agent)?;
        sensors.retain(|sensor| self.selection.has_sensor(&sensor.name));
        known().insert(agent, sensors.clone());
        Ok(sensors)
    }

    /// Columns of a sensor's table that are no readings: zeros, because the dataset that was imported did not
    /// say them.
    ///
    /// # Errors
    /// As [`unknown_columns`].
    pub fn unknown_columns(
        &self,
        agent: AgentId,
        sensor: &SensorEntry,
    ) -> Result<BTreeSet<String>, ExportError> {
        if !self.is_imported() {
            return Ok(BTreeSet::new());
        }
        Ok(unknown_columns(&self.reader, agent, &sensor.name)?)
    }

    /// A sensor's readings.
    ///
    /// # Errors
    /// As [`SensorFrames::open`].
    pub fn readings<R: Row + Framed>(
        &self,
        agent: AgentId,
        sensor: &SensorEntry,
    ) -> Result<SensorFrames<R>, ExportError> {
        let rate = (self.info.frames, sensor.about.every_n_frames);
        Ok(SensorFrames::open(&self.reader, agent, &sensor.name, rate)?)
    }

    /// An agent's boxes, with what its sensors saw of them if that is known.
    ///
    /// # Errors
    /// As [`BoxFrames::open`].
    pub fn boxes(&self, agent: AgentId) -> Result<BoxFrames, ExportError> {
        Ok(BoxFrames::open(&self.reader, agent, self.has(ValidBoxRow::STAGE))?)
    }

    /// The boxes of all agents of the scene, wanted or not, likewise.
    ///
    /// # Errors
    /// As [`BoxFrames::open`].
    pub fn boxes_of_all(&self) -> Result<BoxFrames, ExportError> {
        Ok(BoxFrames::open_all(&self.reader, self.has(ValidBoxRow::STAGE))?)
    }

    /// An agent's arrays of a kind.
    ///
    /// # Errors
    /// As [`ArrayReader::open`].
    pub fn arrays(&self, kind: &ArrayKind, agent: AgentId) -> Result<ArrayReader, ExportError> {
        Ok(ArrayReader::open(&self.reader, kind, agent, codecs::DEFAULT_MAX_BYTES)?)
    }

    /// Bytes that an agent's wanted sensors take in the store.
    ///
    /// # Errors
    /// As [`SceneSource::sensors`].
    pub fn sensor_bytes(&self, agent: AgentId) -> Result<u64, ExportError> {
        if !self.has(CameraRow::STAGE) {
            return Ok(0);
        }
        Ok(self.sensors(agent)?.iter().map(|sensor| sensor.bytes).sum())
    }
}
