//! The keys that say what happens in a scene.

use crate::{
    AgentSettings, GivenStart, HazardSettings, LightSettings, ModelSettings, SceneCount, SceneryRules,
    SpawnMode, Split, TimingSettings, TrafficSettings, WalkerSettings, WeatherSettings, WorldSettings,
};
use frames::deg;
use schema::tables::Weather;

use crate::reader::Section;

const DRAWN_PER_DRIVER: &str = "drawn per driver";

/// How many scenes on which map, and which of them are drawn anew.
pub(crate) fn scenes(root: &Section<'_>) -> (Vec<SceneCount>, Vec<(u32, u32)>) {
    let section = root.section("scenes", "how many scenes on which map");
    let mut scenes = Vec::new();
    for split in Split::ALL {
        let doc = format!("scenes of the {} split; keys are map names", split.name());
        let counts = section.section(split.name(), &doc).free_integers(
            "\"MAP\"",
            0,
            100_000,
            "scenes on a map: one of our towns (`convoy/03`), the path of a `.xodr` or `.xodr.gz` file, or the stem of one \
             in the maps folder",
        );
        scenes.extend(counts.into_iter().map(|(map, count)| SceneCount { split, map, count: count as u32 }));
    }
    if scenes.iter().all(|s| s.count == 0) {
        root.fault_at(
            "scenes",
            "no scenes: add a table such as [scenes.train] with \"convoy/demo\" = 2".into(),
        );
    }
    (scenes, redraw(&section))
}

fn redraw(scenes: &Section<'_>) -> Vec<(u32, u32)> {
    let section = scenes.section(
        "redraw",
        "scenes to replace by other ones of the same split and map; keys are scene numbers",
    );
    let doc =
        "which further draw of the scene is meant: each number gives another scene, 0 the first one again";
    let draws = section.free_integers("\"SCENE\"", 0, u32::MAX.into(), doc);
    let read = |(key, draw): (String, i64)| match key.parse::<u32>() {
        Ok(scene) => Some((scene, draw as u32)),
        Err(_) => {
            section.fault_at(&key, format!("`{}`: `{key}` is no scene number", section.path()));
            None
        }
    };
    draws.into_iter().filter_map(read).collect()
}

pub(crate) fn models(s: &Section<'_>) -> ModelSettings {
    let packs = s.texts(
        "packs",
        &[],
        "folders with glTF models (docs/packs.md), below the maps folder or from where the program runs",
    );
    for (i, pack) in packs.iter().enumerate() {
        if pack.is_empty() || packs[..i].contains(pack) {
            let problem = if pack.is_empty() { "is empty" } else { "is named twice" };
            s.fault_at("packs", format!("`models.packs`: folder `{pack}` {problem}"));
        }
    }
    ModelSettings { packs }
}

/// `all_known`: there are no models but the built-in ones.
pub(crate) fn agents(s: &Section<'_>, all_known: bool) -> AgentSettings {
    let d = AgentSettings::default();
    let settings = AgentSettings {
        min_vehicles: s.integer(
            "min_vehicles",
            d.min_vehicles.into(),
            1,
            1000,
            "fewest data-collection vehicles in a scene",
        ) as u32,
        max_vehicles: s.integer(
            "max_vehicles",
            d.max_vehicles.into(),
            1,
            1000,
            "most data-collection vehicles in a scene: the first one decides where a scene takes place",
        ) as u32,
        spawn_mode: s.choice(
            "spawn_mode",
            &[
                ("clustered", SpawnMode::Clustered),
                ("chained", SpawnMode::Chained),
                ("both", SpawnMode::Both),
            ],
            2,
            "vehicles around a pivot, each near another, or a coin flip per scene",
        ),
        clustered_spawn_distance_m: metres(
            s,
            "clustered_spawn_distance_m",
            d.clustered_spawn_distance_m,
            "spacing of a cluster, m",
        ),
        chained_spawn_distance_m: metres(
            s,
            "chained_spawn_distance_m",
            d.chained_spawn_distance_m,
            "reach of a link of a chain, m",
        ),
        min_rsus: count(s, "min_rsus", d.min_rsus, "fewest RSUs in a scene"),
        max_rsus: count(
            s,
            "max_rsus",
            d.max_rsus,
            "most RSUs in a scene (signalised junctions near the start limit them)",
        ),
        vehicle_models: s.texts(
            "vehicle_models",
            &d.vehicle_models,
            "models of the data-collection vehicles, taken in turn",
        ),
        vehicle_colors: s.colors("vehicle_colors", &d.vehicle_colors, "their colours, taken in turn"),
        spawn_separation_m: s.number(
            "spawn_separation_m",
            d.spawn_separation_m,
            2.0,
            1000.0,
            "spacing of the spawn points along lanes, m",
        ),
        starts: starts(s),
        penetration: s.optional_number(
            "penetration",
            "min_vehicles to max_vehicles collect data",
            0.0,
            1.0,
            "share of a scene's vehicles that collect data (at least one does); `traffic.vehicles` counts all of them",
        ),
    };
    ordered(s, "min_vehicles", settings.min_vehicles, "max_vehicles", settings.max_vehicles);
    ordered(s, "min_rsus", settings.min_rsus, "max_rsus", settings.max_rsus);
    for model in &settings.vehicle_models {
        if all_known && schema::models::find(model).is_none_or(|m| m.wheelbase_m <= 0.0) {
            s.fault_at("vehicle_models", format!("`agents.vehicle_models`: no vehicle model `{model}`"));
        }
    }
    if settings.vehicle_models.is_empty() || settings.vehicle_colors.is_empty() {
        s.fault_at(
            "vehicle_models",
            "`agents.vehicle_models` and `agents.vehicle_colors` must not be empty".into(),
        );
    }
    settings
}

