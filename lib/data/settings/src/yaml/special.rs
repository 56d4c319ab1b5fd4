//! The keys of a SimBEV2X configuration that need more than a new name.

use std::collections::BTreeMap;

use crate::rig::Rig;
use catalogue::models;
use saphyr::MarkedYaml;

use super::names::{OTHER_MODEL, is_mapping, property_key, sensor_key, weather};
use super::writer::{Writer, decimal, flag, is_null, items, line, number, pairs, quoted, text};

/// Frames, sweeps and radar readings a second.
const RATE_HZ: f64 = 20.0;

/// Translates a key; `false`: it is not known. `all` are the keys at the top, for those that belong together.
pub(crate) fn translate(
    to: &mut Writer<'_>,
    key: &str,
    at: usize,
    value: &MarkedYaml<'_>,
    all: &BTreeMap<&str, &MarkedYaml<'_>>,
) -> bool {
    let other = |name: &str| all.get(name).copied();
    match key {
        "mode" => match text(value) {
            Some("create") => {}
            Some("replace") => to.warn(
                at,
                "`mode`: the scenes of `replacement_scene_config` become their first other draw; for further ones set [scenes.redraw] in a TOML configuration, as another `random_seed_offset` draws all scenes anew".into(),
            ),
            Some("replay") => {
                to.warn(at, "`mode`: any stage runs again from the logs, planned as `create`".into())
            }
            _ => {}
        },
        "train_scene_config" | "val_scene_config" | "test_scene_config" => {
            let split = key.trim_end_matches("_scene_config");
            for (map, at, count) in pairs(value).unwrap_or_default() {
                let count = number(count).map_or_else(|| "\"?\"".into(), decimal);
                to.put(at, &format!("scenes.{split}.{}", quoted(map)), count);
            }
        }
        "replacement_scene_config" => {
            let replace = other("mode").and_then(text) == Some("replace");
            for scene in items(value).unwrap_or_default().iter().filter(|_| replace) {
                let number = number(scene).map_or_else(|| "?".into(), decimal);
                to.put(line(scene), &format!("scenes.redraw.{}", quoted(&number)), "1".into());
            }
        }
        "vehicle_list" => vehicles(to, key, at, value),
        "vehicle_color_list" => colors(to, key, at, value),
        "use_scene_number_for_random_seed" => {
            if flag(value) == Some(false) {
                to.warn(at, format!("`{key}`: every scene has a seed here, from its number"));
            }
        }
        "random_seed_offset" => to.put(at, "seed", number(value).map_or_else(|| "\"?\"".into(), decimal)),
        "timestep" => {
            if number(value) != Some(1.0 / RATE_HZ) {
                to.warn(at, format!("`{key}`: a frame is always {} s", 1.0 / RATE_HZ));
            }
        }
        // These say whether another key counts, and its default does where that key is absent.
        "dynamic_settings_adjustments" => {
            if flag(value) == Some(false) {
                if other("npc_spawn_radius").is_none() {
                    to.put(at, "traffic.spawn_radius_m", "600".into());
                }
                if other("mapping_area_radius").is_none() {
                    to.put(at, "bev.lane_radius_m", "1600".into());
                }
            }
        }
        "random_street_light_failure" => {
            if flag(value) == Some(false) && other("street_light_failure_percentage").is_none() {
                to.put(at, "lights.street_lamp_failure", "0".into());
            }
        }
        "npc_spawn_radius" | "actor_active_distance" | "mapping_area_radius" => {
            let ours = match key {
                "npc_spawn_radius" => "traffic.spawn_radius_m",
                "actor_active_distance" => "traffic.active_distance_m",
                _ => "bev.lane_radius_m",
            };
            if other("dynamic_settings_adjustments").and_then(flag) == Some(false) {
                let metres = number(value).map_or_else(|| "\"?\"".into(), decimal);
                to.put(at, ours, metres);
            }
        }
        "street_light_failure_percentage" => {
            let on = other("random_street_light_failure").and_then(flag) != Some(false);
            match number(value) {
                Some(percent) if on => to.put(at, "lights.street_lamp_failure", decimal(percent / 100.0)),
                Some(_) => to.put(at, "lights.street_lamp_failure", "0".into()),
                None => to.warn(at, format!("`{key}`: expected a number, ignored")),
            }
        }
        "initial_weather" | "final_weather" => {
            let end = key.trim_end_matches("_weather");
            for (parameter, at, value) in pairs(value).unwrap_or_default() {
                match (weather(parameter), number(value)) {
                    (Some(name), Some(value)) => to.put(at, &format!("weather.{end}.{name}"), decimal(value)),
                    _ => to.warn(at, format!("`{key}.{parameter}`: no such weather parameter, ignored")),
                }
            }
        }
        "data_collection_vehicle_spawn_points" => starts(to, key, at, value),
        _ => return sensor(to, key, at, value, all),
    }
    true
}

