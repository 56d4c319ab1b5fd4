//! Every key of SimBEV2X does what the page says.

use std::collections::BTreeSet;

use super::names::{SPECIAL, simbev2x_keys};
use super::{Translation, translate};
use crate::config_key::{Absent, ConfigKey};
use crate::{config_keys, parse};

fn translated(text: &str) -> Translation {
    translate(text, "x.yaml").unwrap_or_else(|faults| panic!("{text}: {faults:?}"))
}

/// A value of TOML, however it is written.
fn value(text: &str) -> Option<toml::Value> {
    format!("value = {text}").parse::<toml::Table>().ok()?.remove("value")
}

/// What a text gives for a key of ours; our reader must take it.
fn given(text: &str, path: &str) -> Option<toml::Value> {
    let toml = translated(text).toml;
    let whole = format!("{toml}[scenes.train]\n\"convoy/demo\" = 1\n");
    parse(&whole, "x.toml").unwrap_or_else(|faults| panic!("{text}: {faults:?}"));
    toml.lines().find_map(|line| value(line.strip_prefix(path)?.strip_prefix(" = ")?))
}

/// A value that a key of ours takes.
fn sample(key: &ConfigKey) -> String {
    match key.path.as_str() {
        _ if matches!(key.default, Absent::Value(_)) => key.default.to_string(),
        // A share.
        "walkers.cross_factor" => "0.5".into(),
        _ => "5".into(),
    }
}

#[test]
fn keys_do_what_the_page_says() {
    let special: BTreeSet<&str> = SPECIAL.iter().map(|(key, _)| *key).collect();
    let ours = config_keys();
    let (mut translating, mut without) = (0, 0);
    for (key, says) in simbev2x_keys().iter().filter(|(key, _)| !special.contains(key.as_str())) {
        let with = |value: &str| match key.split_once('.') {
            Some((mapping, inner)) => format!("{mapping}: {{{inner}: {value}}}\n"),
            None => format!("{key}: {value}\n"),
        };
        if let Some(path) = says.strip_prefix('`').and_then(|says| says.split('`').next()) {
            let ours = ours.iter().find(|k| k.path == path);
            let ours = ours.unwrap_or_else(|| panic!("{key}: there is no key `{path}`"));
            let (wish, want) = match says.split_once("`, ").map(|(_, how)| how) {
                None => (sample(ours), sample(ours)),
                Some("as a share") => ("12.5".to_owned(), "0.125".to_owned()),
                // 20 readings a second; 128 channels.
                Some("points a frame and channel") => ("1310720".to_owned(), "512".to_owned()),
                Some("points a frame") => ("30000".to_owned(), "1500".to_owned()),
                Some(how) => panic!("{key}: {how}?"),
            };
            let want = value(&want).expect("a value");
            assert_eq!(given(&with(&wish), path), Some(want), "{key}");
            translating += 1;
        } else {
            assert!(says.starts_with("no effect: "), "{key}: {says}");
            let (got, mapping) = (translated(&with("1")), key.split('.').next().unwrap_or_default());
            // The mapping alone says as much.
            let empty = key.contains('.').then(|| translated(&format!("{mapping}: {{}}\n")).toml);
            assert_eq!(got.toml, empty.unwrap_or_default(), "{key}");
            let warned =
                got.warnings.iter().any(|w| !w.message.contains("no such key") && w.message.contains(key));
            assert!(warned || key.contains('.'), "{key}: {:?}", got.warnings);
            without += 1;
        }
    }
    assert_eq!((translating, without), (102, 21));
}

#[test]
fn special_keys_become_what_they_should() {
    // Each with what it stands beside, and the lines that it becomes; an empty text: a warning that names it.
    let cases = [
        ("mode", "replace\nreplacement_scene_config: [4]", "scenes.redraw.\"4\" = 1\n"),
        ("train_scene_config", "{Town01: 8}", "scenes.train.\"Town01\" = 8\n"),
        ("val_scene_config", "{Town01: 8}", "scenes.val.\"Town01\" = 8\n"),
        ("test_scene_config", "{Town01: 8}", "scenes.test.\"Town01\" = 8\n"),
        ("replacement_scene_config", "[7]\nmode: replace", "scenes.redraw.\"7\" = 1\n"),
        ("vehicle_list", "[vehicle.audi.tt]", "agents.vehicle_models = [\"car.coupe\"]\n"),
        ("vehicle_color_list", "['0,0,255']", "agents.vehicle_colors = [[0,0,255]]\n"),
        ("use_scene_number_for_random_seed", "False", ""),
        ("random_seed_offset", "31", "seed = 31\n"),
        ("timestep", "0.1", ""),
        ("dynamic_settings_adjustments", "False", "traffic.spawn_radius_m = 600\nbev.lane_radius_m = 1600\n"),
        (
            "npc_spawn_radius",
            "450\ndynamic_settings_adjustments: False",
            "traffic.spawn_radius_m = 450\nbev.lane_radius_m = 1600\n",
        ),
        (
            "mapping_area_radius",
            "700\nnpc_spawn_radius: 450\ndynamic_settings_adjustments: False",
            "bev.lane_radius_m = 700\ntraffic.spawn_radius_m = 450\n",
        ),
        (
            "actor_active_distance",
            "800\nnpc_spawn_radius: 450\ndynamic_settings_adjustments: False",
            "traffic.active_distance_m = 800\ntraffic.spawn_radius_m = 450\nbev.lane_radius_m = 1600\n",
        ),
        ("random_street_light_failure", "False", "lights.street_lamp_failure = 0\n"),
        ("street_light_failure_percentage", "25", "lights.street_lamp_failure = 0.25\n"),
        ("initial_weather", "{cloudiness: 12.5}", "weather.initial.cloudiness = 12.5\n"),
        ("final_weather", "{sun_altitude_angle: -20}", "weather.final.sun_altitude_deg = -20\n"),
        (
            "data_collection_vehicle_spawn_points",
            "{Town01: [[[1, 2, 0.5], [0, 0, 90]]]}",
            "agents.starts = [{ map = \"Town01\", xyz_m = [1, -2, 0.5], yaw_deg = -90 }]\n",
        ),
        ("semantic_lidar_channels", "64", ""),
        ("semantic_lidar_range", "100", ""),
        ("semantic_lidar_properties", "{points_per_second: 5}", ""),
    ];
    for (key, value, want) in cases {
        let got = translated(&format!("{key}: {value}\n"));
        assert_eq!(got.toml, want, "{key}");
        let names =
            |w: &crate::document::Fault| w.message.contains(key) && !w.message.contains("no such key");
        assert!(!want.is_empty() || got.warnings.iter().any(names), "{key}: {:?}", got.warnings);
    }
    assert_eq!(
        cases.map(|(key, ..)| key).as_slice(),
        SPECIAL.iter().map(|(key, _)| *key).collect::<Vec<_>>()
    );
}
