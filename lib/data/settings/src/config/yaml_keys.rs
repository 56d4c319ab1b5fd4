//! The keys of a SimBEV2X configuration that translate one by one.

use schema::tables::Weather;

/// What becomes of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The same value under our name.
    Same(&'static str),
    /// Percent there, a share here.
    Percent(&'static str),
    /// It has no effect here, and why.
    Nothing(&'static str),
}

use Rule::{Nothing, Percent, Same};

const NO_ENGINE: &str = "there is no game engine and no window";

/// Keys by name.
const RULES: &[(&str, Rule)] = &[
    // Dataset and population.
    ("replay_scene_config", Nothing("any stage runs again from the logs: run it with --scenes and --force")),
    ("min_vehicles", Same("agents.min_vehicles")),
    ("max_vehicles", Same("agents.max_vehicles")),
    ("vehicle_spawn_mode", Same("agents.spawn_mode")),
    ("clustered_spawn_distance", Same("agents.clustered_spawn_distance_m")),
    ("chained_spawn_distance", Same("agents.chained_spawn_distance_m")),
    ("min_rsus", Same("agents.min_rsus")),
    ("max_rsus", Same("agents.max_rsus")),
    ("simulate_physics", Nothing("vehicles are always simulated")),
    ("show_debug_telemetry", Nothing(NO_ENGINE)),
    // Simulation.
    ("warmup_duration", Same("timing.warmup_s")),
    ("min_scene_duration", Same("timing.min_duration_s")),
    ("max_scene_duration", Same("timing.max_duration_s")),
    ("host", Nothing(NO_ENGINE)),
    ("timeout", Nothing(NO_ENGINE)),
    ("resolution_x", Nothing(NO_ENGINE)),
    ("resolution_y", Nothing(NO_ENGINE)),
    ("show_display", Nothing(NO_ENGINE)),
    ("quality_level", Nothing(NO_ENGINE)),
    ("retries_on_error", Nothing(NO_ENGINE)),
    ("render_gpu", Nothing(NO_ENGINE)),
    ("max_io_workers", Nothing("--threads says how many threads work")),
    ("tile_stream_distance", Nothing("maps are loaded whole")),
    ("waypoint_distance", Same("bev.lane_step_m")),
    ("nearby_mapping_area_radius", Same("bev.near_radius_m")),
    ("spawn_point_separation_distance", Same("agents.spawn_separation_m")),
    ("bbox_collection_radius", Same("annotation.box_radius_m")),
    ("bev_camera_height", Nothing("masks are drawn from geometry, without a camera")),
    ("render_bev_camera_images", Nothing(NO_ENGINE)),
    ("bev_dim", Same("bev.cells")),
    ("bev_res", Same("bev.cell_m")),
    ("spectator_height", Nothing(NO_ENGINE)),
    ("spectator_vehicle_index", Nothing(NO_ENGINE)),
    ("use_bev_for_sidewalks", Same("bev.sidewalks_from_above")),
    ("use_cityscapes_palette", Nothing("masks have no colours")),
    // Traffic.
    ("ignore_lights_percentage", Percent("traffic.ignore_lights")),
    ("ignore_signs_percentage", Percent("traffic.ignore_signs")),
    ("ignore_vehicles_percentage", Percent("traffic.ignore_vehicles")),
    ("ignore_walkers_percentage", Percent("traffic.ignore_walkers")),
    ("door_open_percentage", Percent("traffic.door_open")),
    ("wheelchair_use_percentage", Percent("walkers.wheelchair")),
    ("hazard_area_percentage", Percent("hazards.share")),
    ("accident_hazard_percentage", Percent("hazards.accident_share")),
    ("emergency_vehicle_at_accident_percentage", Percent("hazards.emergency_share")),
    ("missing_cone_percentage", Percent("hazards.missing_cone_share")),
    ("emergency_lights_percentage", Percent("traffic.emergency_lights")),
    ("reckless_ego_percentage", Percent("traffic.reckless_agent")),
    ("reckless_npc_percentage", Percent("traffic.reckless_background")),
    ("distracted_ego_percentage", Percent("traffic.distracted_agent")),
    ("distracted_npc_percentage", Percent("traffic.distracted_background")),
    ("max_n_walkers", Same("walkers.max_count")),
    ("spawn_attempts", Nothing("walkers start where they can walk")),
    ("walker_speed_min", Same("walkers.min_speed_mps")),
    ("n_vehicles", Same("traffic.vehicles")),
    ("n_walkers", Same("walkers.count")),
    ("walker_cross_factor", Same("walkers.cross_factor")),
    ("speed_difference", Percent("traffic.speed_difference")),
    ("distance_to_leading", Same("traffic.standstill_gap_m")),
    ("green_time", Same("traffic.green_time_s")),
    // Weather and lights.
    ("dynamic_weather", Same("weather.dynamic")),
    ("random_building_light_colors", Same("lights.random_building_colors")),
    ("change_street_light_intensity", Same("lights.change_intensity")),
    ("min_street_light_intensity", Same("lights.min_intensity_lm")),
    ("street_light_intensity_change", Same("lights.intensity_change_lm")),
    ("turn_off_building_lights", Same("lights.buildings_off")),
    ("turn_off_street_lights", Same("lights.street_lamps_off")),
];

/// Keys that need more than a new name (`yaml_special` translates them), and what becomes of them.
const SPECIAL: &[(&str, &str)] = &[
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

/// Every key of a SimBEV2X configuration with what becomes of it, as text of a page. Those of sensors stand for
/// vehicles; with `rsu_` they are about RSUs.
#[must_use]
pub fn simbev2x_keys() -> Vec<(String, String)> {
    let plain = RULES.iter().map(|(key, rule)| {
        let what = match rule {
            Same(ours) => format!("`{ours}`"),
            Percent(ours) => format!("`{ours}`, as a share"),
            Nothing(why) => format!("no effect: {why}"),
        };
        ((*key).to_owned(), what)
    });
    let special = SPECIAL.iter().map(|(key, what)| ((*key).to_owned(), (*what).to_owned()));
    let sensors = SENSOR_KEYS.iter().map(|(key, ours)| ((*key).to_owned(), format!("`vehicle.{ours}`")));
    let properties = PROPERTY_KEYS.iter().map(|(mapping, key, ours)| {
        let what = match (*ours, *mapping, *key) {
            ("", "lidar_properties", "points_per_second") => {
                "`vehicle.lidar.columns`, points a frame and channel".into()
            }
            ("", "radar_properties", "points_per_second") => "`vehicle.radar.rays`, points a frame".into(),
            ("", _, "rotation_frequency") => "no effect: one turn a frame".into(),
            ("", ..) => "no effect: `camera_fov` says it".into(),
            (ours, ..) => format!("`vehicle.{ours}`"),
        };
        (format!("{mapping}.{key}"), what)
    });
    plain.chain(special).chain(sensors).chain(properties).collect()
}

/// The rule of a key that is translated by itself.
pub(crate) fn rule(key: &str) -> Option<Rule> {
    RULES.iter().find(|(name, _)| *name == key).map(|(_, rule)| *rule)
}

/// Our name of a weather parameter.
pub(crate) fn weather(parameter: &str) -> Option<&'static str> {
    let published = Weather::PUBLISHED_NAMES.iter().find(|(name, _)| *name == parameter);
    let renamed = published.map_or(parameter, |(_, own)| own);
    Weather::NAMES.into_iter().find(|name| *name == renamed)
}

/// Keys of the sensors of one kind of agent, by their name without `rsu_`; ours follow `vehicle.` or `rsu.`.
pub(crate) const SENSOR_KEYS: &[(&str, &str)] = &[
    ("camera_width", "camera.width"),
    ("camera_height", "camera.height"),
    ("camera_fov", "camera.fov_deg"),
    ("use_rgb_camera", "camera.rgb"),
    ("use_semantic_camera", "camera.semantic"),
    ("use_instance_camera", "camera.instance"),
    ("use_depth_camera", "camera.depth"),
    ("use_flow_camera", "camera.flow"),
    ("use_lidar", "lidar.enabled"),
    ("use_semantic_lidar", "lidar.semantic"),
    ("lidar_channels", "lidar.channels"),
    ("lidar_range", "lidar.range_m"),
    ("use_radar", "radar.enabled"),
    ("radar_range", "radar.range_m"),
    ("radar_horizontal_fov", "radar.horizontal_fov_deg"),
    ("radar_vertical_fov", "radar.vertical_fov_deg"),
    ("use_gnss", "gnss.enabled"),
    ("use_imu", "imu.enabled"),
    ("use_voxel_detector", "occupancy.enabled"),
    ("voxel_detector_range", "occupancy.range_m"),
    ("voxel_size", "occupancy.voxel_m"),
    ("voxel_detector_upper_limit", "occupancy.upper_m"),
    ("voxel_detector_lower_limit", "occupancy.lower_m"),
];

/// Keys within `..._properties`: the mapping, its key, ours. Where ours is empty the key is taken care of elsewhere.
pub(crate) const PROPERTY_KEYS: &[(&str, &str, &str)] = &[
    ("rgb_camera_properties", "fstop", "camera.f_stop"),
    ("rgb_camera_properties", "fov", ""),
    ("lidar_properties", "points_per_second", ""),
    ("lidar_properties", "rotation_frequency", ""),
    ("lidar_properties", "upper_fov", "lidar.upper_fov_deg"),
    ("lidar_properties", "lower_fov", "lidar.lower_fov_deg"),
    ("lidar_properties", "horizontal_fov", "lidar.horizontal_fov_deg"),
    ("lidar_properties", "dropoff_general_rate", "lidar.dropoff_rate"),
    ("lidar_properties", "dropoff_intensity_limit", "lidar.dropoff_intensity_limit"),
    ("lidar_properties", "dropoff_zero_intensity", "lidar.dropoff_zero_intensity"),
    ("lidar_properties", "atmosphere_attenuation_rate", "lidar.attenuation_per_m"),
    ("lidar_properties", "noise_stddev", "lidar.noise_m"),
    ("radar_properties", "points_per_second", ""),
    ("gnss_properties", "noise_alt_stddev", "gnss.noise_altitude_m"),
    ("gnss_properties", "noise_lat_stddev", "gnss.noise_latitude_deg"),
    ("gnss_properties", "noise_lon_stddev", "gnss.noise_longitude_deg"),
    ("imu_properties", "noise_accel_stddev_x", "imu.noise_accel_mps2"),
    ("imu_properties", "noise_accel_stddev_y", "imu.noise_accel_mps2"),
    ("imu_properties", "noise_accel_stddev_z", "imu.noise_accel_mps2"),
    ("imu_properties", "noise_gyro_bias_x", "imu.gyro_bias_radps"),
    ("imu_properties", "noise_gyro_bias_y", "imu.gyro_bias_radps"),
    ("imu_properties", "noise_gyro_bias_z", "imu.gyro_bias_radps"),
    ("imu_properties", "noise_gyro_stddev_x", "imu.noise_gyro_radps"),
    ("imu_properties", "noise_gyro_stddev_y", "imu.noise_gyro_radps"),
    ("imu_properties", "noise_gyro_stddev_z", "imu.noise_gyro_radps"),
    ("voxel_detector_properties", "ignore_self", "occupancy.ignore_self"),
    ("voxel_detector_properties", "full_sweep", "occupancy.full_sweep"),
    ("voxel_detector_properties", "use_z_top", "occupancy.use_z_top"),
    ("voxel_detector_properties", "use_z_bottom", "occupancy.use_z_bottom"),
    ("voxel_detector_properties", "use_x_front", "occupancy.use_x_front"),
    ("voxel_detector_properties", "use_x_back", "occupancy.use_x_back"),
    ("voxel_detector_properties", "use_y_left", "occupancy.use_y_left"),
    ("voxel_detector_properties", "use_y_right", "occupancy.use_y_right"),
    ("voxel_detector_properties", "z_fill_mode", "occupancy.z_fill_mode"),
];

/// Body styles that come nearest to the vehicles of the published dataset, by a part of their names.
pub(crate) const MODELS: &[(&str, &str)] = &[
    ("mustang", "car.coupe"),
    ("supra", "car.sports"),
    ("chiron", "car.sports"),
    ("tt", "car.coupe"),
    ("mini", "car.mini"),
    ("micro", "car.micro"),
    ("model3", "car.electric"),
    ("prius", "car.electric"),
    ("patrol", "car.suv"),
    ("wrangler", "car.offroad"),
    ("police", "car.police"),
    ("taxi", "car.taxi"),
    ("sprinter", "van.delivery"),
    ("volkswagen.t2", "van.camper"),
    ("fusorosa", "bus.city"),
    ("carlacola", "truck.box"),
    ("cybertruck", "truck.pickup"),
    ("european_hgv", "truck.heavy"),
    ("firetruck", "truck.fire"),
    ("low_rider", "motorcycle.cruiser"),
    ("ninja", "motorcycle.sport"),
    ("yzf", "motorcycle.sport"),
    ("vespa", "motorcycle.scooter"),
    ("crossbike", "bicycle.city"),
    ("omafiets", "bicycle.city"),
    ("century", "bicycle.road"),
    ("ambulance", "van.ambulance"),
];

/// Body style of a vehicle that none of [`MODELS`] names.
pub(crate) const OTHER_MODEL: &str = "car.sedan";

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::yaml::translate;
    use super::super::yaml_writer::Translation;
    use super::super::{config_keys, parse};
    use super::*;
    use crate::reader::{Absent, ConfigKey};

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
                let warned = got
                    .warnings
                    .iter()
                    .any(|w| !w.message.contains("no such key") && w.message.contains(key));
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
            (
                "dynamic_settings_adjustments",
                "False",
                "traffic.spawn_radius_m = 600\nbev.lane_radius_m = 1600\n",
            ),
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
                |w: &crate::reader::Fault| w.message.contains(key) && !w.message.contains("no such key");
            assert!(!want.is_empty() || got.warnings.iter().any(names), "{key}: {:?}", got.warnings);
        }
        assert_eq!(
            cases.map(|(key, ..)| key).as_slice(),
            SPECIAL.iter().map(|(key, _)| *key).collect::<Vec<_>>()
        );
    }
}