fn vehicles(to: &mut Writer<'_>, key: &str, at: usize, value: &MarkedYaml<'_>) {
    let mut names = Vec::new();
    for item in items(value).unwrap_or_default() {
        let wish = text(item).unwrap_or_default();
        let lower = wish.to_ascii_lowercase();
        let known = models::find(wish).or_else(|| models::of_simbev2x(&lower));
        let model = known.map_or_else(
            || {
                to.warn(
                    line(item),
                    format!("`{key}`: no body like `{wish}` here, `{OTHER_MODEL}` takes its place"),
                );
                OTHER_MODEL
            },
            |model| model.name,
        );
        names.push(quoted(model));
    }
    to.put(at, "agents.vehicle_models", format!("[{}]", names.join(", ")));
}

/// Texts such as `255, 0, 0`.
fn colors(to: &mut Writer<'_>, key: &str, at: usize, value: &MarkedYaml<'_>) {
    let mut colors = Vec::new();
    for item in items(value).unwrap_or_default() {
        match text(item) {
            Some(rgb) => colors.push(format!("[{rgb}]")),
            None => to.warn(line(item), format!("`{key}`: expected texts such as \"255,0,0\", ignored")),
        }
    }
    to.put(at, "agents.vehicle_colors", format!("[{}]", colors.join(", ")));
}

/// Lists of `[[x, y, z], [roll, pitch, yaw]]` by map, in the engine's left-handed frame: y and yaw change
/// sign.
fn starts(to: &mut Writer<'_>, key: &str, at: usize, value: &MarkedYaml<'_>) {
    let mut starts = Vec::new();
    for (map, at, points) in pairs(value).unwrap_or_default() {
        for point in items(points).unwrap_or_default() {
            let parts: Vec<Vec<f64>> = items(point)
                .unwrap_or_default()
                .iter()
                .map(|part| items(part).unwrap_or_default().iter().filter_map(number).collect())
                .collect();
            match parts.iter().map(Vec::as_slice).collect::<Vec<_>>().as_slice() {
                [[x, y, z], [_, _, yaw]] => {
                    let [x, y, z, yaw] = [*x, -y, *z, -yaw].map(decimal);
                    let map = quoted(map);
                    starts.push(format!("{{ map = {map}, xyz_m = [{x}, {y}, {z}], yaw_deg = {yaw} }}"));
                }
                _ => to.warn(at, format!("`{key}.{map}`: expected [[x, y, z], [roll, pitch, yaw]], ignored")),
            }
        }
    }
    to.put(at, "agents.starts", format!("[{}]", starts.join(", ")));
}

/// The kind of agent that a sensor's key is about, and the key as vehicles have it.
fn carrier(key: &str) -> (&'static str, String) {
    if let Some(rest) = key.strip_prefix("use_rsu_") {
        ("rsu", format!("use_{rest}"))
    } else if let Some(rest) = key.strip_prefix("rsu_") {
        ("rsu", rest.to_owned())
    } else {
        ("vehicle", key.to_owned())
    }
}