fn starts(s: &Section<'_>) -> Vec<GivenStart> {
    let read = |item: &Section<'_>| GivenStart {
        map: item.text("map", "convoy/demo", "name of the map, as in `scenes`"),
        xyz_m: item.triple(
            "xyz_m",
            [0.0; 3],
            "position in the world, m: the nearest driving lane that runs its way",
        ),
        yaw_rad: deg(item.number(
            "yaw_deg",
            0.0,
            -360.0,
            360.0,
            "heading, degrees from east, counter-clockwise",
        )),
    };
    read(&s.describe_item("starts"));
    let doc = "where data-collection vehicles may start, instead of the map's spawn points";
    let list = s.sections("starts", "the map's spawn points", doc);
    list.unwrap_or_default().iter().map(read).collect()
}

fn ordered(s: &Section<'_>, low: &str, low_value: u32, high: &str, high_value: u32) {
    if low_value > high_value {
        let (low_path, high_path) = (s.path_of(low), s.path_of(high));
        s.fault_at(low, format!("`{low_path}` is {low_value}, more than `{high_path}` ({high_value})"));
    }
}

fn count(s: &Section<'_>, key: &str, default: u32, doc: &str) -> u32 {
    s.integer(key, default.into(), 0, 1000, doc) as u32
}

fn metres(s: &Section<'_>, key: &str, default: f64, doc: &str) -> f64 {
    s.number(key, default, 0.1, 100_000.0, doc)
}

fn share(s: &Section<'_>, key: &str, default: f64, doc: &str) -> f64 {
    s.number(key, default, 0.0, 1.0, doc)
}

pub(crate) fn timing(s: &Section<'_>) -> TimingSettings {
    let d = TimingSettings::default();
    let settings = TimingSettings {
        warmup_s: s.number("warmup_s", d.warmup_s, 0.0, 600.0, "simulated before frame 0, s"),
        min_duration_s: s.number("min_duration_s", d.min_duration_s, 1.0, 3600.0, "shortest scene, s"),
        max_duration_s: s.number("max_duration_s", d.max_duration_s, 1.0, 3600.0, "longest scene, s"),
    };
    if settings.min_duration_s > settings.max_duration_s {
        s.fault_at("min_duration_s", "`timing.min_duration_s` is more than `timing.max_duration_s`".into());
    }
    settings
}

