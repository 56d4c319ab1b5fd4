//! What is said of configurations that are good, and hardly meant.

use super::*;

/// What is suspicious in a configuration, a line each.
fn said(text: &str) -> String {
    let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n{text}");
    let (_, warnings) = parse_whole(&text, "odd.toml", false).expect("is good");
    warnings.iter().map(|w| format!("{w}\n")).collect()
}

#[test]
fn percents_that_look_like_shares_are_said() {
    let text = "[weather.initial]\nprecipitation = 0.7\nfog_falloff = 0.7\nwetness = 0\nsun_altitude_deg = 0.5\n\
                [weather.final]\ncloudiness = 1\nfog_density = 1.5\n\
                [[weather.keyframes]]\nat_s = 1\nwetness = [0.2, 0.5]\nprecipitation = [0.5, 20]\n\
                [[weather.keyframes]]\nat_s = 33\n";
    insta::assert_snapshot!(said(text), @r"
    odd.toml:4: `weather.initial.precipitation` is 0.7 of 100 percent, next to nothing: write 70 if a share is meant
    odd.toml:9: `weather.final.cloudiness` is 1 of 100 percent, next to nothing: write 100 if a share is meant
    odd.toml:13: `weather.keyframes[0].wetness` is [0.2, 0.5] of 100 percent, next to nothing: write [20.0, 50.0] if a share is meant
    odd.toml:16: `weather.keyframes[1].at_s` is 33: scenes end before, at `timing.max_duration_s` = 32
    ");
}

#[test]
fn percents_of_yaml_that_look_like_shares_are_said() {
    let text = "train_scene_config: {convoy/demo: 1}\ninitial_weather: {cloudiness: 0.25}\n\
                reckless_npc_percentage: 0.5\ndoor_open_percentage: 0.1\n";
    let (_, warnings) = parse_yaml(text, "odd.yaml").expect("is good");
    let said: String = warnings.iter().map(|w| format!("{w}\n")).collect();
    insta::assert_snapshot!(said, @r"
    odd.yaml:4: `door_open_percentage` is 0.1 of 100 percent, next to nothing: write 10 if a share is meant
    odd.yaml:2: `weather.initial.cloudiness` is 0.25 of 100 percent, next to nothing: write 25 if a share is meant
    ");
}

#[test]
fn rigs_of_agents_that_no_scene_has_are_said() {
    let rigs =
        "[[rigs]]\nagents = [\"vehicle_2\", \"vehicle_3\"]\n[[rigs]]\nagents = [\"rsu_0\", \"rsu_1\"]\n";
    let agents = |keys: &str| said(&format!("[agents]\n{keys}\n{rigs}"));
    insta::assert_snapshot!(agents("max_vehicles = 3\nmax_rsus = 1"), @r"
    odd.toml:7: `rigs[0].agents`: no scene has `vehicle_3`: `agents.max_vehicles` allows 3, numbers 0 to 2
    odd.toml:9: `rigs[1].agents`: no scene has `rsu_1`: `agents.max_rsus` allows one, number 0
    ");
    insta::assert_snapshot!(agents("max_rsus = 0"), @r"
    odd.toml:8: `rigs[1].agents`: no scene has `rsu_0`: `agents.max_rsus` allows none
    odd.toml:8: `rigs[1].agents`: no scene has `rsu_1`: `agents.max_rsus` allows none
    ");
    insta::assert_snapshot!(agents("penetration = 0.03\n[traffic]\nvehicles = 100"), @r"
    odd.toml:8: `rigs[0].agents`: no scene has `vehicle_3`: `agents.penetration` allows 3, numbers 0 to 2
    ");
    let start = "\n[[agents.starts]]\nmap = \"convoy/demo\"\n";
    insta::assert_snapshot!(agents(&start.repeat(3)), @r"
    odd.toml:15: `rigs[0].agents`: no scene has `vehicle_3`: `agents.starts` allows 3, numbers 0 to 2
    ");
    let elsewhere = agents(&start.replace("convoy/demo", "maps/Town01.xodr"));
    insta::assert_snapshot!(elsewhere, @"odd.toml:6: `agents.starts[0].map`: there are no scenes on `maps/Town01.xodr`");
}

#[test]
fn places_that_no_scene_uses_are_said() {
    let text = "[agents]\nmax_rsus = 1\n[[agents.rsus_at]]\n[[agents.rsus_at]]\n[[agents.rsus_at]]\nmap = \"Town02\"\n";
    insta::assert_snapshot!(said(text), @r"
    odd.toml:5: `agents.rsus_at` has 3 places, and no scene has more than `agents.max_rsus` = 1 RSUs
    odd.toml:8: `agents.rsus_at[2].map`: there are no scenes on `Town02`
    ");
    let enough = "[[agents.rsus_at]]\n[[agents.rsus_at]]\nxyz_m = [1, 2, 3]\nyaw_deg = 90\n";
    assert_eq!(said(enough), "");
}

#[test]
fn tables_without_effect_are_said() {
    let text = "[agents]\nmax_rsus = 0\n[weather]\ndynamic = false\n[weather.final]\nwetness = 20\n\
                [bev]\nenabled = false\ncells = 200\n[tracks]\nwindows = false\n\
                [vehicle.camera]\nenabled = false\nwidth = 640\n[[vehicle.cameras]]\nname = \"CAM\"\n\
                [vehicle.gnss]\nenabled = false\n[vehicle.imu]\nenabled = false\ngyro_bias_radps = 0.1\n\
                [vehicle.lidar]\nweather_detected = 0.2\nrolling_slices = 8\n\
                [vehicle.occupancy]\nenabled = false\nvoxel_m = 0.4\n[rsu.lidar]\nchannels = 16\n";
    insta::assert_snapshot!(said(text), @r"
    odd.toml:7: `weather.final` has no effect: `weather.dynamic` is false
    odd.toml:9: `bev` has no effect: `bev.enabled` is false
    odd.toml:14: `vehicle.camera` has no effect: `vehicle.camera.enabled` is false
    odd.toml:17: `vehicle.cameras` has no effect: `vehicle.camera.enabled` is false
    odd.toml:21: `vehicle.imu` has no effect: `vehicle.imu.enabled` is false
    odd.toml:25: `vehicle.lidar.weather_detected` has no effect: `vehicle.lidar.weather` is false
    odd.toml:26: `vehicle.lidar.rolling_slices` has no effect: `vehicle.lidar.rolling` is false
    odd.toml:27: `vehicle.occupancy` has no effect: `vehicle.occupancy.enabled` is false
    odd.toml:30: `rsu` has no effect: `agents.max_rsus` is 0
    ");
    let more = "[tracks]\nwindows = false\npast_s = 1\n[vehicle.radar]\nenabled = false\nrays = 9\n\
                [[vehicle.radars]]\nname = \"FRONT\"\n[rsu.lidar]\nenabled = false\nchannels = 16\n\
                [vehicle.lidar]\nrolling_compensated = false\n[rsu.imu]\nenabled = false\n";
    insta::assert_snapshot!("further-tables-without-effect", said(more));
    let of_group = "[[groups]]\nname = \"rain\"\n[groups.scenes.train]\n\"convoy/demo\" = 1\n\
                    [groups.weather.initial]\nwetness = 0.5\n[[groups.rigs]]\nagents = [\"rsu_9\"]\n";
    insta::assert_snapshot!("suspicions-of-a-group", said(of_group));
    // RSUs have no receiver by default.
    insta::assert_snapshot!(said("[rsu.gnss]\nnoise_altitude_m = 0.5\n"), @"odd.toml:3: `rsu.gnss` has no effect: `rsu.gnss.enabled` is false");
    let switched_on =
        "[rsu.gnss]\nenabled = true\nnoise_altitude_m = 0.5\n[vehicle.lidar]\nenabled = false\n";
    assert_eq!(said(switched_on), "");
}

#[test]
fn sensors_that_do_not_say_where_they_are_are_said() {
    let text = "[[vehicle.lidars]]\nname = \"FRONT\"\n[[vehicle.lidars]]\nname = \"LEFT\"\nxyz_m = [0, 1, 1]\n\
                [[vehicle.lidars]]\nname = \"LABELS\"\nenabled = false\nsemantic = true\n[[vehicle.lidars]]\n\
                name = \"OFF\"\nenabled = false\n[[rsu.radars]]\nname = \"RAD\"\n[[rigs]]\nagents = [\"vehicle_1\"]\n\
                [[rigs.cameras]]\nname = \"A\"\nxyz_m = [1, 0, 1]\n[[rigs.cameras]]\nname = \"B\"\n";
    insta::assert_snapshot!(said(text), @r"
    odd.toml:3: `vehicle.lidars[0]` does not say where it is: it is at `xyz_m = [0.0, 0.0, 1.8]`
    odd.toml:8: `vehicle.lidars[2]` does not say where it is: it is at `xyz_m = [0.0, 0.0, 1.8]`
    odd.toml:15: `rsu.radars[0]` does not say where it is: it is at `xyz_m = [0.0, 0.0, 1.2]`
    odd.toml:22: `rigs[0].cameras[1]` does not say where it is: it is at `xyz_m = [0.4, 0.4, 1.6]`
    ");
    let groups = "[[vehicle.radars]]\nname = \"A\"\n[[groups]]\nname = \"one\"\n[groups.scenes.train]\n\
                  \"convoy/demo\" = 1\n[[groups.vehicle.lidars]]\nname = \"FRONT\"\n[[groups.vehicle.lidars]]\n\
                  name = \"BACK\"\nxyz_m = [-1, 0, 1]\n[[groups]]\nname = \"two\"\n[groups.scenes.train]\n\
                  \"convoy/demo\" = 1\n";
    insta::assert_snapshot!(said(groups), @r"
    odd.toml:3: `vehicle.radars[0]` does not say where it is: it is at `xyz_m = [0.0, 1.0, 0.6]`
    odd.toml:9: `groups[0].vehicle.lidars[0]` does not say where it is: it is at `xyz_m = [0.0, 0.0, 1.8]`
    ");
}

#[test]
fn shipped_configurations_are_above_suspicion() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../configs");
    let files = std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path());
    let files: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert!(files.len() >= 7);
    for file in files {
        let (_, warnings) = load(&file).expect("is good");
        assert_eq!(warnings, [], "{}", file.display());
    }
}

#[test]
fn suspicions_from_elsewhere_have_the_lines_of_their_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = |name: &str, text: &str, keys: &[&str]| -> Vec<Option<usize>> {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("is written");
        let message = "is odd".to_owned();
        let found = keys.iter().map(|key| Suspicion { key: (*key).to_owned(), message: message.clone() });
        let said = suspicions_in(&path, &found.collect::<Vec<_>>());
        assert!(said.iter().all(|s| s.file == path.display().to_string() && s.message == message));
        said.iter().map(|s| s.line).collect()
    };
    let toml = "seed = 1\n[vehicle.lidar]\nchannels = 4\n[[rigs]]\n[[rigs]]\nagents = [\"rsu_0\"]\n";
    let keys = ["vehicle.lidar.weather", "vehicle.lidar.channels", "rigs[1].agents", "rsu.lidar", "seed.x"];
    assert_eq!(lines("a.toml", toml, &keys), [Some(2), Some(3), Some(6), None, Some(1)]);
    let yaml = "random_seed_offset: 1\n\nlidar_channels: 64\nmax_rsus: 2\n";
    let keys = ["vehicle.lidar.weather", "agents.max_rsus", "traffic"];
    assert_eq!(lines("a.yaml", yaml, &keys), [Some(3), Some(4), None]);
}
