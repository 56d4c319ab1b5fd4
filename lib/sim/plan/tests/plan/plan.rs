//! Plans on hand-made networks and, where they are at hand, on real maps.

use std::collections::{BTreeMap, BTreeSet};

use catalogue::Catalogue;
use nalgebra::Point3;
use opendrive::{Cubic, Lane, LaneSection, LaneType, Map};
use plan::{
    PlanError, PlanMap, PlanSources, SceneSlot, SpawnPool, TrackFiles, plan, plan_scene, scene_slots,
};
use proptest::prelude::*;
use settings::stages::PlanSettings;
use settings::{GivenRsu, GivenStart, SceneCount, SpawnMode, Split};
use testkit::{real_map, road, straight_road};

fn settings(scenes: &[(Split, &str, u32)]) -> PlanSettings {
    let count = |&(split, map, count): &(Split, &str, u32)| SceneCount { split, map: map.into(), count };
    PlanSettings::with_scenes(scenes.iter().map(count).collect())
}

/// The built-in models, and no trajectories.
fn built_in() -> PlanSources<'static> {
    static NONE: TrackFiles = TrackFiles::new();
    PlanSources { catalogue: Catalogue::built_in(), tracks: &NONE }
}

/// A straight road to the east with one lane each way.
fn straight(length_m: f64, lane_type: LaneType) -> Map {
    testkit::map(vec![straight_road(length_m, &[(lane_type, 3.5)])])
}

fn maps(entries: Vec<(&str, Map)>) -> BTreeMap<String, PlanMap> {
    entries
        .into_iter()
        .map(|(name, map)| (name.to_owned(), PlanMap { map, hash: format!("hash of {name}") }))
        .collect()
}

#[test]
fn pool_of_a_straight_road_is_regular() {
    let pool = SpawnPool::new(&straight(200.0, LaneType::Driving), 24.0);
    // 0, 24, ..., 192 in each direction; the last has 8 m ahead.
    assert_eq!(pool.points.len(), 18);
    let east: Vec<f64> = pool.points[..9].iter().map(|p| p.xyz_m.x).collect();
    assert_eq!(east, (0..9).map(|i| 24.0 * f64::from(i)).collect::<Vec<_>>());
    assert!(pool.points[..9].iter().all(|p| p.xyz_m.y == -1.75 && p.rpy_rad[2].abs() < 1e-9));
    assert!(
        pool.points[9..]
            .iter()
            .all(|p| p.xyz_m.y == 1.75 && (p.rpy_rad[2].abs() - std::f64::consts::PI).abs() < 1e-9)
    );
}

#[test]
fn narrow_places_are_no_spawn_points() {
    // 3.5 m at the beginning, a centimetre less each metre: 2.6 m are left at 90 m.
    let narrowing = |id| Lane {
        id,
        lane_type: LaneType::Driving,
        widths: vec![Cubic { a: 3.5, b: -0.01, ..Cubic::default() }],
        ..Lane::default()
    };
    let section = LaneSection { right: vec![narrowing(-1)], ..LaneSection::default() };
    let pool = SpawnPool::new(&testkit::map(vec![road("1", [0.0; 2], 0.0, 200.0, section)]), 24.0);
    let at: Vec<f64> = pool.points.iter().map(|p| p.xyz_m.x).collect();
    assert_eq!(at, [0.0, 24.0, 48.0, 72.0]);
}

#[test]
fn missing_rsus_are_said() {
    let mut settings = settings(&[(Split::Train, "road", 1)]);
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (1, 1);
    let maps = maps(vec![("road", straight(400.0, LaneType::Driving)), ("town", testkit::crossing(true))]);
    for wanted in [0, 200] {
        (settings.agents.min_rsus, settings.agents.max_rsus) = (wanted, wanted);
        // Of a map without lights it is said once, for all its scenes.
        let rural = plan(&settings, &maps).expect("a plan");
        assert_eq!((rural.agents.len(), rural.warnings.len()), (1, 0));
        let said = plan::suspicions::without_lights(&settings.agents, &maps);
        assert_eq!(said.len(), usize::from(wanted > 0));
        for suspicion in said {
            assert_eq!(suspicion.key, "agents.max_rsus");
            insta::assert_snapshot!(suspicion.message, @"`agents.max_rsus` is 200, and `road` has no traffic light at a junction: scenes there have no RSUs but where `agents.rsus_at` puts them");
        }
        let wish = SceneCount { split: Split::Train, map: "town".into(), count: 1 };
        let urban = plan(&PlanSettings { scenes: vec![wish], ..settings.clone() }, &maps).expect("a plan");
        let said =
            urban.warnings.iter().any(|w| w.contains("scene 0 (town): ") && w.contains(" of 200 RSUs"));
        assert_eq!((urban.warnings.len(), said), if wanted == 0 { (0, false) } else { (1, true) });
    }
}

