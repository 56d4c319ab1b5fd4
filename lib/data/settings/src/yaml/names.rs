//! The keys of a SimBEV2X configuration: our keys declare those that translate one by one.

use std::sync::LazyLock;

use schema::tables::Weather;

use crate::config_key::YamlName;
use crate::dataset::config_keys;

const NO_ENGINE: &str = "there is no game engine and no window";

/// Keys without an effect here, and why.
const WITHOUT_EFFECT: &[(&str, &str)] = &[
    ("replay_scene_config", "any stage runs again from the logs: run it with --scenes and --force"),
    ("simulate_physics", "vehicles are always simulated"),
    ("show_debug_telemetry", NO_ENGINE),
    ("host", NO_ENGINE),
    ("timeout", NO_ENGINE),
    ("resolution_x", NO_ENGINE),
    ("resolution_y", NO_ENGINE),
    ("show_display", NO_ENGINE),
    ("quality_level", NO_ENGINE),
    ("retries_on_error", NO_ENGINE),
    ("render_gpu", NO_ENGINE),
    ("max_io_workers", "--threads says how many threads work"),
    ("tile_stream_distance", "maps are loaded whole"),
    ("bev_camera_height", "masks are drawn from geometry, without a camera"),
    ("render_bev_camera_images", NO_ENGINE),
    ("spectator_height", NO_ENGINE),
    ("spectator_vehicle_index", NO_ENGINE),
    ("use_cityscapes_palette", "masks have no colours"),
    ("spawn_attempts", "walkers start where they can walk"),
];

/// Keys that need more than a new name (`special` translates them), and what becomes of them.
pub(super) const SPECIAL: &[(&str, &str)] = &[
    ("mode", "the store follows its configuration; `replace` makes `replacement_scene_config` count"),
    ("train_scene_config", "`scenes.train`"),
    ("val_scene_config", "`scenes.val`"),
    ("test_scene_config", "`scenes.test`"),
    ("replacement_scene_config", "`scenes.redraw`, each of them 1"),
    ("vehicle_list", "`agents.vehicle_models`, by the nearest body style"),
    ("vehicle_color_list", "`agents.vehicle_colors`"),
    ("use_scene_number_for_random_seed", "no effect: every scene has a seed, from its number"),
    ("random_seed_offset", "`seed`"),
    ("timestep", "no effect: a frame is 0.05 s"),
    (
        "dynamic_settings_adjustments",
        "False: `traffic.spawn_radius_m` is `npc_spawn_radius`, `bev.lane_radius_m` is `mapping_area_radius`",
    ),
    ("npc_spawn_radius", "`traffic.spawn_radius_m`, without `dynamic_settings_adjustments`"),
    ("mapping_area_radius", "`bev.lane_radius_m`, without `dynamic_settings_adjustments`"),
    ("actor_active_distance", "`traffic.active_distance_m`, without `dynamic_settings_adjustments`"),
    ("random_street_light_failure", "False: `lights.street_lamp_failure` is 0"),
    ("street_light_failure_percentage", "`lights.street_lamp_failure`, as a share"),
    ("initial_weather", "`weather.initial`"),
    ("final_weather", "`weather.final`"),
    ("data_collection_vehicle_spawn_points", "`agents.starts`, mirrored"),
    ("semantic_lidar_channels", "no effect: the semantic lidar has the rays of the lidar"),
    ("semantic_lidar_range", "no effect: as above"),
    ("semantic_lidar_properties", "no effect: as above"),
];

/// Keys within mappings that another key has a say in.
const PROPERTIES_ELSEWHERE: &[(&str, &str, &str)] = &[
    ("rgb_camera_properties", "fov", "no effect: `camera_fov` says it"),
    ("lidar_properties", "points_per_second", "`vehicle.lidar.columns`, points a frame and channel"),
    ("lidar_properties", "rotation_frequency", "no effect: one turn a frame"),
    ("radar_properties", "points_per_second", "`vehicle.radar.rays`, points a frame"),
];

/// What becomes of a key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Rule {
    /// The same value under our name.
    Same(String),
    /// Percent there, a share here: our key, and the share that it has by default.
    Percent(String, f64),
    /// It has no effect here, and why.
    Nothing(&'static str),
}

