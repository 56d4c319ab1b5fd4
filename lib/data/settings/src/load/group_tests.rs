//! Groups of scenes: what they have of their own, what they share, what is said of bad ones.

use super::*;
use crate::Split;

const TOP: &str = "seed = 3\n[traffic]\nvehicles = 40\n[vehicle.lidar]\nchannels = 64\n[bev]\ncells = 200\n";

fn faults(text: &str) -> String {
    let faults = parse(text, "bad.toml").expect_err("has faults");
    faults.iter().map(|f| format!("{f}\n")).collect()
}

#[test]
fn a_group_has_what_it_says_and_the_rest_from_the_top() {
    let text = format!(
        "{TOP}[scenes.train]\n\"convoy/01\" = 2\n[[groups]]\nname = \"night\"\n[groups.scenes.val]\n\"convoy/02\" = 3\n\
         [groups.weather.initial]\nsun_altitude_deg = -20\n[groups.vehicle.lidar]\nrange_m = 50\n[[groups.rigs]]\n\
         agents = [\"vehicle_1\"]\n[groups.rigs.gnss]\nenabled = false\n[[groups]]\nname = \"empty\"\n[groups.traffic]\nvehicles = 0\n"
    );
    let all = parse(&text, "x.toml").unwrap_or_else(|faults| panic!("{faults:?}"));
    let [night, empty] = all.groups.as_slice() else { panic!("two groups: {:?}", all.groups) };
    assert_eq!((night.name.as_str(), empty.name.as_str()), ("night", "empty"));
    assert_eq!((night.scenes.len(), night.scenes[0].split, night.scenes[0].count), (1, Split::Val, 3));
    assert!(empty.scenes.is_empty());
    let of = |name: &str| all.of_group(name).expect("is there");
    assert_eq!(of("").scenario, all.scenario);
    assert_eq!(all.of_group("day"), None);
    let (night, empty) = (of("night"), of("empty"));
    assert_eq!((night.seed, night.bev.cells), (3, 200));
    assert_eq!(night.scenario.traffic.vehicles, Some(40));
    assert_eq!(empty.scenario.traffic.vehicles, Some(0));
    assert_eq!(night.scenario.weather.initial, [("sun_altitude_deg".to_owned(), (-20.0).into())]);
    assert!(empty.scenario.weather.initial.is_empty() && all.scenario.weather.initial.is_empty());
    let lidar = |settings: &DatasetSettings| {
        let lidar = &settings.scenario.vehicle_rig.lidars[0];
        (lidar.scan.channels, lidar.range_m)
    };
    assert_eq!(lidar(&night), (64, 50.0));
    assert_eq!(lidar(&empty), lidar(&all));
    assert_eq!((night.scenario.own_rigs.len(), empty.scenario.own_rigs.len()), (1, 0));
}

#[test]
fn a_group_alone_is_scenes_enough() {
    let group =
        |count: u32| format!("[[groups]]\nname = \"a\"\n[groups.scenes.train]\n\"convoy/01\" = {count}\n");
    assert!(parse(&group(1), "x.toml").is_ok_and(|all| all.scenes.is_empty()));
    assert!(faults(&group(0)).contains("no scenes"));
}

#[test]
fn faults_of_groups_are_named_with_their_lines() {
    let text = "[scenes.train]\n\"convoy/01\" = 2\n[traffic]\nvehicles = -1\n[agents]\nmin_vehicles = 3\n[[groups]]\n\
                name = \"a b\"\n[groups.agents]\nmax_vehicles = 2\n[groups.bev]\ncells = 100\n[groups.walkers]\ncuont = 3\n\
                [[groups]]\nname = \"twice\"\n[groups.vehicle.lidar]\nchannels = 0\n[[groups]]\nname = \"twice\"\nnight = true\n";
    insta::assert_snapshot!(faults(text), @r#"
    bad.toml:4: `traffic.vehicles` is -1, expected 0 to 20000
    bad.toml:6: `groups[0].agents.min_vehicles` is 3, more than `groups[0].agents.max_vehicles` (2)
    bad.toml:8: `groups[0].name` is "a b", expected letters, digits, _ and -
    bad.toml:11: `groups[0].bev`: groups have no `bev` of their own, it stands at the top
    bad.toml:14: unknown key `groups[0].walkers.cuont` (did you mean `count`?)
    bad.toml:18: `groups[1].vehicle.lidar.channels` is 0, expected 1 to 1024
    bad.toml:20: `groups[2].name`: another group is named "twice", too
    bad.toml:21: unknown key `groups[2].night` (did you mean `lights`?)
    "#);
}

#[test]
fn a_groups_rig_file_takes_the_place_of_the_one_at_the_top() {
    let folder = tempfile::tempdir().expect("is made");
    std::fs::write(folder.path().join("short.toml"), "[lidar]\nrange_m = 30\nchannels = 8\n")
        .expect("is written");
    std::fs::write(folder.path().join("wide.toml"), "[lidar]\nrange_m = 300\ncolumns = 99\n")
        .expect("is written");
    let text = "[scenes.train]\n\"convoy/01\" = 2\n[vehicle]\nrig = \"wide.toml\"\n[vehicle.lidar]\nchannels = 16\n\
                [[groups]]\nname = \"a\"\n[groups.vehicle]\nrig = \"short.toml\"\n[[groups]]\nname = \"b\"\n";
    let path = folder.path().join("x.toml").display().to_string();
    let all = parse(text, &path).unwrap_or_else(|faults| panic!("{faults:?}"));
    let lidar = |group: &str| {
        let lidar = &all.of_group(group).expect("is there").scenario.vehicle_rig.lidars[0];
        (lidar.range_m, lidar.scan.channels, lidar.scan.columns)
    };
    assert_eq!([lidar(""), lidar("a"), lidar("b")], [(300.0, 16, 99), (30.0, 8, 2048), (300.0, 16, 99)]);
}
