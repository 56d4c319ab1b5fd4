//! Trajectories and routes that a user gave.

use std::collections::BTreeMap;

use catalogue::Catalogue;
use opendrive::{LaneType, Map};
use plan::{Plan, PlanError, PlanMap, PlanSources, Track, TrackPose, plan_slots, scene_slots};
use schema::AgentId;
use settings::stages::PlanSettings;
use settings::{GivenRoute, SceneCount, Split};
use testkit::straight_road;

fn settings(map: &str) -> PlanSettings {
    let scenes = vec![SceneCount { split: Split::Train, map: map.into(), count: 2 }];
    let mut settings = PlanSettings::with_scenes(scenes);
    (settings.timing.min_duration_s, settings.timing.max_duration_s) = (2.0, 2.0);
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (1, 1);
    settings.agents.max_rsus = 0;
    settings.agents.trajectories = Some("drive.parquet".into());
    settings
}

fn plan(settings: &PlanSettings, map: Map, tracks: Vec<Track>) -> Result<Plan, PlanError> {
    let name = settings.scenes[0].map.clone();
    let maps = BTreeMap::from([(name, PlanMap { map, hash: String::new() })]);
    let tracks = BTreeMap::from([("drive.parquet".to_owned(), tracks)]);
    let sources = PlanSources { catalogue: Catalogue::built_in(), tracks: &tracks };
    plan_slots(settings, &scene_slots(settings)?, &maps, &sources)
}

/// A road to the east of one lane each way.
fn road() -> Map {
    testkit::map(vec![straight_road(400.0, &[(LaneType::Driving, 3.5)])])
}

/// 10 m/s to the east, 40 frames.
fn track(actor: &str) -> Track {
    let pose = |k: i32| TrackPose { xy_m: [50.0 + 0.5 * f64::from(k), -1.75], ..TrackPose::default() };
    Track {
        scene: None,
        actor: actor.into(),
        model: None,
        first_frame: 0,
        poses: (0..40).map(pose).collect(),
    }
}

#[test]
fn vehicles_on_trajectories_start_where_these_begin_and_others_near_them() {
    let mut settings = settings("road");
    settings.agents.max_vehicles = 3;
    settings.agents.min_vehicles = 3;
    let van = Track { model: Some("van.delivery".into()), ..track("vehicle_1") };
    let van = Track {
        poses: van.poses.iter().map(|p| TrackPose { xy_m: [p.xy_m[0] + 20.0, -1.75], ..*p }).collect(),
        ..van
    };
    let mut own = track("vehicle_0");
    (own.scene, own.first_frame) = (Some(1), -3);
    own.poses
        .extend(track("").poses[..5].iter().map(|p| TrackPose { xy_m: [p.xy_m[0] + 20.0, -1.75], ..*p }));
    let both =
        plan(&settings, road(), vec![van.clone(), Track { scene: Some(0), ..track("vehicle_0") }, own]);
    let both = both.expect("a plan");
    for scene in 0..2 {
        let agents: Vec<_> = both.agents.iter().filter(|a| a.scene == scene).collect();
        assert_eq!(agents.len(), 3);
        // Three frames later in the second scene.
        let x_m = 50.0 + 1.5 * f64::from(scene);
        assert_eq!((agents[0].agent, agents[0].xyz_m), (AgentId::vehicle(0), [x_m, -1.75, 0.0]));
        assert_eq!((agents[1].model.as_str(), agents[1].xyz_m[0]), ("van.delivery", 70.0));
        assert!((agents[2].xyz_m[0] - 60.0).abs() < 100.0, "{:?}", agents[2].xyz_m);
        let rows: Vec<_> = both.trajectories.iter().filter(|t| t.scene == scene).collect();
        assert_eq!(rows.len(), 80 + 5 * scene as usize);
        assert_eq!((rows[0].actor.as_str(), rows[0].frame), ("vehicle_0", -3 * scene as i32));
    }
}

