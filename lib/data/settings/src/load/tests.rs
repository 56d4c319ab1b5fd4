//! Configurations that are good, and what is said of bad ones.

use super::*;
use crate::BevRule;
use crate::{BeamSpec, LidarSpec, Optics, Returned, RollingScan, Split, WeatherSpec, ZFill};
use crate::{WeatherKeyframe, WeatherValue};
use schema::AgentId;
use schema::BevClass;

fn faults(text: &str) -> String {
    let faults = parse(text, "bad.toml").expect_err("has faults");
    faults.iter().map(|f| format!("{f}\n")).collect()
}

#[test]
fn defaults_are_the_published_ones() {
    let s = example_settings();
    assert_eq!(s.scenario.agents, crate::AgentSettings::default());
    assert_eq!(s.scenario.vehicle_rig, crate::Rig::vehicle());
    assert_eq!(s.scenario.rsu_rig, crate::Rig::rsu());
    assert_eq!(s.scenario.vehicle_occupancy, crate::OccupancySettings::default());
    assert_eq!(s.scenario.weather, crate::WeatherSettings::default());
}

#[test]
fn all_faults_come_at_once_with_their_lines() {
    let text = "seed = -4\n\n[scenes.train]\n\"convoy/demo\" = 1\n\n[vehicle.camera]\nwidth = \"wide\"\nhieght = 900\n\
                [agents]\nmin_vehicles = 5\nmax_vehicles = 3\n";
    insta::assert_snapshot!(faults(text), @r"
    bad.toml:1: `seed` is -4, expected 0 to 9223372036854775807
    bad.toml:7: `vehicle.camera.width` is a string, expected an integer
    bad.toml:8: unknown key `vehicle.camera.hieght` (did you mean `height`?)
    bad.toml:10: `agents.min_vehicles` is 5, more than `agents.max_vehicles` (3)
    ");
}

#[test]
fn broken_toml_is_reported_with_its_line() {
    let text = faults("name = \"x\"\nseed = = 3\n[scenes.train]\n\"convoy/demo\" = 1\n");
    assert!(text.starts_with("bad.toml:2: "), "{text}");
}

#[test]
fn what_lidars_saw_needs_a_lidar() {
    let grid = "[scenes.train]\nTown01 = 1\n[rsu.occupancy]\nobserved = true\n";
    assert!(parse(grid, "a.toml").is_ok_and(|all| all.scenario.rsu_occupancy.observed));
    let found = faults(&format!("{grid}[rsu.lidar]\nenabled = false\nsemantic = true\n"));
    assert_eq!(found, "bad.toml:4: `rsu.occupancy.observed` needs a lidar without labels\n");
}

#[test]
fn a_dataset_without_scenes_is_a_fault() {
    assert!(faults("name = \"x\"\n").contains("no scenes"));
}

#[test]
fn an_agent_may_carry_several_lidars_and_rsus_receivers() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nchannels = 16\n[[vehicle.lidars]]\nname = \"LIDAR_LEFT\"\nchannels = 8\nxyz_m = [0, 1, 1]\n[[vehicle.lidars]]\nname = \"OWN\"\nenabled = false\nsemantic = true\nrange_m = 50\n[rsu.gnss]\nenabled = true\n";
    let settings = parse(text, "lidars.toml").expect("is good");
    let lidars = &settings.scenario.vehicle_rig.lidars;
    let about: Vec<_> =
        lidars.iter().map(|l| (l.name.as_str(), l.scan.channels, l.range_m, l.noise_m)).collect();
    let want = [("LIDAR", 16, 120.0, 0.03), ("LIDAR_LEFT", 8, 120.0, 0.03), ("SEG-OWN", 128, 50.0, 0.0)];
    assert_eq!(about, want);
    assert_eq!(lidars[1].mount.xyz_m, [0.0, 1.0, 1.0]);
    assert!(settings.scenario.rsu_rig.gnss.is_some() && settings.scenario.rsu_rig.imu.is_none());
    let clash = text.replace("\"OWN\"", "\"LIDAR\"");
    let faults = parse(&clash, "lidars.toml").expect_err("has the first one's tables");
    assert!(
        faults[0].to_string().contains("would take the place of another sensor's `LIDAR`"),
        "{}",
        faults[0]
    );
}