/// The names that our keys declare.
#[derive(Default)]
struct Names {
    /// At the top.
    plain: Vec<(&'static str, Rule)>,
    /// Those of the sensors of one kind of agent, without `rsu_`; ours follow `vehicle.` or `rsu.`.
    sensors: Vec<(String, String)>,
    /// Within `..._properties`: the mapping, its key, ours.
    properties: Vec<(&'static str, &'static str, String)>,
}

static NAMES: LazyLock<Names> = LazyLock::new(|| {
    let mut names = Names::default();
    // Further sensors have the keys of the first, which alone SimBEV2X knows.
    for key in config_keys().into_iter().filter(|key| !key.path.contains("[]")) {
        let of_sensor = key.path.strip_prefix("vehicle.").map(str::to_owned);
        let is_plain = of_sensor.is_none() && !key.path.starts_with("rsu.");
        for name in &key.yaml {
            match (*name, &of_sensor) {
                (YamlName::Same(name), None) if is_plain => {
                    names.plain.push((name, Rule::Same(key.path.clone())));
                }
                (YamlName::Percent(name), None) if is_plain => {
                    let usual = key.default.to_string().parse().unwrap_or_default();
                    names.plain.push((name, Rule::Percent(key.path.clone(), usual)));
                }
                (YamlName::Same(name), Some(ours)) => names.sensors.push((name.into(), ours.clone())),
                (YamlName::Camera(flag), Some(ours)) => {
                    names.sensors.push((format!("use_{flag}_camera"), ours.clone()));
                }
                (YamlName::In(mapping, name), Some(ours)) => {
                    names.properties.push((mapping, name, ours.clone()));
                }
                _ => {}
            }
        }
    }
    names.plain.extend(WITHOUT_EFFECT.iter().map(|&(key, why)| (key, Rule::Nothing(why))));
    names
});

/// Every key of a SimBEV2X configuration with what becomes of it, as text of a page. Those of sensors stand
/// for vehicles; with `rsu_` they are about RSUs.
#[must_use]
pub fn simbev2x_keys() -> Vec<(String, String)> {
    let plain = NAMES.plain.iter().map(|(key, rule)| {
        let what = match rule {
            Rule::Same(ours) => format!("`{ours}`"),
            Rule::Percent(ours, _) => format!("`{ours}`, as a share"),
            Rule::Nothing(why) => format!("no effect: {why}"),
        };
        ((*key).to_owned(), what)
    });
    let special = SPECIAL.iter().map(|(key, what)| ((*key).to_owned(), (*what).to_owned()));
    let sensors = NAMES.sensors.iter().map(|(key, ours)| (key.clone(), format!("`vehicle.{ours}`")));
    let properties = NAMES
        .properties
        .iter()
        .map(|(mapping, key, ours)| (format!("{mapping}.{key}"), format!("`vehicle.{ours}`")));
    let elsewhere = PROPERTIES_ELSEWHERE
        .iter()
        .map(|(mapping, key, what)| (format!("{mapping}.{key}"), (*what).to_owned()));
    plain.chain(special).chain(sensors).chain(properties).chain(elsewhere).collect()
}

/// The rule of a key that is translated by itself.
pub(crate) fn rule(key: &str) -> Option<&'static Rule> {
    NAMES.plain.iter().find(|(name, _)| *name == key).map(|(_, rule)| rule)
}

/// Our name of a sensor's key, which follows `vehicle.` or `rsu.`.
pub(crate) fn sensor_key(key: &str) -> Option<&'static str> {
    NAMES.sensors.iter().find(|(name, _)| name == key).map(|(_, ours)| ours.as_str())
}

/// Whether a key is a mapping of a sensor's properties.
pub(crate) fn is_mapping(key: &str) -> bool {
    let declared = NAMES.properties.iter().map(|(mapping, ..)| *mapping);
    declared.chain(PROPERTIES_ELSEWHERE.iter().map(|(mapping, ..)| *mapping)).any(|mapping| mapping == key)
}

/// Our name of a key within such a mapping; empty where another key has a say in it.
pub(crate) fn property_key(mapping: &str, key: &str) -> Option<&'static str> {
    let declared = NAMES.properties.iter().find(|(m, k, _)| (*m, *k) == (mapping, key));
    let elsewhere = PROPERTIES_ELSEWHERE.iter().find(|(m, k, _)| (*m, *k) == (mapping, key));
    declared.map(|(.., ours)| ours.as_str()).or(elsewhere.map(|_| ""))
}

/// Our name of a weather parameter.
pub(crate) fn weather(parameter: &str) -> Option<&'static str> {
    let published = Weather::PUBLISHED_NAMES.iter().find(|(name, _)| *name == parameter);
    let renamed = published.map_or(parameter, |(_, own)| own);
    Weather::NAMES.into_iter().find(|name| *name == renamed)
}

/// The model of a vehicle whose name no record has a part of (`simbev2x` of [`catalogue::Model`]).
pub(crate) const OTHER_MODEL: &str = "car.sedan";
