//! A scene that is looked at.

use arguments::viz::CommonArgs;
use export_core::{SceneSource, Selection, Source};
use pictures::GroundLine;
use rayon::prelude::*;
use schema::AgentId;
use schema::scene_info::LOG_STAGE;
use schema::tables::AgentRow;
use store::Store;

use crate::error::VizError;
use crate::feed::{AgentFrame, Feed, Rig, Wants};
use crate::ground::ground_of;

/// A scene, what is known of it as a whole, and where its agents are.
pub(crate) struct Session {
    pub(crate) source: SceneSource,
    pub(crate) ground: Vec<GroundLine>,
    /// Name of the dataset.
    pub(crate) dataset: String,
    rows: Vec<Vec<AgentRow>>,
}

impl Session {
    /// Opens a scene of a store; the first that is simulated where none is named.
    pub(crate) fn open(common: &CommonArgs, scene: Option<u32>) -> Result<Self, VizError> {
        let store = Store::open(&common.store)?;
        let selection = Selection { scenes: scene.map(|scene| vec![(scene, scene)]), ..Selection::default() };
        let opened = Source::open(&store, &selection, &[LOG_STAGE])?;
        let dataset = opened.dataset()?["config"]["name"].as_str().unwrap_or_default().to_owned();
        let unfinished = opened.unfinished;
        let source = opened.scenes.into_iter().next().ok_or_else(|| {
            let which = scene.map_or("no scene".to_owned(), |scene| format!("scene {scene} is not"));
            let missing = unfinished.values().next().map_or("", String::as_str);
            let place = store.location("");
            VizError::Refused(format!(
                "{which} simulated yet ({missing}): run `convoy run --store {place}` first"
            ))
        })?;
        let rows = source.agent_rows()?;
        let ground = ground_of(&source)?;
        Ok(Self { source, ground, dataset, rows })
    }

    /// Number of frames.
    pub(crate) fn frame_count(&self) -> u32 {
        self.source.info().frames
    }

    /// The agents that some patterns name; all where there is no pattern.
    pub(crate) fn agents(&self, patterns: &[String]) -> Result<Vec<(usize, AgentId)>, VizError> {
        let all = self.source.agents();
        for pattern in patterns {
            if !all.iter().any(|agent| export_core::matches(pattern, &agent.to_string())) {
                let there = all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
                let scene = self.source.number();
                let problem = format!("scene {scene} has no agent `{pattern}`; it has {there}");
                return Err(VizError::Refused(problem));
            }
        }
        let is_wanted = |agent: &AgentId| {
            patterns.is_empty() || patterns.iter().any(|p| export_core::matches(p, &agent.to_string()))
        };
        Ok(all.iter().copied().enumerate().filter(|(_, agent)| is_wanted(agent)).collect())
    }

    /// An agent by name, or the first one.
    pub(crate) fn agent(&self, name: Option<AgentId>) -> Result<(usize, AgentId), VizError> {
        let pattern: Vec<String> = name.iter().map(ToString::to_string).collect();
        let agents = self.agents(&pattern)?;
        agents.first().copied().ok_or_else(|| VizError::Refused("the scene has no agents".into()))
    }

    /// A frame that must be there.
    pub(crate) fn frame(&self, frame: u32) -> Result<u32, VizError> {
        let last = self.frame_count().saturating_sub(1);
        if frame > last {
            let scene = self.source.number();
            return Err(VizError::Refused(format!(
                "scene {scene} has no frame {frame}; it has frames 0 to {last}"
            )));
        }
        Ok(frame)
    }

    /// The frame in the middle at which as much is there as can be: one of every ten.
    pub(crate) fn middle_frame(&self) -> u32 {
        let middle = self.frame_count() / 2;
        middle - middle % 10
    }

    /// A feed of each of some agents.
    pub(crate) fn feeds(&self, wants: &[(AgentId, Wants)]) -> Result<Vec<Feed>, VizError> {
        let mut feeds = Vec::with_capacity(wants.len());
        for (position, agent) in self.source.agents().iter().copied().enumerate() {
            if let Some((_, wants)) = wants.iter().find(|(wanted, _)| *wanted == agent) {
                let rows = self.rows[position].clone();
                feeds.push(Feed::open(&self.source, (position, agent), rows, wants)?);
            }
        }
        Ok(feeds)
    }
}

/// Does something with what some agents have of each of some frames, in ascending order: as many frames at
/// once as there are threads, and no more in memory; what is made of them is handed over in order.
pub(crate) fn for_frames<T: Send>(
    feeds: &mut [Feed],
    frames: &[u32],
    make: impl Fn(u32, &[AgentFrame], &[Rig]) -> Result<T, VizError> + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), VizError>,
) -> Result<(), VizError> {
    let rigs: Vec<Rig> = feeds.iter().map(Feed::rig).collect();
    for batch in frames.chunks(rayon::current_num_threads().max(1)) {
        let mut read = Vec::with_capacity(batch.len());
        for &frame in batch {
            let agents: Result<Vec<AgentFrame>, VizError> = feeds.iter_mut().map(|f| f.at(frame)).collect();
            read.push((frame, agents?));
        }
        let made: Vec<(u32, Result<T, VizError>)> =
            read.into_par_iter().map(|(frame, agents)| (frame, make(frame, &agents, &rigs))).collect();
        for (frame, made) in made {
            take(frame, made?)?;
        }
    }
    Ok(())
}