pub(crate) fn traffic(s: &Section<'_>) -> TrafficSettings {
    let d = TrafficSettings::default();
    TrafficSettings {
        vehicles: s
            .optional_integer(
                "vehicles",
                "drawn from the free spawn points",
                0,
                20_000,
                "background vehicles in a scene",
            )
            .map(|n| n as u32),
        speed_difference: s.optional_number(
            "speed_difference",
            DRAWN_PER_DRIVER,
            -2.0,
            0.95,
            "speed below the limit as a share of it (negative: faster), for every driver",
        ),
        standstill_gap_m: s.optional_number(
            "standstill_gap_m",
            DRAWN_PER_DRIVER,
            0.0,
            50.0,
            "gap to a standing leader, m; nobody comes nearer than 0.5",
        ),
        green_time_s: s.optional_number(
            "green_time_s",
            "drawn per signal, 4 to 28",
            1.0,
            600.0,
            "green time of every signal, s",
        ),
        yellow_time_s: s.number("yellow_time_s", d.yellow_time_s, 0.5, 10.0, "yellow time, s"),
        all_red_time_s: s.number(
            "all_red_time_s",
            d.all_red_time_s,
            0.0,
            20.0,
            "all-red time between two greens, s",
        ),
        moving_start: s.flag(
            "moving_start",
            d.moving_start,
            "traffic is under way when the simulation begins, each vehicle at its speed, rather than at rest",
        ),
        signal_offsets: s.flag(
            "signal_offsets",
            d.signal_offsets,
            "the lights of each junction begin their cycle at a drawn time before the simulation, rather than all with it",
        ),
        reckless_agent: share(
            s,
            "reckless_agent",
            d.reckless_agent,
            "share of data-collection drivers who see no lights, signs, vehicles, walkers",
        ),
        reckless_background: share(
            s,
            "reckless_background",
            d.reckless_background,
            "the same for background drivers",
        ),
        distracted_agent: share(
            s,
            "distracted_agent",
            d.distracted_agent,
            "share of the other data-collection drivers who see no lights and signs",
        ),
        distracted_background: share(
            s,
            "distracted_background",
            d.distracted_background,
            "the same for background drivers",
        ),
        ignore_lights: share(
            s,
            "ignore_lights",
            d.ignore_lights,
            "chance that a driver overlooks a light in a step of 50 ms: it then drives on for the step, but passes no line, and still sees what asks for hard braking, until it has overlooked lights for 1 s on end; at 1 it sees none",
        ),
        ignore_signs: share(
            s,
            "ignore_signs",
            d.ignore_signs,
            "the same for signs, lines without lights, and cones, barriers and all else that lies in road works",
        ),
        ignore_vehicles: share(s, "ignore_vehicles", d.ignore_vehicles, "the same for other vehicles"),
        ignore_walkers: share(s, "ignore_walkers", d.ignore_walkers, "the same for walkers"),
        emergency_lights: share(
            s,
            "emergency_lights",
            d.emergency_lights,
            "chance that an emergency vehicle in traffic has its lights flashing",
        ),
        door_open: share(
            s,
            "door_open",
            d.door_open,
            "chance that a background vehicle opens a door when it comes to a stop",
        ),
        articulated_lorries: share(
            s,
            "articulated_lorries",
            d.articulated_lorries,
            "chance that a background vehicle is a tractor unit with a semi-trailer, where the way on is wide enough for one",
        ),
        articulated_buses: share(
            s,
            "articulated_buses",
            d.articulated_buses,
            "chance that a bus in the background is an articulated one, there",
        ),
        spawn_radius_m: s.optional_number(
            "spawn_radius_m",
            "from the duration",
            10.0,
            20_000.0,
            "background actors start within this distance of a data-collection vehicle, m",
        ),
        active_distance_m: s.number(
            "active_distance_m",
            d.active_distance_m,
            1.0,
            100_000.0,
            "background actors farther than this from every data-collection vehicle stand still, on any map, m",
        ),
    }
}

pub(crate) fn walkers(s: &Section<'_>) -> WalkerSettings {
    let d = WalkerSettings::default();
    WalkerSettings {
        count: s
            .optional_integer("count", "drawn from 0 to max_count", 0, 20_000, "walkers in a scene")
            .map(|n| n as u32),
        max_count: s.integer("max_count", d.max_count.into(), 0, 20_000, "most walkers when drawn") as u32,
        min_speed_mps: s.number("min_speed_mps", d.min_speed_mps, 0.1, 5.0, "slowest walking speed, m/s"),
        cross_factor: s.optional_number(
            "cross_factor",
            "drawn per scene",
            0.0,
            1.0,
            "share of walkers who may cross roads anywhere",
        ),
        wheelchair: s.number("wheelchair", d.wheelchair, 0.0, 1.0, "share of walkers who use a wheelchair"),
        in_groups: share(s, "in_groups", d.in_groups, "share of walkers who walk in groups of two or three"),
        waiting: share(
            s,
            "waiting",
            d.waiting,
            "share of the others who stand and wait when the scene begins: at crossings, benches (where most sit), buildings; twice that share of groups stands and talks",
        ),
    }
}

