//! Data-collection vehicles and RSUs.

use frames::deg;
use schema::{AgentId, AgentKind};

use crate::key::{choice, settings, tables};
use crate::reader::Section;

choice! {
    /// How data-collection vehicles are spread.
    pub enum SpawnMode {
        /// Around a pivot.
        Clustered = "clustered",
        /// Each near one that is placed already.
        Chained = "chained",
        /// A coin flip per scene.
        #[default]
        Both = "both",
    }
}

settings! {
    /// A place where data-collection vehicles may start, given by the user.
    pub struct GivenStart {
        /// Name of the map, as in `scenes`.
        map: String = "convoy/demo".into();
        /// Position in the world, m: the nearest driving lane that runs its way.
        xyz_m: [f64; 3] = [0.0; 3];
        /// Heading from east, counter-clockwise.
        yaw_rad: f64 = deg(0.0), named("yaw_deg"), degrees(-360.0..=360.0);
    }
}

settings! {
    /// A place where an RSU stands, given by the user.
    pub struct GivenRsu {
        /// Name of the map, as in `scenes`.
        map: String = "convoy/demo".into();
        /// Foot of its pole in the world, m. It stands on the ground there, if that is at most 1 m above or
        /// 1.5 m below; else where it is written.
        xyz_m: [f64; 3] = [0.0; 3];
        /// Where it looks: heading from east, counter-clockwise.
        yaw_rad: f64 = deg(0.0), named("yaw_deg"), degrees(-360.0..=360.0);
    }
}

settings! {
    /// The route of a data-collection vehicle, given by the user: by points or by lanes.
    pub struct GivenRoute {
        /// Name of the map, as in `scenes`.
        map: String = "convoy/demo".into();
        /// Whose route it is: `vehicle_0`, ...
        agent: String = "vehicle_0".into();
        /// Points in the world, m, each on the nearest driving lane within 5 m: the vehicle starts at the
        /// first one and passes the others in their order.
        points_m: Vec<[f64; 3]> = Vec::new(), or("`lanes` say the route");
        /// Lanes in the world, each as `"road:lane"` by their OpenDRIVE ids: the vehicle starts in the
        /// middle of the first one and passes the others in their order.
        lanes: Vec<String> = Vec::new();
    }
    rule drivable;
}

fn drivable(s: &Section<'_>, read: &GivenRoute) {
    let (points, lanes) = (read.points_m.len(), read.lanes.len());
    if points > 0 && lanes > 0 {
        let problem = format!(
            "`{}` and `{}` both say the route: leave one out",
            s.path_of("points_m"),
            s.path_of("lanes")
        );
        s.fault_at_any(&["lanes", "points_m"], problem);
    } else if points + lanes < 2 && s.has_besides(&[]) {
        let problem = format!(
            "`{}`: a route has at least two points or two lanes, this one has {}",
            s.path(),
            points + lanes
        );
        s.fault_at_any(&["points_m", "lanes", "agent", "map"], problem);
    }
    for lane in read.lanes.iter().filter(|lane| GivenRoute::lane(lane).is_none()) {
        let path = s.path_of("lanes");
        s.fault_at("lanes", format!("`{path}`: `{lane}` is no lane: write \"road:lane\", such as \"12:-1\""));
    }
    if read.vehicle().is_none() {
        let path = s.path_of("agent");
        s.fault_at(
            "agent",
            format!("`{path}` is \"{}\", expected a vehicle such as \"vehicle_0\"", read.agent),
        );
    }
}

impl GivenRoute {
    /// The OpenDRIVE ids of a road and a lane on it.
    #[must_use]
    pub fn lane(written: &str) -> Option<(&str, i16)> {
        let (road, lane) = written.rsplit_once(':')?;
        Some((road, lane.parse().ok().filter(|lane| *lane != 0)?))
    }

    /// The vehicle whose route it is.
    #[must_use]
    pub fn vehicle(&self) -> Option<AgentId> {
        self.agent.parse().ok().filter(|id: &AgentId| id.kind == AgentKind::Vehicle)
    }
}