#[test]
fn heights_and_slopes_are_those_of_the_road() {
    // 6 % uphill to the east, by the road's elevation 3 + 0.06 s.
    let hill = || {
        let mut road = straight_road(400.0, &[(LaneType::Driving, 3.5)]);
        road.elevation = vec![opendrive::Cubic { a: 3.0, b: 0.06, ..opendrive::Cubic::default() }];
        testkit::map(vec![road])
    };
    let planned = plan(&settings("hill"), hill(), vec![track("vehicle_0")]).expect("a plan");
    // Where the file says the height alone, slopes are still those of the road.
    let mut high = track("vehicle_0");
    high.poses.iter_mut().for_each(|pose| pose.z_m = Some(3.2 + 0.06 * pose.xy_m[0]));
    let high = plan(&settings("hill"), hill(), vec![high]).expect("a plan");
    for (row, low) in high.trajectories.iter().zip(&planned.trajectories) {
        assert!((row.xyz_m[2] - low.xyz_m[2] - 0.2).abs() < 1e-6);
        assert!((0..3).all(|k| (row.rpy_rad[k] - low.rpy_rad[k]).abs() < 1e-6), "{row:?}");
    }
    for row in planned.trajectories.iter().filter(|row| row.scene == 0) {
        assert!((row.xyz_m[2] - (3.0 + 0.06 * row.xyz_m[0])).abs() < 1e-6, "{row:?}");
        // Nose up is negative.
        assert!((row.rpy_rad[1] + frames::math::atan(0.06)).abs() < 1e-6 && row.rpy_rad[0].abs() < 1e-9);
    }
}

#[test]
fn what_no_actor_can_do_is_refused_with_file_scene_actor_and_frame() {
    let refused = |tracks: Vec<Track>| plan(&settings("road"), road(), tracks).expect_err("bad").to_string();
    let mut jumps = track("vehicle_0");
    jumps.poses[21..].iter_mut().for_each(|pose| pose.xy_m[0] += 3.0);
    let mut turns = track("vehicle_0");
    turns.poses[7].yaw_rad = 90.0;
    let mut short = track("vehicle_0");
    short.poses.pop();
    let mut nan = track("vehicle_0");
    nan.poses[3].yaw_rad = f64::NAN;
    let mut off = track("vehicle_0");
    off.poses.iter_mut().for_each(|pose| pose.xy_m[1] = 40.0);
    let of_model = |actor: &str, model: &str| Track { model: Some(model.into()), ..track(actor) };
    let said: Vec<String> = [
        vec![jumps],
        vec![turns],
        vec![short],
        vec![nan],
        vec![off],
        vec![of_model("vehicle_0", "car.flying")],
        vec![of_model("vehicle_0", "walker.police")],
        vec![of_model("somebody", "cone.big")],
        vec![track("somebody")],
        vec![track("rsu_0")],
        vec![track("vehicle_1")],
        vec![track("Vehicle_0")],
        vec![Track {
            poses: vec![TrackPose { xy_m: [3e6, 0.0], ..TrackPose::default() }; 40],
            ..track("vehicle_0")
        }],
    ]
    .into_iter()
    .map(refused)
    .collect();
    insta::assert_snapshot!("refused-trajectories", said.join("\n"));
}

/// A route on the road.
fn route(points: &[[f64; 2]]) -> GivenRoute {
    let points_m = points.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
    GivenRoute { map: "road".into(), points_m, ..GivenRoute::default() }
}

fn over(lanes: &[&str]) -> GivenRoute {
    GivenRoute { lanes: lanes.iter().map(|lane| (*lane).to_owned()).collect(), ..route(&[]) }
}

fn with_route(route: GivenRoute, map: Map) -> Result<Plan, PlanError> {
    let mut settings = settings("road");
    settings.agents.trajectories = None;
    settings.agents.routes = vec![route];
    plan(&settings, map, Vec::new())
}