fn sensor(
    to: &mut Writer<'_>,
    key: &str,
    at: usize,
    value: &MarkedYaml<'_>,
    all: &BTreeMap<&str, &MarkedYaml<'_>>,
) -> bool {
    let (agent, plain) = carrier(key);
    if let Some(ours) = sensor_key(&plain) {
        let text = flag(value).map(|f| f.to_string()).or_else(|| number(value).map(decimal));
        to.put(at, &format!("{agent}.{ours}"), text.unwrap_or_else(|| "\"?\"".into()));
        if plain == "lidar_channels" && all.get(properties_of(agent, "lidar").as_str()).is_none() {
            columns(to, agent, at, None, Some(value));
        }
        return true;
    }
    if plain.starts_with("semantic_lidar_") {
        to.warn(at, format!("`{key}` has no effect here: the semantic lidar has the rays of the lidar"));
        return true;
    }
    if !is_mapping(&plain) && !(plain.ends_with("_camera_properties")) {
        return false;
    }
    if is_null(value) {
        return true;
    }
    for (name, at, value) in pairs(value).unwrap_or_default() {
        match property_key(&plain, name) {
            Some("") => {}
            Some(ours) => {
                // Flags and numbers come as texts, too; words (`BoxSweep`) are small here.
                let word = || text(value).map(|word| quoted(&word.trim().to_ascii_lowercase()));
                let plain = flag(value).map(|f| f.to_string()).or_else(|| number(value).map(decimal));
                let value = plain.or_else(word).unwrap_or_else(|| "\"?\"".into());
                to.put(at, &format!("{agent}.{ours}"), value);
            }
            None => to.warn(at, format!("`{key}.{name}` has no effect here")),
        }
    }
    match plain.as_str() {
        "lidar_properties" => {
            let channels = all.get(properties_channels(agent)).copied();
            columns(to, agent, at, Some(value), channels);
        }
        "radar_properties" => {
            if let Some(rate) = property(value, "points_per_second") {
                to.put(at, &format!("{agent}.radar.rays"), decimal((rate / RATE_HZ).round()));
            }
        }
        _ => {}
    }
    true
}

fn properties_of(agent: &str, sensor: &str) -> String {
    if agent == "rsu" { format!("rsu_{sensor}_properties") } else { format!("{sensor}_properties") }
}

fn properties_channels(agent: &str) -> &'static str {
    if agent == "rsu" { "rsu_lidar_channels" } else { "lidar_channels" }
}

fn property(mapping: &MarkedYaml<'_>, name: &str) -> Option<f64> {
    pairs(mapping)?.iter().find(|(key, ..)| *key == name).and_then(|(.., value)| number(value))
}

/// Azimuth steps from points a second: one sweep a frame.
fn columns(
    to: &mut Writer<'_>,
    agent: &str,
    at: usize,
    properties: Option<&MarkedYaml<'_>>,
    channels: Option<&MarkedYaml<'_>>,
) {
    let rig = if agent == "rsu" { Rig::rsu() } else { Rig::vehicle() };
    let Some(scan) = rig.lidars.first().map(|lidar| &lidar.scan) else { return };
    let rate = properties.and_then(|p| property(p, "points_per_second"));
    let rate = rate.unwrap_or(scan.rays() as f64 * RATE_HZ);
    let channels = channels.and_then(number).unwrap_or(f64::from(scan.channels));
    let sweeps = properties.and_then(|p| property(p, "rotation_frequency"));
    if sweeps.is_some_and(|hz| hz != RATE_HZ) {
        to.warn(at, format!("`rotation_frequency`: the lidar turns once a frame, {RATE_HZ} times a second"));
    }
    let columns = (rate / (RATE_HZ * channels)).round();
    // Without channels there is a fault already.
    if columns.is_finite() {
        to.put(at, &format!("{agent}.lidar.columns"), decimal(columns));
    }
}
