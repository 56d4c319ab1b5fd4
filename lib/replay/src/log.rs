//! The log's tables, indexed by frame.

use std::ops::Range;

use frames::{Agent, Pose, World};
use pipeline::{At, Job, Place, StageError, StageSettings};
use schema::AgentId;
use schema::scene_info::SceneInfo;
use schema::tables::{ActorRow, AgentRow, FrameRow, LampRow, SignalRow, StateRow};
use store::{Manifest, Store, StoreError, keys};

use crate::ReplayError;

/// The stage that writes the log.
pub const SIMULATE: &str = "simulate-and-log";

/// A scene's log.
#[derive(Clone, Debug)]
pub struct SceneLog {
    /// Facts that are no table.
    pub info: SceneInfo,
    /// All objects, by id.
    pub actors: Vec<ActorRow>,
    /// Street lamps and windows.
    pub lamps: Vec<LampRow>,
    /// Time and weather, by frame.
    pub frames: Vec<FrameRow>,
    /// Agents, by frame, each frame in the order of [`SceneLog::agent_ids`].
    agent_rows: Vec<AgentRow>,
    agents: Vec<AgentId>,
    states: ByFrame<StateRow>,
    signals: ByFrame<SignalRow>,
}

/// Rows of frames -1, 0, 1, ... in one list.
#[derive(Clone, Debug)]
struct ByFrame<T> {
    rows: Vec<T>,
    ranges: Vec<Range<usize>>,
}

impl<T> ByFrame<T> {
    /// Rows must be sorted by frame.
    fn new(rows: Vec<T>, frames: u32, frame_of: impl Fn(&T) -> i32) -> Self {
        let mut ranges = Vec::with_capacity(frames as usize + 1);
        let mut start = 0;
        for frame in -1..i64::from(frames) {
            let end = start + rows[start..].iter().take_while(|r| i64::from(frame_of(r)) <= frame).count();
            ranges.push(start..end);
            start = end;
        }
        Self { rows, ranges }
    }

    fn at(&self, frame: i64) -> &[T] {
        usize::try_from(frame + 1)
            .ok()
            .and_then(|i| self.ranges.get(i))
            .map_or(&[], |r| &self.rows[r.clone()])
    }
}

impl SceneLog {
    /// Reads the log of a job's scene.
    ///
    /// # Errors
    /// A shard of the log is missing or broken.
    pub fn read<S: StageSettings>(job: &Job<'_, S>) -> Result<Self, StageError> {
        Self::load(job.store(), job.input(SIMULATE)?, job.scene())
    }

    /// Reads the log of a scene that a manifest of [`SIMULATE`] describes.
    ///
    /// # Errors
    /// A shard of the log is missing or broken.
    pub fn load(store: &Store, manifest: &Manifest, scene: u32) -> Result<Self, StageError> {
        let key = |name: &str| keys::scene(scene, name);
        let info_key = key("log/scene.json");
        let info: SceneInfo = store
            .read_json(&info_key)?
            .ok_or_else(|| StoreError::Missing { path: store.location(&info_key) })?;
        let frames = info.frames;
        let agent_rows: Vec<AgentRow> = store.read_rows(manifest, &key("agents.parquet"))?;
        let agents: Vec<AgentId> = info
            .agents
            .iter()
            .map(|a| a.agent.parse())
            .collect::<Result<_, _>>()
            .at(|| Place::file(store.location(&info_key)))?;
        if agent_rows.len() != agents.len() * frames as usize {
            let wrong = ReplayError::Rows { found: agent_rows.len(), agents: agents.len(), frames };
            return Err(wrong).at(|| Place::file(store.location(&key("agents.parquet"))));
        }
        Ok(Self {
            info,
            actors: store.read_rows(manifest, &key("log/actors.parquet"))?,
            lamps: store.read_rows(manifest, &key("log/lamps.parquet"))?,
            frames: store.read_rows(manifest, &key("log/frames.parquet"))?,
            agent_rows,
            agents,
            states: ByFrame::new(
                store.read_rows(manifest, &key("log/states.parquet"))?,
                frames,
                |r: &StateRow| r.frame,
            ),
            signals: ByFrame::new(
                store.read_rows(manifest, &key("log/signals.parquet"))?,
                frames,
                |r: &SignalRow| r.frame,
            ),
        })
    }

    /// Number of frames.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.info.frames
    }

    /// The agents: vehicles, then RSUs.
    #[must_use]
    pub fn agent_ids(&self) -> &[AgentId] {
        &self.agents
    }

    /// An agent's row of a frame, by the agent's position in [`SceneLog::agent_ids`].
    #[must_use]
    pub fn agent(&self, position: usize, frame: u32) -> &AgentRow {
        &self.agent_rows[frame as usize * self.agents.len() + position]
    }

    /// All rows of an agent, by frame.
    #[must_use]
    pub fn agent_rows(&self, position: usize) -> Vec<AgentRow> {
        (0..self.info.frames).map(|frame| self.agent(position, frame).clone()).collect()
    }

    /// An agent's pose at a frame.
    #[must_use]
    pub fn world_from_agent(&self, position: usize, frame: u32) -> Pose<World, Agent> {
        let row = self.agent(position, frame);
        Pose::from_xyz_wxyz(row.xyz_m, row.quaternion)
    }

    /// An agent's pose one period before a frame; an RSU's never changes.
    #[must_use]
    pub fn previous_world_from_agent(&self, position: usize, frame: u32) -> Pose<World, Agent> {
        if frame > 0 {
            return self.world_from_agent(position, frame - 1);
        }
        let now = self.agent(position, frame);
        self.states_at(-1).iter().find(|s| s.id == now.id).map_or_else(
            || self.world_from_agent(position, frame),
            |s| Pose::from_xyz_wxyz(s.xyz_m, s.quaternion),
        )
    }

    /// States of the moving objects at a frame, from -1, by id.
    #[must_use]
    pub fn states_at(&self, frame: i64) -> &[StateRow] {
        self.states.at(frame)
    }

    /// States of the traffic lights at a frame, from -1, by id.
    #[must_use]
    pub fn signals_at(&self, frame: i64) -> &[SignalRow] {
        self.signals.at(frame)
    }
}