#[test]
fn routes_take_the_lanes_that_lead_on() {
    // Both points are nearer to the lane that leads from the second to the first.
    let planned = with_route(route(&[[50.0, 0.3], [200.0, 0.3]]), road()).expect("a plan");
    let rows: Vec<_> = planned.routes.iter().filter(|row| row.scene == 1).collect();
    let places: Vec<_> = rows.iter().map(|row| (row.road.as_str(), row.lane, row.s_m.round())).collect();
    assert_eq!(places, [("1", -1, 50.0), ("1", -1, 200.0)]);
    let start = planned.agents.iter().find(|a| a.scene == 1).expect("a vehicle");
    assert!((start.xyz_m[0] - 50.0).abs() < 1e-6 && start.rpy_rad[2].abs() < 1e-6, "{start:?}");
    let back = with_route(route(&[[200.0, -0.3], [50.0, -0.3]]), road()).expect("a plan");
    assert!(back.routes.iter().all(|row| row.lane == 1), "{:?}", back.routes);
    // Lanes by their names, from the middle of the first: straight over a crossing.
    let across = with_route(over(&["2:1", "0:-1"]), testkit::crossing(true)).expect("a plan");
    let rows: Vec<_> = across.routes.iter().filter(|row| row.scene == 0).collect();
    for (row, x) in rows.iter().zip([-110.0, 110.0]) {
        assert!((row.xyz_m[0] - x).abs() < 1e-9 && (row.xyz_m[1] + 1.75).abs() < 1e-9, "{row:?}");
    }
}

#[test]
fn routes_that_nobody_can_drive_are_refused() {
    let refused = |route: GivenRoute, map: Map| with_route(route, map).expect_err("no route").to_string();
    let crossing = || testkit::crossing(true);
    let wide =
        || testkit::map(vec![straight_road(400.0, &[(LaneType::Driving, 3.5), (LaneType::Driving, 3.5)])]);
    let said = [
        refused(route(&[[50.0, -1.75], [300.0, 300.0]]), road()),
        refused(over(&["1:-1", "1:1"]), road()),
        refused(route(&[[0.0, -1.75], [60.0, -1.75]]), crossing()),
        refused(over(&["nowhere:-1", "nowhere:-2"]), road()),
        refused(over(&["1:-1"]), road()),
        // Over to the lane beside and back leads to no place behind.
        refused(route(&[[200.0, -5.25], [100.0, -5.25]]), wide()),
        refused(GivenRoute { agent: "vehicle_1".into(), ..route(&[[50.0, -1.75], [200.0, -1.75]]) }, road()),
    ];
    insta::assert_snapshot!("refused-routes", said.join("\n"));
}

#[test]
fn rows_and_scenes_that_do_not_meet_are_said() {
    let of = |scene| Track { scene: Some(scene), ..track("vehicle_0") };
    let planned = plan(&settings("road"), road(), vec![of(1), of(7), of(8)]).expect("a plan");
    insta::assert_snapshot!("scenes-without-rows", planned.warnings.join("\n"));
    assert_eq!(plan(&settings("road"), road(), vec![track("vehicle_0")]).expect("a plan").warnings, [""; 0]);
}

#[test]
fn others_start_beside_the_way_of_a_given_vehicle() {
    let mut settings = settings("road");
    (settings.agents.min_vehicles, settings.agents.max_vehicles) = (4, 4);
    let planned = plan(&settings, road(), vec![track("vehicle_0")]).expect("a plan");
    // It drives from 50 to 69.5 m on the lane to the east.
    let others = planned.agents.iter().filter(|a| a.agent != AgentId::vehicle(0));
    let mut count = 0;
    for other in others {
        count += 1;
        let [x, y, _] = other.xyz_m;
        assert!(y > 0.0 || !(46.5..73.0).contains(&x), "{other:?}");
    }
    assert!(count >= 2, "{count}");
}
