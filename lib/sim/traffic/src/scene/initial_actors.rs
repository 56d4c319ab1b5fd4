//! The actors that a scene begins with, drawn and numbered.

use nalgebra::Point3;
use random::Stream;
use schema::tables::{ActorRow, PlanAgentRow};
use schema::{ActorRole, AgentKind};

use crate::error::TrafficError;
use crate::given::GivenActors;
use crate::hazards::Hazards;
use crate::input::SceneInput;
use crate::road::net::Net;
use crate::scene::placing::ActorIds;
use crate::scene::spawn::{Start, vehicle_starts};
use crate::walking::paths::Paths;

/// The actors of a scene before they have bodies.
pub(crate) struct InitialActors<'a> {
    pub(crate) given: GivenActors,
    pub(crate) starts: Vec<Start>,
    pub(crate) rsus: Vec<&'a PlanAgentRow>,
    pub(crate) hazards: Hazards,
    /// Where agents start.
    pub(crate) agents: Vec<Point3<f64>>,
    /// Number, sidewalk and place on it of each walker.
    pub(crate) walkers: Vec<(usize, usize, f64)>,
    pub(crate) ids: ActorIds,
}

impl<'a> InitialActors<'a> {
    /// Draws them; the scene begins at `first_frame`.
    ///
    /// # Errors
    /// The plan cannot be followed, or ids run out.
    pub(crate) fn draw(
        input: &'a SceneInput<'a>,
        first_frame: i32,
        fixed: &[ActorRow],
        net: &Net,
        paths: &Paths,
    ) -> Result<Self, TrafficError> {
        let scene = input.scene;
        let given = GivenActors::new(input)?;
        let frames = first_frame..scene.frames as i32;
        let (starts, hazards) = vehicle_starts(input, fixed, net, (&given, frames))?;
        let own = starts.iter().filter(|s| s.role != ActorRole::Background).map(|s| s.point);
        let own: Vec<Point3<f64>> = own.collect();
        let driven = own.len();
        let agents = [given.agents_at(first_frame), own].concat();
        let rsus: Vec<_> = input.agents.iter().filter(|a| a.agent.kind == AgentKind::Rsu).collect();
        let walkers = paths.draw_starts(scene.walkers, &agents, scene.spawn_radius_m, &|i| {
            Stream::new(scene.seed, u64::from(scene.scene), "traffic/walker/place", i)
        });
        let background = starts.len() - driven;
        let towed = starts.iter().filter(|start| start.towed.is_some()).count();
        let counts = [driven, rsus.len(), background, walkers.len(), hazards.things.len(), towed];
        let ids = ActorIds::new(input, counts, given.counts())?;
        Ok(Self { given, starts, rsus, hazards, agents, walkers, ids })
    }

    /// Rows of the objects in hazards.
    pub(crate) fn hazard_actors(&self) -> Vec<ActorRow> {
        let things = self.ids.hazards.iter().zip(&self.hazards.things);
        things.map(|(id, thing)| thing.actor(*id)).collect()
    }
}
