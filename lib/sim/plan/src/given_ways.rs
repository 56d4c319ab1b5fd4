//! The vehicles of a scene whose way a user gave: by a route, or by a trajectory.

use catalogue::Catalogue;
use nalgebra::Point3;
use opendrive::{LanePos, Map};
use schema::AgentId;
use schema::tables::{PlanAgentRow, PlanRouteRow, PlanTrajectoryRow};
use settings::stages::PlanSettings;

use crate::PlanError;
use crate::pool::{SpawnPoint, SpawnPool, TakenGround};
use crate::roster::SceneSlot;
use crate::routes::{self, PlannedRoute};
use crate::sources::PlanSources;
use crate::tracks::{TrackScene, start_of};

/// Routes begin at least so far from one another, metres.
const APART_M: f64 = 6.0;
/// Places of a trajectory on which nobody starts are this far apart, metres.
const KEPT_EVERY_M: f64 = 2.0;

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
        if let Some(pair) = agents.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(PlanError::TwoWays { scene: slot.scene, agent: pair[0] });
        }
        if let Some([one, other]) = ways.starts_together() {
            return Err(PlanError::Route {
                map: slot.map.clone(),
                agent: other.to_string(),
                problem: format!("begins where that of {one} does"),
            });
        }
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

    /// Two routes that begin at one place.
    fn starts_together(&self) -> Option<[AgentId; 2]> {
        let near = |a: &PlannedRoute, b: &PlannedRoute| (a.start.xyz_m - b.start.xyz_m).norm() < APART_M;
        let pairs = self.routes.iter().enumerate();
        let mut pairs = pairs.flat_map(|(i, a)| self.routes[i + 1..].iter().map(move |b| (a, b)));
        pairs.find(|(a, b)| near(a, b)).map(|(a, b)| [a.agent, b.agent])
    }

    /// The ground that vehicles on trajectories take at some time, with their size: nobody starts there.
    pub(crate) fn kept(&self, catalogue: &Catalogue) -> Vec<TakenGround> {
        let mut kept: Vec<TakenGround> = Vec::new();
        for rows in &self.trajectories {
            let Some(model) = rows.first().and_then(|row| catalogue.find(&row.model)) else { continue };
            if model.wheelbase_m <= 0.0 {
                continue;
            }
            let mut last: Option<Point3<f64>> = None;
            for row in rows {
                let xyz_m = Point3::from(row.xyz_m);
                if last.is_none_or(|last| (last - xyz_m).norm() > KEPT_EVERY_M) {
                    let pos = LanePos::default();
                    kept.push((SpawnPoint { pos, xyz_m, rpy_rad: row.rpy_rad }, model.size_m));
                    last = Some(xyz_m);
                }
            }
        }
        kept
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