#[test]
fn a_lidars_scan_beams_and_weather_are_read_and_checked() {
    let with = |keys: &str| {
        let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nsemantic = true\n{keys}");
        parse(&text, "scan.toml").map_err(|f| f.iter().map(Fault::to_string).collect::<Vec<_>>())
    };
    let lidars = with("").expect("is good").scenario.vehicle_rig.lidars;
    assert_eq!((&lidars[0].beam, &lidars[0].rolling), (&LidarSpec::vehicle().beam, &None));
    let keys = "rolling = true\nrolling_slices = 32\nrolling_compensated = false\nbeam_rays = 7\n\
                beam_divergence_mrad = 2\nreturns = [\"last\", \"first\"]\nweather = true\nweather_detected = 0.2\n";
    let lidars = with(keys).expect("is good").scenario.vehicle_rig.lidars;
    let [plain, semantic] = lidars.as_slice() else { panic!("{lidars:?}") };
    assert_eq!(plain.rolling, Some(RollingScan { slices: 32, compensated: false }));
    let returned = Returned { first: true, strongest: false, last: true };
    assert_eq!(plain.beam, BeamSpec { rays: 7, divergence_rad: 0.002, returned });
    assert_eq!(plain.weather, Some(WeatherSpec { detected: 0.2 }));
    assert_eq!((&semantic.rolling, &semantic.beam), (&plain.rolling, &plain.beam));
    assert!(semantic.weather.is_none() && plain.tells_returns());

    for (keys, fault) in [
        ("rolling = true\nrolling_slices = 4000", "there are 2048 columns"),
        ("beam_rays = 3", "expected 1 or 7"),
        ("returns = [\"second\"]", "`second` is none of"),
        ("returns = []", "would return nothing"),
        ("returns = [\"first\", \"last\"]", "set beam_rays = 7"),
    ] {
        let faults = with(keys).expect_err(keys);
        assert!(faults.len() == 1 && faults[0].contains(fault), "{faults:?}");
    }
    assert!(with("returns = [\"last\"]\nweather = true").is_ok());
    let through = with("returns = [\"last\"]\nglass = true").expect("is good").scenario.vehicle_rig.lidars;
    assert!(through.iter().all(|lidar| lidar.glass && lidar.tells_returns()));
}

#[test]
fn a_sensor_must_not_take_anothers_table() {
    let radar = |name: &str| format!("[[vehicle.radars]]\nname = \"{name}\"\n");
    let camera = |name: &str| format!("[[vehicle.cameras]]\nname = \"{name}\"\n");
    let with = |sensors: &[String]| {
        let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n{}", sensors.concat());
        parse(&text, "bad.toml").map_err(|f| f.iter().map(Fault::to_string).collect::<Vec<_>>())
    };
    for (name, other) in [
        ("LIDAR", "LIDAR"),
        ("lidar", "LIDAR"),
        ("SEG-LIDAR", "SEG-LIDAR"),
        ("GNSS", "GNSS"),
        ("IMU", "IMU"),
        ("visible", "visible"),
        ("boxes_2d", "boxes_2d"),
        ("RGB-CAM_FRONT", "RGB-CAM_FRONT"),
        ("flw-cam_back", "FLW-CAM_BACK"),
    ] {
        let faults = with(&[radar(name)]).expect_err("is taken");
        let want = format!(
            "bad.toml:4: `vehicle.radars[0].name` is \"{name}\": its table `{name}` would take the place of \
             another sensor's `{other}`"
        );
        assert_eq!(faults, [want]);
    }
    // A camera called LIDAR would own the semantic lidar's table; one fault a sensor.
    for (sensors, line, path) in [
        (vec![camera("LIDAR")], 4, "vehicle.cameras[0].name"),
        (vec![camera("A"), camera("B"), camera("a")], 8, "vehicle.cameras[2].name"),
        (vec![camera("A"), radar("DPT-A")], 6, "vehicle.radars[0].name"),
        (vec![radar("A"), radar("A")], 6, "vehicle.radars[1].name"),
        // The second has no name of its own: the fault is at its table.
        (vec![radar("RAD_FRONT"), "[[vehicle.radars]]\n".to_owned()], 5, "vehicle.radars[1].name"),
    ] {
        let faults = with(&sensors).expect_err("is taken");
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert!(faults[0].starts_with(&format!("bad.toml:{line}: `{path}` is ")), "{faults:?}");
    }
    assert!(with(&[camera("RAD_FRONT"), radar("CAM_FRONT"), radar("RGB"), radar("SEG-")]).is_ok());
}

