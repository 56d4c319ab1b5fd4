//! The log's tables, indexed by frame.

use std::thread;

use frames::{Agent, Pose, World};
use schema::AgentId;
use schema::scene_info::SceneInfo;
use schema::table::{Framed, Row};
use schema::tables::{ActorRow, AgentRow, FrameRow, LampRow, SignalRow, StateRow};
use store::aside;

use crate::{FrameRanges, SceneError, SceneReader};

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
    ranges: FrameRanges,
}

impl<T: Row + Framed> ByFrame<T> {
    fn read(scene: &SceneReader, frames: u32) -> Result<Self, SceneError> {
        let rows: Vec<T> = scene.rows()?;
        match FrameRanges::new(&rows, -1, frames.saturating_add(1)) {
            Ok(ranges) => Ok(Self { rows, ranges }),
            Err(row) => Err(SceneError::Order {
                path: scene.location(&format!("{}.parquet", T::TABLE)),
                row,
                frame: rows.get(row).map_or(0, Framed::frame),
            }),
        }
    }

    fn at(&self, frame: i64) -> &[T] {
        &self.rows[self.ranges.of(frame)]
    }
}

impl SceneLog {
    /// Reads the log of a scene.
    ///
    /// # Errors
    /// A shard of the log is missing or broken.
    pub fn read(scene: &SceneReader) -> Result<Self, SceneError> {
        let info = scene.info()?;
        let frames = info.frames;
        let agents = scene.agents_of(&info)?;
        // Tables are read side by side: each one is a question to a bucket.
        let (agent_rows, frame_rows, actors, lamps, states, signals) = thread::scope(|scope| {
            let agent_rows = aside(scope, || scene.rows::<AgentRow>());
            let frame_rows = aside(scope, || scene.rows::<FrameRow>());
            let actors = aside(scope, || scene.rows());
            let lamps = aside(scope, || scene.rows());
            let states = aside(scope, || ByFrame::read(scene, frames));
            let signals = ByFrame::read(scene, frames);
            (agent_rows.join(), frame_rows.join(), actors.join(), lamps.join(), states.join(), signals)
        });
        let (agent_rows, frame_rows) = (agent_rows?, frame_rows?);
        let table = |name: &str, found: usize, agents: usize| {
            let path = scene.location(&format!("{name}.parquet"));
            if found == agents * frames as usize {
                Ok(())
            } else {
                Err(SceneError::Rows { path, found, agents, frames })
            }
        };
        table(AgentRow::TABLE, agent_rows.len(), agents.len())?;
        table(FrameRow::TABLE, frame_rows.len(), 1)?;
        Ok(Self {
            actors: actors?,
            lamps: lamps?,
            frames: frame_rows,
            agent_rows,
            agents,
            states: states?,
            signals: signals?,
            info,
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
    pub fn agent_rows(&self, position: usize) -> impl Iterator<Item = &AgentRow> {
        (0..self.info.frames).map(move |frame| self.agent(position, frame))
    }

    /// An agent's pose at a frame.
    #[must_use]
    pub fn world_from_agent(&self, position: usize, frame: u32) -> Pose<World, Agent> {
        let row = self.agent(position, frame);
        Pose::from_xyz_wxyz(row.xyz_m, row.quaternion)
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