#[test]
fn scenes_are_numbered_train_val_test() {
    let settings = settings(&[
        (Split::Test, "a", 1),
        (Split::Train, "b", 2),
        (Split::Train, "a", 1),
        (Split::Val, "a", 1),
    ]);
    let slots = scene_slots(&settings).expect("few scenes");
    let short: Vec<_> = slots.iter().map(|s| (s.scene, s.split, s.map.as_str())).collect();
    let expected = [
        (0, Split::Train, "b"),
        (1, Split::Train, "b"),
        (2, Split::Train, "a"),
        (3, Split::Val, "a"),
        (4, Split::Test, "a"),
    ];
    assert_eq!(short, expected);
}

#[test]
fn a_scene_planned_alone_is_the_same() {
    let settings = settings(&[(Split::Train, "road", 3), (Split::Val, "other", 2)]);
    let maps = maps(vec![
        ("road", straight(400.0, LaneType::Driving)),
        ("other", straight(900.0, LaneType::Driving)),
    ]);
    let whole = plan(&settings, &maps).expect("a plan");
    assert_eq!(whole.scenes.len(), 5);
    for slot in scene_slots(&settings).expect("few scenes").iter().rev() {
        let map = &maps[&slot.map];
        let pool = SpawnPool::new(&map.map, settings.agents.spawn_separation_m);
        let alone = plan_scene(&settings, slot, map, &pool, &built_in()).expect("a scene");
        assert_eq!(alone.scene, whole.scenes[slot.scene as usize]);
        let agents: Vec<_> = whole.agents.iter().filter(|a| a.scene == slot.scene).cloned().collect();
        assert_eq!(alone.agents, agents);
    }
    assert_eq!(whole.scenes[4].map_hash, "hash of other");
    assert_eq!(whole.scenes[4].seed, 27 + 4);
}

#[test]
fn a_new_wish_in_one_topic_moves_no_other() {
    let base = settings(&[(Split::Train, "road", 4)]);
    let maps = maps(vec![("road", straight(800.0, LaneType::Driving))]);
    let before = plan(&base, &maps).expect("a plan");
    let mut changed = base.clone();
    changed.weather.initial = vec![("cloudiness".into(), 1.0.into())];
    changed.walkers.count = Some(7);
    let after = plan(&changed, &maps).expect("a plan");
    assert_eq!(before.agents, after.agents);
    for (a, b) in before.scenes.iter().zip(&after.scenes) {
        assert_eq!(
            (a.duration_s, a.final_weather, a.walker_cross_factor),
            (b.duration_s, b.final_weather, b.walker_cross_factor)
        );
        assert_eq!((b.initial_weather.cloudiness, b.walkers), (1.0, 7));
        assert_eq!(a.initial_weather.to_array()[1..], b.initial_weather.to_array()[1..]);
    }
}

#[test]
fn faults_name_the_map_and_the_way_out() {
    let text = |result: Result<plan::Plan, PlanError>| result.expect_err("a fault").to_string();
    let unknown = text(plan(
        &settings(&[(Split::Train, "mars", 1)]),
        &maps(vec![("road", straight(100.0, LaneType::Driving))]),
    ));
    assert!(unknown.contains("mars") && unknown.contains("road"), "{unknown}");
    let no_lanes = text(plan(
        &settings(&[(Split::Train, "path", 1)]),
        &maps(vec![("path", straight(100.0, LaneType::Sidewalk))]),
    ));
    assert!(no_lanes.contains("path") && no_lanes.contains("no driving lanes"), "{no_lanes}");
    let no_points = text(plan(
        &settings(&[(Split::Train, "stub", 1)]),
        &maps(vec![("stub", straight(3.0, LaneType::Driving))]),
    ));
    assert!(no_points.contains("stub") && no_points.contains("no spawn points"), "{no_points}");
    let mut odd = settings(&[(Split::Train, "road", 1)]);
    odd.agents.vehicle_models = vec!["walker.man".into()];
    assert!(matches!(
        plan(&odd, &maps(vec![("road", straight(100.0, LaneType::Driving))])),
        Err(PlanError::UnknownModel { .. })
    ));
}