#[test]
fn sensor_names_are_file_names() {
    for name in ["", "a/b", "..", "a b", "\u{e4}", "a\\\\b", "x.y", &"x".repeat(65)] {
        let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n[[rsu.cameras]]\nname = \"{name}\"\n");
        let faults = faults(&text);
        assert!(faults.starts_with("bad.toml:4: `rsu.cameras[0].name` is "), "{faults}");
        assert!(faults.contains("letters, digits, _ and -"), "{faults}");
    }
}

#[test]
fn what_the_sensors_refuse_is_refused_here() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n\
                [vehicle.lidar]\nchannels = 1024\ncolumns = 65_536\n\
                [vehicle.occupancy]\nrange_m = 1\nvoxel_m = 5\n\
                [rsu.lidar]\ncolumns = 40_000\n\
                [rsu.occupancy]\nupper_m = 60\n";
    insta::assert_snapshot!(faults(text), @r"
    bad.toml:5: `vehicle.lidar`: 1024 channels x 65536 columns are 67108864 rays a frame, at most 4194304 are possible
    bad.toml:8: `vehicle.occupancy`: 0 x 0 x 2 cells of 5 m: there must be one along every axis
    bad.toml:10: `rsu.lidar`: 128 channels x 40000 columns are 5120000 rays a frame, at most 4194304 are possible
    bad.toml:12: `rsu.occupancy`: 1280 x 1280 x 610 cells of 0.1 m: at most 512 layers are possible
    ");
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[rsu.occupancy]\nupper_m = -5\n";
    assert_eq!(faults(text), "bad.toml:4: `rsu.occupancy.lower_m` is not below upper_m\n");
}

