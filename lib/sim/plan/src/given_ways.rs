//! The vehicles of a scene whose way a user gave: by a route, or by a trajectory.

use opendrive::Map;
use schema::AgentId;
use schema::tables::{PlanAgentRow, PlanRouteRow, PlanTrajectoryRow};
use settings::stages::PlanSettings;

use crate::PlanError;
use crate::pool::{SpawnPoint, SpawnPool};
use crate::roster::SceneSlot;
use crate::routes::{self, PlannedRoute};
use crate::scene::PlanSources;
use crate::tracks::{TrackScene, start_of};

/// Routes and trajectories of a scene.
pub(crate) struct GivenWays {
    routes: Vec<PlannedRoute>,
    /// Actor by actor, data-collection vehicles first.
    pub(crate) trajectories: Vec<Vec<PlanTrajectoryRow>>,
}

impl GivenWays {
    /// Those that the settings and their file have for a scene of so many frames.
    ///
    /// # Errors
    /// One of them cannot be followed, or they are not those of the first vehicles.
    pub(crate) fn new(
        settings: &PlanSettings,
        slot: &SceneSlot,
        map: &Map,
        pool: &SpawnPool,
        (sources, frames): (&PlanSources<'_>, u32),
    ) -> Result<Self, PlanError> {
        let here = settings.agents.routes.iter().filter(|route| route.map == slot.map);
        let mut routes: Vec<PlannedRoute> =
            here.map(|route| routes::resolve(map, route)).collect::<Result<_, _>>()?;
        routes.sort_by_key(|route| route.agent);
        let mut trajectories = Vec::new();
        if let Some(file) = &settings.agents.trajectories {
            let tracks = sources.tracks.get(file).map_or(&[][..], Vec::as_slice);
            let scene = TrackScene {
                file,
                scene: slot.scene,
                frames,
                map,
                pool,
                settings: &settings.agents,
                catalogue: sources.catalogue,
            };
            trajectories = scene.plan(tracks)?;
        }
        let ways = Self { routes, trajectories };
        let mut agents: Vec<AgentId> = ways.tracked().map(|(agent, _)| agent).collect();
        agents.extend(ways.routes.iter().map(|route| route.agent));
        agents.sort_unstable();
        let numbered = agents.iter().enumerate();
        match { numbered }.find(|(number, agent)| usize::from(agent.index) != *number) {
            Some((number, _)) => {
                let missing = AgentId::vehicle(number as u16);
                let given = agents.last().copied().unwrap_or(missing);
                Err(PlanError::NotFirst { scene: slot.scene, given, missing })
            }
            None => Ok(ways),
        }
    }

    /// The data-collection vehicles on trajectories.
    fn tracked(&self) -> impl Iterator<Item = (AgentId, &[PlanTrajectoryRow])> {
        self.trajectories.iter().filter_map(|rows| {
            let agent = rows.first()?.actor.parse().ok()?;
            Some((agent, rows.as_slice()))
        })
    }

    /// Where the vehicles start, in the order of their numbers.
    pub(crate) fn starts(&self) -> Vec<SpawnPoint> {
        let tracked = self.tracked().filter_map(|(agent, rows)| Some((agent, start_of(rows)?)));
        let mut starts: Vec<(AgentId, SpawnPoint)> = tracked.collect();
        starts.extend(self.routes.iter().map(|route| (route.agent, route.start)));
        starts.sort_by_key(|(agent, _)| *agent);
        starts.into_iter().map(|(_, start)| start).collect()
    }

    /// Gives vehicles the models that their trajectories name.
    pub(crate) fn own_models(&self, agents: &mut [PlanAgentRow]) {
        for (agent, rows) in self.tracked() {
            if let (Some(row), Some(first)) = (agents.iter_mut().find(|row| row.agent == agent), rows.first())
            {
                row.model.clone_from(&first.model);
            }
        }
    }

    /// Rows of the routes.
    pub(crate) fn route_rows(&self, map: &Map, scene: u32) -> Vec<PlanRouteRow> {
        self.routes.iter().flat_map(|route| route.rows(map, scene)).collect()
    }
}
