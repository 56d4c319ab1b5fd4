//! Why a dataset cannot be planned.

/// A fault of the settings or of a map that leaves no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The settings ask for scenes on a map that was not given.
    #[error(
        "map `{map}`: not found (known maps: {known}); put its .xodr file into the maps folder or correct the name"
    )]
    UnknownMap {
        /// Map name.
        map: String,
        /// Names of the maps there are.
        known: String,
    },
    /// A scene of a group or an edition that the settings lack.
    #[error("scene {scene}: no settings for group `{group}` of edition {edition}")]
    UnknownGroup {
        /// The scene.
        scene: u32,
        /// Its edition.
        edition: u32,
        /// Its group.
        group: String,
    },
    /// A map without lanes for motor traffic.
    #[error("map `{map}`: no driving lanes; vehicles need lanes of type `driving`")]
    NoDrivingLanes {
        /// Map name.
        map: String,
    },
    /// A map whose driving lanes offer no place to start.
    #[error(
        "map `{map}`: no spawn points outside junctions on its {lanes} driving lanes; use a map with longer or wider roads, or a smaller `spawn_separation_m`"
    )]
    NoSpawnPoints {
        /// Map name.
        map: String,
        /// Driving lanes it has.
        lanes: usize,
    },
    /// A start that the user gave is off the road.
    #[error(
        "agents.starts: map `{map}` has no driving lane outside junctions that runs its way within {reach_m} m of {xyz_m:?}"
    )]
    NoLaneThere {
        /// Map name.
        map: String,
        /// The start, metres.
        xyz_m: [f64; 3],
        /// How far away a lane may be, metres.
        reach_m: f64,
    },
    /// A track of a file that no actor can be on.
    #[error("{file} (agents.trajectories): {place}: {problem}")]
    Trajectory {
        /// The file, as it is written.
        file: String,
        /// Scene, actor and frame.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// A route that cannot be driven.
    #[error("agents.routes: the route of {agent} on map `{map}`: {problem}")]
    Route {
        /// Map name.
        map: String,
        /// Whose route it is.
        agent: String,
        /// What is wrong.
        problem: String,
    },
    /// A vehicle with a route and a trajectory, or two of one.
    #[error("scene {scene}: {agent} has two routes or trajectories: leave one out")]
    TwoWays {
        /// The scene.
        scene: u32,
        /// The vehicle.
        agent: schema::AgentId,
    },
    /// Vehicles with given ways are not the first ones.
    #[error(
        "scene {scene}: {given} has a route or a trajectory, and {missing} has none: those who have are the first vehicles, \
         numbered from 0"
    )]
    NotFirst {
        /// The scene.
        scene: u32,
        /// One that has.
        given: schema::AgentId,
        /// One that has not.
        missing: schema::AgentId,
    },
    /// A vehicle model that the catalogue does not have.
    #[error("agents.vehicle_models: `{model}` is no vehicle of the catalogue")]
    UnknownModel {
        /// The name.
        model: String,
    },
    /// A setting that no plan can follow.
    #[error("{setting}: {problem}")]
    BadSetting {
        /// Name of the setting.
        setting: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// More scenes than numbers.
    #[error("the settings ask for more than {limit} scenes")]
    TooManyScenes {
        /// Most scenes.
        limit: u32,
    },
}