#[test]
fn too_few_points_give_fewer_vehicles_and_a_warning() {
    let mut settings = settings(&[(Split::Train, "road", 1)]);
    settings.agents.min_vehicles = 8;
    settings.agents.max_rsus = 0;
    let plan = plan(&settings, &maps(vec![("road", straight(30.0, LaneType::Driving))])).expect("a plan");
    assert!(plan.agents.len() < 8 && !plan.agents.is_empty());
    assert!(plan.warnings.len() == 1 && plan.warnings[0].contains("scene 0 (road)"), "{:?}", plan.warnings);
}

#[test]
fn given_rsus_come_before_those_at_lights_and_count() {
    let mut settings = settings(&[(Split::Train, "town", 6), (Split::Train, "road", 1)]);
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (2, 2);
    (settings.agents.min_rsus, settings.agents.max_rsus) = (4, 4);
    settings.agents.clustered_spawn_distance_m = 1000.0;
    settings.agents.chained_spawn_distance_m = 1000.0;
    let both = || maps(vec![("town", testkit::crossing(true)), ("road", straight(400.0, LaneType::Driving))]);
    let drawn = plan(&settings, &both()).expect("a plan");
    let rsu =
        |map: &str, x: f64, y: f64, yaw_rad: f64| GivenRsu { map: map.into(), xyz_m: [x, y, 0.2], yaw_rad };
    settings.agents.rsus_at =
        vec![rsu("town", 20.0, -30.0, 1.0), rsu("road", 60.0, 9.0, -1.5), rsu("town", 0.0, 31.0, -2.0)];
    let given = plan(&settings, &both()).expect("a plan");
    assert_eq!(given.scenes, drawn.scenes);
    let rsus = |plan: &plan::Plan, scene: u32| -> Vec<schema::tables::PlanAgentRow> {
        let here = plan.agents.iter().filter(|a| a.scene == scene);
        here.filter(|a| a.agent.kind == schema::AgentKind::Rsu).cloned().collect()
    };
    for scene in 0..6 {
        let (before, now) = (rsus(&drawn, scene), rsus(&given, scene));
        assert_eq!(now.len(), 4);
        let place =
            |a: &schema::tables::PlanAgentRow| (a.agent.index, a.xyz_m, a.rpy_rad[2], a.signal.clone());
        assert_eq!(place(&now[0]), (0, [20.0, -30.0, 0.2], 1.0, None));
        assert_eq!(place(&now[1]), (1, [0.0, 31.0, 0.2], -2.0, None));
        // Those at lights are the first that would have been drawn without the others.
        let lights = |rsus: &[schema::tables::PlanAgentRow]| -> Vec<(Option<String>, [f64; 3])> {
            rsus.iter().map(|a| (a.signal.clone(), a.xyz_m)).collect()
        };
        assert_eq!(lights(&now[2..]), lights(&before[..2]));
    }
    // A map without lights has those that are given.
    let rural = rsus(&given, 6);
    assert_eq!(rural.iter().map(|a| a.xyz_m).collect::<Vec<_>>(), [[60.0, 9.0, 0.2]]);
    assert!(given.warnings.iter().any(|w| w.contains("scene 6 (road): 1 of 4 RSUs")), "{:?}", given.warnings);
    assert_eq!(plan::suspicions::without_lights(&settings.agents, &both()), []);
    // Fewer are wished for than given: the first.
    (settings.agents.min_rsus, settings.agents.max_rsus) = (1, 1);
    let fewer = plan(&settings, &both()).expect("a plan");
    assert_eq!(rsus(&fewer, 3).iter().map(|a| a.xyz_m).collect::<Vec<_>>(), [[20.0, -30.0, 0.2]]);
}