pub(crate) fn weather(s: &Section<'_>) -> WeatherSettings {
    let d = WeatherSettings::default();
    WeatherSettings {
        dynamic: s.flag("dynamic", d.dynamic, "draw a final weather and move towards it over the scene"),
        initial: overrides(
            &s.section("initial", "fixed values of the initial weather; the others are drawn"),
        ),
        r#final: overrides(&s.section("final", "fixed values of the final weather; the others are drawn")),
    }
}

fn overrides(s: &Section<'_>) -> Vec<(String, f64)> {
    let read = |&name: &&'static str| {
        let (min, max) = match name {
            "sun_azimuth_deg" => (0.0, 360.0),
            "sun_altitude_deg" => (-90.0, 90.0),
            "fog_distance_m" => (0.0, 100_000.0),
            "fog_falloff" => (0.0, 100.0),
            "scattering_intensity" | "mie_scattering_scale" | "rayleigh_scattering_scale" => (0.0, 10.0),
            _ => (0.0, 100.0),
        };
        let value = s.optional_number(name, "drawn", min, max, "see the frames table in schema.md")?;
        Some((name.to_owned(), value))
    };
    Weather::NAMES.iter().filter_map(read).collect()
}

pub(crate) fn lights(s: &Section<'_>) -> LightSettings {
    let d = LightSettings::default();
    LightSettings {
        street_lamp_failure: share(
            s,
            "street_lamp_failure",
            d.street_lamp_failure,
            "share of street lamps that have failed",
        ),
        change_intensity: s.flag(
            "change_intensity",
            d.change_intensity,
            "change the flux of all street lamps of a dark scene by a common amount",
        ),
        intensity_change_lm: s.optional_number(
            "intensity_change_lm",
            "drawn per scene",
            -1e9,
            1e9,
            "that amount, lm (negative: darker); drawn within the nominal 20000 lm either way",
        ),
        min_intensity_lm: s.number(
            "min_intensity_lm",
            d.min_intensity_lm,
            0.0,
            1e9,
            "no change takes a street lamp below this flux, lm",
        ),
        random_building_colors: s.flag(
            "random_building_colors",
            d.random_building_colors,
            "in a dark scene each building's windows have a colour of their own (not on high ground)",
        ),
        street_lamps_off: s.flag("street_lamps_off", d.street_lamps_off, "street lamps never burn"),
        buildings_off: s.flag("buildings_off", d.buildings_off, "windows are never lit"),
    }
}

pub(crate) fn hazards(s: &Section<'_>) -> HazardSettings {
    let d = HazardSettings::default();
    HazardSettings {
        share: share(
            s,
            "share",
            d.share,
            "share of the spawn points around the vehicles at which a hazard is tried",
        ),
        accident_share: share(
            s,
            "accident_share",
            d.accident_share,
            "chance that a hazard is an accident, not road works",
        ),
        emergency_share: share(
            s,
            "emergency_share",
            d.emergency_share,
            "chance that an emergency vehicle stands at an accident",
        ),
        missing_cone_share: share(
            s,
            "missing_cone_share",
            d.missing_cone_share,
            "chance that a cone beside an accident or road works is missing",
        ),
    }
}

pub(crate) fn world(s: &Section<'_>) -> WorldSettings {
    let d = WorldSettings::default();
    let rules = d.scenery;
    WorldSettings {
        scenery: SceneryRules {
            seed: s.integer(
                "seed",
                rules.seed as i64,
                0,
                i64::MAX,
                "seed of what is built beside the roads: scenes share it, whatever the dataset's seed is",
            ) as u64,
            building_density: share(
                s,
                "building_density",
                rules.building_density,
                "share of free frontage with buildings",
            ),
            tree_density: share(s, "tree_density", rules.tree_density, "share of free frontage with trees"),
            lamp_spacing_m: s.number(
                "lamp_spacing_m",
                rules.lamp_spacing_m,
                5.0,
                1000.0,
                "distance between street lamps along a sidewalk, m",
            ),
            parked_share: share(
                s,
                "parked_share",
                rules.parked_share,
                "share of parking spaces that are taken",
            ),
        },
        radius_m: s.number(
            "radius_m",
            d.radius_m,
            50.0,
            5000.0,
            "the static world is there within this distance of every agent at every frame, m (more where boxes or grids reach farther); nothing is seen beyond",
        ),
    }
}