#[test]
fn agents_can_carry_rigs_of_their_own() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nchannels = 64\n\
                [[rigs]]\nagents = [\"vehicle_1\", \"vehicle_3\"]\n[rigs.lidar]\nchannels = 16\n\
                [[rigs.cameras]]\nname = \"CAM_ROOF\"\n[rigs.occupancy]\nenabled = false\n\
                [[rigs]]\nagents = [\"rsu_0\"]\n[rigs.radar]\nenabled = false\n";
    let s = parse(text, "x.toml").expect("is valid");
    let channels = |i| s.scenario.rigs().of(AgentId::vehicle(i)).lidars[0].scan.channels;
    assert_eq!([channels(0), channels(1), channels(2), channels(3)], [64, 16, 64, 16]);
    assert_eq!(s.scenario.rigs().of(AgentId::vehicle(1)).cameras.len(), 1);
    assert!(
        !s.scenario.occupancy().of(AgentId::vehicle(3)).enabled
            && s.scenario.occupancy().of(AgentId::vehicle(0)).enabled
    );
    assert!(
        s.scenario.rigs().of(AgentId::rsu(0)).radars.is_empty()
            && !s.scenario.rigs().of(AgentId::rsu(1)).radars.is_empty()
    );
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[[rigs]]\n\
                [[rigs]]\nagents = [\"vehicle_1\", \"rsu_0\"]\n\
                [[rigs]]\nagents = [\"bus_1\"]\n[[rigs]]\nagents = [\"vehicle_1\"]\n";
    insta::assert_snapshot!(faults(text), @r#"
    bad.toml:3: `rigs[0].agents` is empty: say which agents carry this rig, such as ["vehicle_1"]
    bad.toml:5: `rigs[1].agents` names vehicles and RSUs: a rig is for one kind
    bad.toml:7: `rigs[2].agents`: `bus_1` is no agent, expected vehicle_N or rsu_N
    bad.toml:9: `rigs[3].agents`: `vehicle_1` carries another rig already
    "#);
}

#[test]
fn masks_have_the_classes_that_are_named() {
    let text =
        "[scenes.train]\n\"convoy/demo\" = 1\n[bev]\nrule = \"simbev2x\"\nclasses = [\"car\", \"road\"]\n";
    let bev = parse(text, "x.toml").expect("is valid").bev;
    assert_eq!((bev.rule, bev.classes), (BevRule::Simbev2x, vec![BevClass::Car, BevClass::Road]));
    let with = |bev: &str| faults(&format!("[scenes.train]\n\"convoy/demo\" = 1\n[bev]\n{bev}\n"));
    let wrong = with("classes = [\"car\", \"cars\", \"car\"]");
    assert!(
        wrong.starts_with("bad.toml:4: `bev.classes`: `cars` is no class, expected some of road, "),
        "{wrong}"
    );
    assert!(wrong.ends_with("bad.toml:4: `bev.classes` names `car` twice\n"), "{wrong}");
    assert!(with("classes = []").contains("`bev.classes` is empty"));
}

#[test]
fn a_share_of_vehicles_needs_their_number() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[agents]\npenetration = 0.2\n";
    assert!(faults(text).starts_with("bad.toml:3: `agents.penetration` is a share"), "{}", faults(text));
    let s = parse(&format!("{text}[traffic]\nvehicles = 50\n"), "x.toml").expect("is valid");
    assert_eq!((s.scenario.agents.penetration, s.scenario.traffic.vehicles), (Some(0.2), Some(50)));
}

#[test]
fn starts_are_read() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n\
                [[agents.starts]]\nmap = \"convoy/demo\"\nxyz_m = [1, 2.5, 0]\nyaw_deg = 180\n";
    let starts = parse(text, "x.toml").expect("is valid").scenario.agents.starts;
    assert_eq!((starts[0].map.as_str(), starts[0].xyz_m), ("convoy/demo", [1.0, 2.5, 0.0]));
    assert!((starts[0].yaw_rad - std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn yaml_of_the_original_is_read() {
    let text = "\
mode: replace
train_scene_config:
  Town01: 8
  convoy/02: 1
val_scene_config:
test_scene_config: {Town12: 3}
replacement_scene_config: [4, 7]
max_vehicles: 5
vehicle_spawn_mode: chained
vehicle_list: ['vehicle.ford.mustang_2016', 'vehicle.audi.tt', zeppelin]
vehicle_color_list: ['0,0,0', '255,0,255']
random_seed_offset: 31
max_scene_duration: 12
dynamic_settings_adjustments: False
npc_spawn_radius: 450.0
bev_dim: 200
host: localhost
reckless_npc_percentage: 5.0
speed_difference: -10.0
street_light_failure_percentage: 25.0
initial_weather: {cloudiness: 12.5, sun_altitude_angle: -20, snow: 1}
lidar_channels: 64
lidar_properties: {points_per_second: '1310720', noise_stddev: '0.05', rotation_frequency: '10.0'}
rsu_camera_fov: '100'
use_rsu_lidar: False
rsu_radar_properties: {points_per_second: '24000'}
imu_properties: {noise_accel_stddev_x: '2e-4', noise_accel_stddev_y: '2e-4', noise_accel_stddev_z: '3e-4'}
use_voxel_detector: true
voxel_detector_properties: {ignore_self: 'True', full_sweep: 'False', use_x_back: 'True', z_fill_mode: 'BoxSweep', chunk_x: '4'}
data_collection_vehicle_spawn_points:
  Town01:
    - [[10.0, 20.0, 0.5], [0, 0, 90]]
colour_of_the_sky: green
ignore_signs_percentage: 0.5
";
    let wrong =
        parse_yaml(&text.replace("mode: replace", "mode: augment"), "x.yaml").expect_err("no such mode");
    assert_eq!(wrong[0].to_string(), "x.yaml:1: `mode`: expected create, replace or replay");
    let (s, warnings) = parse_yaml(text, "x.yaml").expect("is valid");
    let scenes: Vec<_> = s.scenes.iter().map(|w| (w.split.name(), w.map.as_str(), w.count)).collect();
    assert_eq!(scenes, [("train", "Town01", 8), ("train", "convoy/02", 1), ("test", "Town12", 3)]);
    assert_eq!((s.redraw.clone(), s.seed), (vec![(4, 1), (7, 1)], 31));
    assert_eq!((s.scenario.traffic.ignore_signs, s.scenario.traffic.ignore_lights), (0.005, 0.001));
    assert_eq!((s.scenario.agents.min_vehicles, s.scenario.agents.max_vehicles), (2, 5));
    assert_eq!(s.scenario.agents.vehicle_models, ["car.coupe", "car.coupe", "car.sedan"]);
    assert_eq!(s.scenario.agents.vehicle_colors, [[0, 0, 0], [255, 0, 255]]);
    assert_eq!((s.scenario.timing.max_duration_s, s.scenario.traffic.spawn_radius_m), (12.0, Some(450.0)));
    assert_eq!(
        (s.scenario.traffic.reckless_background, s.scenario.traffic.speed_difference),
        (0.05, Some(-0.1))
    );
    assert_eq!((s.bev.cells, s.scenario.lights.street_lamp_failure), (200, 0.25));
    let weather = [("cloudiness".to_owned(), 12.5.into()), ("sun_altitude_deg".to_owned(), (-20.0).into())];
    assert_eq!(s.scenario.weather.initial, weather);
    let scan = &s.scenario.vehicle_rig.lidars[0].scan;
    assert_eq!((scan.channels, scan.columns, s.scenario.vehicle_rig.lidars[0].noise_m), (64, 1024, 0.05));
    assert!(s.scenario.rsu_rig.lidars.is_empty() && s.scenario.rsu_rig.radars.iter().all(|r| r.rays == 1200));
    assert_eq!(s.scenario.rsu_rig.cameras[0].optics, Optics::pinhole(1600, 900, frames::deg(100.0)));
    assert!(s.scenario.vehicle_occupancy.ignore_self && !s.scenario.rsu_occupancy.ignore_self);
    assert!(!s.scenario.vehicle_occupancy.full_sweep && s.scenario.rsu_occupancy.full_sweep);
    let sweeps = &s.scenario.vehicle_occupancy.sweeps;
    assert_eq!((sweeps.z_top, sweeps.x_back, sweeps.x_front), (true, true, false));
    assert_eq!(sweeps.z_fill, ZFill::BoxSweep);
    assert_eq!(
        (s.scenario.agents.starts[0].xyz_m, s.scenario.agents.starts[0].map.as_str()),
        ([10.0, -20.0, 0.5], "Town01")
    );
    assert!((s.scenario.agents.starts[0].yaw_rad + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let said: String = warnings.iter().map(|w| format!("{w}\n")).collect();
    insta::assert_snapshot!(said, @r"
    x.yaml:1: `mode`: the scenes of `replacement_scene_config` become their first other draw; for further ones set [scenes.redraw] in a TOML configuration, as another `random_seed_offset` draws all scenes anew
    x.yaml:10: `vehicle_list`: no body like `zeppelin` here, `car.sedan` takes its place
    x.yaml:17: `host` has no effect here: there is no game engine and no window
    x.yaml:21: `initial_weather.snow`: no such weather parameter, ignored
    x.yaml:23: `rotation_frequency`: the lidar turns once a frame, 20 times a second
    x.yaml:27: there is one value for `vehicle.imu.noise_accel_mps2`: 0.0002 counts, 0.0003 does not
    x.yaml:29: `voxel_detector_properties.chunk_x` has no effect here
    x.yaml:33: `colour_of_the_sky`: no such key here, ignored
    ");
}

#[test]
fn faults_in_yaml_have_their_lines() {
    let faults = |text: &str| -> String {
        let faults = parse_yaml(text, "bad.yaml").expect_err("has faults");
        faults.iter().map(|f| format!("{f}\n")).collect()
    };
    let text = "train_scene_config: {Town01: many}\n\nmax_vehicles: -3\nlidar_channels: 0\n";
    insta::assert_snapshot!(faults(text), @r#"
    bad.yaml:1: `scenes.train.Town01` is a string, expected an integer
    bad.yaml:1: no scenes: add a table such as [scenes.train] with "convoy/demo" = 2
    bad.yaml:3: `agents.max_vehicles` is -3, expected 1 to 1000
    bad.yaml:4: `vehicle.lidar.channels` is 0, expected 1 to 1024
    "#);
    assert!(faults("max_vehicles: [1, 2\nmin_vehicles: 2\n").contains("broken YAML"));
    assert!(faults("- 1\n- 2\n").starts_with("bad.yaml:1: expected keys"));
    assert!(faults("").contains("no scenes"));
}

#[test]
fn weather_is_fixed_or_between_two_numbers_at_some_moments() {
    let scenes = "[scenes.train]\n\"convoy/demo\" = 1\n";
    let text = "[weather.initial]\ncloudiness = 20\nprecipitation = [0, 30]\nwetness = [7, 7]\n\
                [[weather.keyframes]]\nat_s = 1.5\ncloudiness = 90\n[[weather.keyframes]]\nat_s = 3\nfog_density = [1, 2]\n";
    let weather = parse(&format!("{scenes}{text}"), "a.toml").expect("is good").scenario.weather;
    let value = |name: &str, value: WeatherValue| (name.to_owned(), value);
    let initial = [
        value("cloudiness", 20.0.into()),
        value("precipitation", WeatherValue::Between([0.0, 30.0])),
        value("wetness", 7.0.into()),
    ];
    assert_eq!(weather.initial, initial);
    let keyframe = |at_s, values| WeatherKeyframe { at_s, values };
    let fog = value("fog_density", WeatherValue::Between([1.0, 2.0]));
    let keyframes = [keyframe(1.5, vec![value("cloudiness", 90.0.into())]), keyframe(3.0, vec![fog])];
    assert_eq!(weather.keyframes, keyframes);
    // As it is kept, and read again.
    let json = serde_json::to_string(&weather.keyframes[1].values).expect("is JSON");
    assert_eq!(json, r#"[["fog_density",[1.0,2.0]]]"#);
    let again: Vec<(String, WeatherValue)> = serde_json::from_str(&json).expect("reads");
    assert_eq!(again, weather.keyframes[1].values);
    let bad = "[weather.initial]\nwetness = [80, 20]\ndust_storm = [1, 2, 3]\ncloudiness = [3, 130]\nfog_density = 5\n\
               [[weather.keyframes]]\nat_s = 0\nfog_density = 7\n[[weather.keyframes]]\nprecipitation = 2\n\
               [[weather.keyframes]]\nat_s = 9\nrain = 3\n[[weather.keyframes]]\nat_s = 9\n";
    insta::assert_snapshot!(faults(&format!("{scenes}{bad}")), @r"
    bad.toml:4: `weather.initial.wetness` is [80, 20], expected the least first
    bad.toml:5: `weather.initial.dust_storm` is an array, expected a number, or two: [least, most]
    bad.toml:6: `weather.initial.cloudiness` is 130, expected 0 to 100
    bad.toml:10: `weather.keyframes[0].fog_density` is at 0 s, as `weather.initial.fog_density` is: leave one of them out
    bad.toml:11: `weather.keyframes[1].at_s` is missing: when is it, in seconds?
    bad.toml:11: `weather.keyframes[1].at_s` is 0, not after the one before it (0)
    bad.toml:15: unknown key `weather.keyframes[2].rain`; there are at_s, cloudiness, dust_storm, fog_density, fog_distance_m, fog_falloff, mie_scattering_scale, precipitation, precipitation_deposits, rayleigh_scattering_scale, scattering_intensity, sun_altitude_deg, sun_azimuth_deg, wetness, wind_intensity
    bad.toml:17: `weather.keyframes[3].at_s` is 9, not after the one before it (9)
    ");
}

#[test]
fn switches_in_yaml_bring_the_defaults_they_switch_to() {
    let with = |keys: &str| {
        let text = format!("train_scene_config: {{convoy/demo: 1}}\n{keys}\n");
        let (s, warnings) = parse_yaml(&text, "x.yaml").expect("is valid");
        assert!(warnings.is_empty(), "{warnings:?}");
        (s.scenario.traffic.spawn_radius_m, s.scenario.lights.street_lamp_failure)
    };
    assert_eq!(with("npc_spawn_radius: 450"), (None, 0.1));
    assert_eq!(with("dynamic_settings_adjustments: True\nnpc_spawn_radius: 450"), (None, 0.1));
    assert_eq!(with("dynamic_settings_adjustments: False\nnpc_spawn_radius: 450"), (Some(450.0), 0.1));
    let off = "dynamic_settings_adjustments: False\nrandom_street_light_failure: False";
    assert_eq!(with(off), (Some(600.0), 0.0));
    let both = "street_light_failure_percentage: 30\nrandom_street_light_failure: ";
    assert_eq!(with(&format!("{both}False")), (None, 0.0));
    assert_eq!(with(&format!("{both}True")), (None, 0.3));
    let awake = |adjusted: &str| {
        let text = format!(
            "train_scene_config: {{convoy/demo: 1}}\ndynamic_settings_adjustments: {adjusted}\nactor_active_distance: 800\n"
        );
        parse_yaml(&text, "x.yaml").expect("is valid").0.scenario.traffic.active_distance_m
    };
    assert_eq!([awake("True"), awake("False")], [1600.0, 800.0]);
    let collected = |adjusted: &str| {
        let text = format!(
            "train_scene_config: {{convoy/demo: 1}}\ndynamic_settings_adjustments: {adjusted}\nmapping_area_radius: 800\n"
        );
        parse_yaml(&text, "x.yaml").expect("is valid").0.bev.lane_radius_m
    };
    assert_eq!([collected("True"), collected("False")], [None, Some(800.0)]);
}

#[test]
fn a_yaml_with_nothing_but_scenes_has_our_defaults() {
    let (s, warnings) = parse_yaml("train_scene_config: {convoy/demo: 1}\n", "x.yaml").expect("is valid");
    assert_eq!((s, warnings.len()), (example_settings(), 0));
}

#[test]
fn the_published_plan_has_its_sizes() {
    let text = include_str!("../../../../../configs/simbev2x-full.toml");
    let s = parse(text, "simbev2x-full.toml").expect("is valid");
    let of = |split| s.scenes.iter().filter(|w| w.split == split).map(|w| w.count).sum::<u32>();
    assert_eq!(Split::ALL.map(of), [168, 30, 60]);
    let of_map =
        |map: &str| -> Vec<u32> { s.scenes.iter().filter(|w| w.map == map).map(|w| w.count).collect() };
    assert_eq!([of_map("convoy/01"), of_map("convoy/05")], [[8, 1, 2], [16, 2, 4]]);
    assert_eq!([of_map("convoy/09"), of_map("convoy/10")], [[32, 4, 8], [0, 8, 16]]);
    let defaults = example_settings();
    assert_eq!(
        DatasetSettings { name: defaults.name.clone(), scenes: defaults.scenes.clone(), ..s },
        defaults
    );
}

#[test]
fn sensors_can_be_moved_added_and_switched_off() {
    let text = "[scenes.train]\n\"convoy/demo\" = 1\n[vehicle.lidar]\nsemantic = true\nchannels = 32\n\
                [rsu.radar]\nenabled = false\n[rsu.camera]\nenabled = false\n[vehicle.gnss]\nenabled = false\n\
                [[vehicle.cameras]]\nname = \"CAM_ROOF\"\nxyz_m = [0, 0, 2.5]\nrpy_deg = [0, 15, 180]\n";
    let s = parse(text, "x.toml").expect("is valid");
    let names: Vec<&str> = s.scenario.vehicle_rig.lidars.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["LIDAR", "SEG-LIDAR"]);
    assert_eq!(s.scenario.vehicle_rig.lidars[0].scan.channels, 32);
    assert_eq!(s.scenario.vehicle_rig.cameras.len(), 1);
    assert!((s.scenario.vehicle_rig.cameras[0].mount.rpy_rad[2] - std::f64::consts::PI).abs() < 1e-12);
    assert!(s.scenario.rsu_rig.radars.is_empty() && s.scenario.vehicle_rig.gnss.is_none());
    assert!(
        s.scenario.rsu_rig.cameras.is_empty()
            && !DatasetSettings::default().scenario.rsu_rig.cameras.is_empty()
    );
}
