//! What a simulation takes and gives.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::ControlFlow;

use catalogue::Catalogue;
use nalgebra::Point3;
use opendrive::Map;
use schema::ObjectId;
use schema::scene_info::{DriverInfo, HazardInfo, SignalGroupInfo};
use schema::tables::{
    ActorRow, FrameRow, PlanAgentRow, PlanHazardRow, PlanRouteRow, PlanSceneRow, PlanTrajectoryRow,
    PlanWeatherRow, SignalRow, StateRow,
};
use schema::tile::TileIndex;
use settings::stages::SimulationSettings;

/// A scene to simulate.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use opendrive::Map;
/// use schema::AgentId;
/// use catalogue::Catalogue;
/// use settings::stages::SimulationSettings;
/// use schema::tables::{PlanAgentRow, PlanSceneRow};
/// use traffic::{SceneInput, simulate};
///
/// let town = town::generate(&town::named("convoy/demo").expect("a town of ours")).expect("roads");
/// let map = Map::new(town);
/// let start = map.point_at(map.spawn_points(24.0)[0]).expect("a place on a lane");
/// let agent = PlanAgentRow {
///     agent: AgentId::vehicle(0),
///     model: "car.sedan".into(),
///     xyz_m: start.position.into(),
///     rpy_rad: [0.0, 0.0, start.heading_rad],
///     ..PlanAgentRow::default()
/// };
/// let scene = PlanSceneRow {
///     frames: 20,
///     duration_s: 1.0,
///     background_vehicles: Some(12),
///     spawn_radius_m: 300.0,
///     spawn_separation_m: 24.0,
///     ..PlanSceneRow::default()
/// };
/// let input = SceneInput {
///     map: &map,
///     catalogue: Catalogue::built_in(),
///     scene: &scene,
///     agents: &[agent],
///     hazards: &[],
///     weather: &[],
///     routes: &[],
///     trajectories: &[],
///     settings: &SimulationSettings::default(),
///     fixed: &Vec::new(),
///     first_id: 1,
/// };
/// let log = simulate(&input, &mut |_, _| ControlFlow::Continue(()))?;
/// assert_eq!(log.frames.len(), 20);
/// // States begin a frame earlier, so that frame 0 has one before it.
/// assert_eq!(log.states.len(), 21 * log.actors.len());
/// # Ok::<(), traffic::TrafficError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SceneInput<'a> {
    /// The scene's map.
    pub map: &'a Map,
    /// The models that there are.
    pub catalogue: &'a Catalogue,
    /// The scene's plan.
    pub scene: &'a PlanSceneRow,
    /// Its agents: vehicles, then RSUs, each in the order of their numbers.
    pub agents: &'a [PlanAgentRow],
    /// Its accidents and road works.
    pub hazards: &'a [PlanHazardRow],
    /// Keyframes of its weather between its beginning and its end, by time.
    pub weather: &'a [PlanWeatherRow],
    /// Places on given routes of agents, by agent, in order.
    pub routes: &'a [PlanRouteRow],
    /// Actors on given trajectories, frame by frame: agents, then others.
    pub trajectories: &'a [PlanTrajectoryRow],
    /// The dataset's settings (traffic, walkers, lights, hazards).
    pub settings: &'a SimulationSettings,
    /// Objects that never move. Those of kind `traffic_light` with an `opendrive_id` get signal states; those
    /// of kind `parked` can be hit, and drivers keep clear of those that reach into a lane; people wait
    /// before buildings and benches.
    pub fixed: &'a dyn FixedWorld,
    /// Id of the first actor; the others follow.
    pub first_id: ObjectId,
}

/// What never moves, known as far as agents come.
pub trait FixedWorld: fmt::Debug + Sync {
    /// The objects of the tiles near some places that are not among those `seen`, which are then. To break
    /// ends the simulation.
    fn near(&self, places: &[Point3<f64>], seen: &mut BTreeSet<TileIndex>) -> ControlFlow<(), Vec<ActorRow>>;
}

/// A world that is known whole from the start.
impl FixedWorld for Vec<ActorRow> {
    fn near(&self, _: &[Point3<f64>], seen: &mut BTreeSet<TileIndex>) -> ControlFlow<(), Vec<ActorRow>> {
        ControlFlow::Continue(if seen.insert(TileIndex::default()) { self.clone() } else { Vec::new() })
    }
}

/// What happened in a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulationLog {
    /// Agent vehicles, RSUs, background vehicles, walkers, obstacles of hazards (fixed unless something hit
    /// it); ids ascend from the first one.
    pub actors: Vec<ActorRow>,
    /// Moving actors at frames -1 to the last, by frame, then id.
    pub states: Vec<StateRow>,
    /// Frames 0 to the last.
    pub frames: Vec<FrameRow>,
    /// Traffic lights that were near at any time, at frames -1 to the last, by frame, then id.
    pub signals: Vec<SignalRow>,
    /// Background vehicles that were placed.
    pub n_vehicles: u32,
    /// Walkers that were placed.
    pub n_walkers: u32,
    /// Reckless ones among the background drivers.
    pub n_reckless: u32,
    /// Distracted ones among the background drivers.
    pub n_distracted: u32,
    /// Accidents and road works that found room.
    pub hazards: Vec<HazardInfo>,
    /// The drivers of the background vehicles, by object id.
    pub drivers: Vec<DriverInfo>,
    /// The programs of the traffic lights.
    pub signal_groups: Vec<SignalGroupInfo>,
}