#[test]
fn odd_places_of_rsus_are_said() {
    let mut settings = settings(&[(Split::Train, "road", 1)]);
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (1, 1);
    (settings.agents.min_rsus, settings.agents.max_rsus) = (2, 2);
    settings.agents.starts = vec![GivenStart { map: "road".into(), xyz_m: [50.0, -1.75, 0.0], yaw_rad: 0.0 }];
    settings.traffic.spawn_radius_m = Some(200.0);
    let at = |x: f64, y: f64| GivenRsu { map: "road".into(), xyz_m: [x, y, 0.0], yaw_rad: 0.0 };
    settings.agents.rsus_at = vec![at(60.0, -2.0), at(350.0, 8.0)];
    let maps = maps(vec![("road", straight(400.0, LaneType::Driving))]);
    let said = plan(&settings, &maps).expect("a plan").warnings.join("\n");
    insta::assert_snapshot!(said, @r"
    scene 0 (road): rsu_0 (agents.rsus_at) stands on a lane for vehicles, at 60, -2: they drive through it
    scene 0 (road): rsu_1 (agents.rsus_at) stands 300 m from the nearest vehicle's start, and traffic starts within 200 m of vehicles: give `agents.starts` near it
    ");
    settings.agents.rsus_at = vec![at(60.0, -6.0), at(150.0, 8.0)];
    assert_eq!(plan(&settings, &maps).expect("a plan").warnings, [""; 0]);
}

#[test]
fn given_starts_replace_the_pool() {
    let mut settings = settings(&[(Split::Train, "road", 30), (Split::Train, "other", 1)]);
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (3, 3);
    let start = |x: f64, y: f64, yaw_rad: f64| GivenStart { map: "road".into(), xyz_m: [x, y, 0.4], yaw_rad };
    // The lanes' centres are 1.75 m to either side; to the west one drives on the north side.
    settings.agents.starts = vec![start(50.0, -1.0, 0.2), start(90.0, -3.0, 0.0), start(70.0, 0.5, 3.0)];
    let road = || straight(400.0, LaneType::Driving);
    let both = maps(vec![("road", road()), ("other", road())]);
    let planned = plan(&settings, &both).expect("a plan");
    let expected = [[50.0, -1.75], [90.0, -1.75], [70.0, 1.75]];
    for agent in planned.agents.iter().filter(|a| a.scene < 30) {
        let near =
            |e: &[f64; 2]| (agent.xyz_m[0] - e[0]).abs() < 1e-6 && (agent.xyz_m[1] - e[1]).abs() < 1e-6;
        assert!(expected.iter().any(near), "{agent:?}");
        assert_eq!(agent.xyz_m[1] > 0.0, agent.rpy_rad[2].abs() > 3.0);
    }
    let first = planned.agents.iter().filter(|a| a.scene < 30 && a.agent == schema::AgentId::vehicle(0));
    let first: BTreeSet<i64> = first.map(|a| a.xyz_m[0].round() as i64).collect();
    assert_eq!(first, [50, 90, 70].into(), "every start is used, and no other");
    // One start, one vehicle.
    settings.agents.starts.truncate(1);
    let alone = plan(&settings, &both).expect("a plan");
    assert_eq!(alone.agents.iter().filter(|a| a.scene == 0).count(), 1);
    assert!(alone.warnings.iter().any(|w| w.contains("1 of 3 vehicles")), "{:?}", alone.warnings);
    // Off the road, or against the traffic of the only near lane.
    for bad in [start(50.0, -30.0, 0.0), start(50.0, 0.0, 1.5)] {
        settings.agents.starts = vec![bad];
        let error = plan(&settings, &both).expect_err("no lane there").to_string();
        assert!(error.contains("agents.starts") && error.contains("road"), "{error}");
    }
}

#[test]
fn a_share_of_all_vehicles_collects_data() {
    let mut settings = settings(&[(Split::Train, "road", 3)]);
    settings.traffic.vehicles = Some(40);
    let maps = maps(vec![("road", straight(3000.0, LaneType::Driving))]);
    for (share, connected) in [(0.0, 1), (0.1, 4), (0.32, 13), (1.0, 40)] {
        settings.agents.penetration = Some(share);
        settings.agents.spawn_mode = SpawnMode::Chained;
        let plan = plan(&settings, &maps).expect("a plan");
        for scene in &plan.scenes {
            let agents = plan.agents.iter().filter(|a| a.scene == scene.scene).count();
            assert_eq!(
                (agents, scene.background_vehicles),
                (connected, Some(40 - connected as i32)),
                "{share}"
            );
        }
    }
}

#[test]
fn counts_cover_their_ranges() {
    let settings = settings(&[(Split::Train, "road", 2000)]);
    let plan = plan(&settings, &maps(vec![("road", straight(2000.0, LaneType::Driving))])).expect("a plan");
    let mut vehicles = [0u32; 9];
    for scene in &plan.scenes {
        vehicles[plan.agents.iter().filter(|a| a.scene == scene.scene).count()] += 1;
        assert!(scene.walkers <= 480 && (0.0..=1.0).contains(&scene.walker_cross_factor));
    }
    // 2000 / 7 = 286, four standard errors are 63.
    assert!(vehicles[2..].iter().all(|&n| (220..350).contains(&n)), "{vehicles:?}");
    let clustered = plan.scenes.iter().filter(|s| s.spawn_mode == "clustered").count();
    assert!((910..1090).contains(&clustered));
    let factor = plan.scenes.iter().map(|s| s.walker_cross_factor).sum::<f64>() / 2000.0;
    assert!((factor - 0.6).abs() < 0.02);
}

fn positions(plan: &plan::PlannedScene) -> Vec<Point3<f64>> {
    plan.agents.iter().filter(|a| a.signal.is_none()).map(|a| Point3::from(a.xyz_m)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn vehicles_keep_their_distances(seed in any::<u64>(), clustered in any::<bool>(), count in 1u32..9, length in 60.0..3000.0f64) {
        let mut settings = settings(&[(Split::Train, "road", 1)]);
        settings.seed = seed;
        settings.agents.spawn_mode = if clustered { SpawnMode::Clustered } else { SpawnMode::Chained };
        settings.agents.min_vehicles = count;
        settings.agents.max_vehicles = count;
        let map = PlanMap { map: straight(length, LaneType::Driving), hash: String::new() };
        let pool = SpawnPool::new(&map.map, 24.0);
        let slot =
            SceneSlot { scene: 5, split: Split::Val, map: "road".into(), draw: 0, edition: 0, group: String::new() };
        let planned = plan_scene(&settings, &slot, &map, &pool, &built_in()).expect("a scene");
        let at = positions(&planned);
        prop_assert!(!at.is_empty() && at.len() <= count as usize);
        prop_assert_eq!(at.len() < count as usize, planned.warnings.iter().any(|w| w.contains(" vehicles: ")));
        if clustered {
            // All lie within the radius around one point, so within twice the radius of each other.
            let radius = if count < 2 { 48.0 } else { 48.0 / frames::math::sin(std::f64::consts::PI / f64::from(count)) };
            prop_assert!(at.iter().all(|a| at.iter().all(|b| (a - b).norm() <= 2.0 * radius + 1e-9)));
        } else {
            // Each but the first is near one before it.
            for (i, p) in at.iter().enumerate().skip(1) {
                prop_assert!(at[..i].iter().any(|q| (p - q).norm() <= 64.0));
            }
        }
        for (i, a) in at.iter().enumerate() {
            for b in &at[i + 1..] {
                prop_assert!((a - b).norm() > 2.0);
            }
        }
    }
}

#[test]
fn rsus_stand_by_the_lights_of_near_junctions() {
    let Some(map) = real_map("Town10HD") else { return };
    let settings = settings(&[(Split::Train, "Town10HD", 40)]);
    let maps = maps(vec![("Town10HD", map)]);
    let plan = plan(&settings, &maps).expect("a plan");
    let map = &maps["Town10HD"].map;
    let rsus: Vec<_> = plan.agents.iter().filter(|a| a.signal.is_some()).collect();
    assert!(rsus.len() > 20, "{}", rsus.len());
    for rsu in &rsus {
        let signal = map.signals().iter().find(|s| Some(&s.id) == rsu.signal.as_ref()).expect("its signal");
        let junction = &map.junctions()[signal.junction.expect("a junction")];
        assert!(signal.dynamic);
        let (foot, at) = (signal.on_surface, Point3::from(rsu.xyz_m));
        assert!(((at - foot).norm() - 0.6).abs() < 1e-9);
        let flat = |p: Point3<f64>| p.xy();
        assert!((flat(junction.centre) - flat(at)).norm() < (flat(junction.centre) - flat(foot)).norm());
        let (sin, cos) = frames::math::sin_cos(rsu.rpy_rad[2]);
        let to = flat(junction.centre) - flat(at);
        assert!((to.x * cos + to.y * sin - to.norm()).abs() < 1e-6);
    }
    // Signals 955 and 956 of this map are at one pole.
    for (i, a) in rsus.iter().enumerate() {
        for b in rsus[i + 1..].iter().filter(|b| b.scene == a.scene) {
            assert!((Point3::from(a.xyz_m) - Point3::from(b.xyz_m)).norm() >= 0.5, "{a:?} {b:?}");
        }
    }
    for vehicle in plan.agents.iter().filter(|a| a.signal.is_none()) {
        let outside = map
            .nearest_lane(Point3::from(vehicle.xyz_m), |l| l.lane_type.is_drivable() && l.junction.is_none());
        assert!(outside.expect("a lane").distance_m < 0.01);
    }
}