settings! {
    /// Data-collection vehicles and RSUs.
    pub struct AgentSettings {
        /// Fewest data-collection vehicles in a scene.
        min_vehicles: u32 = 2, within(1..=1000), yaml("min_vehicles");
        /// Most data-collection vehicles in a scene: the first one decides where a scene takes place.
        max_vehicles: u32 = 8, within(1..=1000), yaml("max_vehicles");
        /// Vehicles around a pivot, each near another, or a coin flip per scene.
        spawn_mode: SpawnMode = SpawnMode::Both, choice(), yaml("vehicle_spawn_mode");
        /// Spacing of a cluster, m.
        clustered_spawn_distance_m: f64 = 48.0, within(0.1..=100_000.0), yaml("clustered_spawn_distance");
        /// Reach of a link of a chain, m.
        chained_spawn_distance_m: f64 = 64.0, within(0.1..=100_000.0), yaml("chained_spawn_distance");
        /// Fewest RSUs in a scene.
        min_rsus: u32 = 0, within(0..=1000), yaml("min_rsus");
        /// Most RSUs in a scene (signalised junctions near the start limit them).
        max_rsus: u32 = 4, within(0..=1000), yaml("max_rsus");
        /// Models of the data-collection vehicles, taken in turn.
        vehicle_models: Vec<String> =
            ["car.coupe", "car.sedan", "car.hatchback", "car.sports"].map(String::from).to_vec();
        /// Their colours (sRGB), taken in turn.
        vehicle_colors: Vec<[u8; 3]> = vec![
            [0, 0, 0],
            [255, 0, 0],
            [0, 255, 0],
            [0, 0, 255],
            [255, 255, 0],
            [255, 0, 255],
            [0, 255, 255],
            [255, 255, 255],
        ];
        /// Spacing of the spawn points along lanes, m.
        spawn_separation_m: f64 = 24.0, within(2.0..=1000.0), yaml("spawn_point_separation_distance");
        /// Where data-collection vehicles may start, instead of the map's spawn points.
        starts: Vec<GivenStart> = Vec::new(), or("the map's spawn points"), by(tables);
        /// Where RSUs stand, in their order, before those at traffic lights; of a scene's RSUs, `min_rsus` to
        /// `max_rsus`, they are the first.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        rsus_at: Vec<GivenRsu> = Vec::new(), or("at traffic lights near the vehicles"), by(tables);
        /// Where data-collection vehicles drive, instead of anywhere.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        routes: Vec<GivenRoute> = Vec::new(), or("they turn as they like"), by(tables);
        /// Parquet file of actors' poses at 20 Hz (docs/trajectories.md), below the maps folder or from where
        /// the program runs: these actors go where it says, and all others keep off them.
        #[serde(skip_serializing_if = "Option::is_none")]
        trajectories: Option<String> = None, or("all actors move by themselves");
        /// Share of a scene's vehicles that collect data (at least one does); `traffic.vehicles` counts all
        /// of them, and `min_vehicles` and `max_vehicles` have no say.
        penetration: Option<f64> = None, within(0.0..=1.0), or("min_vehicles to max_vehicles collect data");
    }
    rule consistent;
}

/// Whether the models are known depends on the packs, which other keys name.
fn consistent(s: &Section<'_>, read: &AgentSettings) {
    in_order(s, ("min_vehicles", read.min_vehicles), ("max_vehicles", read.max_vehicles));
    in_order(s, ("min_rsus", read.min_rsus), ("max_rsus", read.max_rsus));
    if read.vehicle_models.is_empty() || read.vehicle_colors.is_empty() {
        s.fault_at(
            "vehicle_models",
            "`agents.vehicle_models` and `agents.vehicle_colors` must not be empty".into(),
        );
    }
}

fn in_order(s: &Section<'_>, (low, least): (&str, u32), (high, most): (&str, u32)) {
    if least > most {
        let (low_path, high_path) = (s.path_of(low), s.path_of(high));
        s.fault_at(low, format!("`{low_path}` is {least}, more than `{high_path}` ({most})"));
    }
}
