//! Weather and places as people write them, by the real programs.

use std::fs;

use convoy_tests::{Bench, SMALL, workspace};
use schema::scene_info::SceneInfo;
use schema::tables::{ActorRow, FrameRow, PlanAgentRow, PlanWeatherRow};
use schema::{ActorRole, AgentKind};
use store::{Manifest, Scope, Store, keys};

fn store(bench: &Bench) -> Store {
    Store::open(bench.store()).expect("is a folder")
}

fn plan(bench: &Bench) -> Manifest {
    store(bench).manifest(Scope::Plan, "spawn-planner").expect("is readable").expect("is there")
}

#[test]
fn keyframes_reach_the_log() {
    let weather = "\n[weather.initial]\ncloudiness = 0\n[weather.final]\ncloudiness = 20\n\
                   [[weather.keyframes]]\nat_s = 0.5\ncloudiness = 80\nprecipitation = [20, 60]\n";
    let bench = Bench::new(&format!("{SMALL}{weather}"));
    bench.run("spawn-planner", &[]).expect_done();
    let planned = plan(&bench);
    let rows: Vec<PlanWeatherRow> = store(&bench).read_rows(&planned, keys::PLAN_WEATHER).expect("reads");
    assert_eq!((rows.len(), rows[0].scene, rows[0].at_s), (1, 0, 0.5));
    let between = rows[0].weather;
    assert!(between.cloudiness == 80.0 && (20.0..60.0).contains(&between.precipitation), "{between:?}");

    bench.run("simulate-and-log", &[]).expect_done();
    let log = store(&bench).manifest(Scope::Scene(0), "simulate-and-log").expect("reads").expect("is there");
    let frames: Vec<FrameRow> = store(&bench).read_rows(&log, &keys::table::<FrameRow>(0)).expect("reads");
    // A second: frame 9 is half a second after the initial weather.
    let course: Vec<f64> = [4, 9, 14, 19].map(|frame: usize| frames[frame].cloudiness).to_vec();
    for (is, want) in course.iter().zip([40.0, 80.0, 50.0, 20.0]) {
        assert!((is - want).abs() < 1e-9, "{course:?}");
    }
    assert!(frames.iter().all(|row| (row.precipitation - between.precipitation).abs() < 1e-9));
    let info = store(&bench).read(&keys::scene(0, schema::scene_info::SCENE_FILE)).expect("reads");
    let info: SceneInfo = serde_json::from_slice(&info.expect("is there")).expect("is JSON");
    let [keyframe] = info.weather_keyframes.as_slice() else { panic!("{:?}", info.weather_keyframes) };
    assert_eq!((keyframe.at_s, keyframe.weather["cloudiness"]), (0.5, 80.0));

    // A scene depends on its keyframes; a plan without any has no such table.
    bench.configure(&format!("{SMALL}{}", weather.replace("cloudiness = 80", "cloudiness = 81")));
    bench.run("spawn-planner", &["--redo"]).expect_done();
    assert_ne!(plan(&bench).sections, planned.sections);
    bench.configure(&format!("{SMALL}{weather}"));
    bench.run("spawn-planner", &["--redo"]).expect_done();
    assert_eq!(plan(&bench).sections, planned.sections);
    bench.configure(SMALL);
    bench.run("spawn-planner", &["--redo"]).expect_done();
    assert!(plan(&bench).output(keys::PLAN_WEATHER).is_none());
}

/// The first configuration of a page.
fn page(name: &str) -> String {
    let text = fs::read_to_string(workspace().join("docs").join(name)).expect("the page is there");
    let block = text.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    block.expect("the page has a configuration").to_owned()
}

#[test]
fn the_page_of_weather_is_planned_without_a_warning() {
    let bench = Bench::new(&page("weather.md"));
    bench.run("spawn-planner", &["--strict"]).expect_done();
    let rows: Vec<PlanWeatherRow> =
        store(&bench).read_rows(&plan(&bench), keys::PLAN_WEATHER).expect("reads");
    let shower: Vec<f64> = rows.iter().filter(|r| r.at_s == 5.0).map(|r| r.weather.precipitation).collect();
    assert_eq!(rows.len(), 12);
    assert!(shower.len() == 4 && shower.iter().all(|rain| (50.0..90.0).contains(rain)), "{shower:?}");
}

#[test]
fn the_page_of_places_is_planned_and_its_rsus_stand_on_the_ground() {
    let short = "[timing]\nwarmup_s = 0.5\nmin_duration_s = 1\nmax_duration_s = 1\n[traffic]\nvehicles = 4\n\
                 [walkers]\ncount = 0\n[world]\nradius_m = 60\n";
    let bench = Bench::new(&format!("{}{short}", page("agents.md")));
    let planned = bench.run("spawn-planner", &[]);
    planned.expect_done();
    assert!(
        !planned.stderr.contains("rsus_at") && !planned.stderr.contains("of 2 RSUs"),
        "{}",
        planned.stderr
    );
    let agents: Vec<PlanAgentRow> = store(&bench).read_rows(&plan(&bench), keys::PLAN_AGENTS).expect("reads");
    let rsus: Vec<&PlanAgentRow> = agents.iter().filter(|a| a.agent.kind == AgentKind::Rsu).collect();
    assert!(rsus.len() == 4 && agents.len() == 8, "{agents:?}");
    assert!(rsus.iter().all(|rsu| rsu.signal.is_none()));

    bench.run("simulate-and-log", &["--scenes", "0"]).expect_done();
    let log = store(&bench).manifest(Scope::Scene(0), "simulate-and-log").expect("reads").expect("is there");
    let actors: Vec<ActorRow> = store(&bench).read_rows(&log, &keys::table::<ActorRow>(0)).expect("reads");
    for planned in &rsus[..2] {
        let actor = actors.iter().find(|a| a.role == ActorRole::Agent(planned.agent)).expect("is there");
        assert_eq!(actor.xyz_m[..2], planned.xyz_m[..2]);
        // Sidewalks and grass beside the street are some centimetres above or below what is written.
        let lifted_m = actor.xyz_m[2] - planned.xyz_m[2];
        assert!(lifted_m != 0.0 && lifted_m.abs() < 0.5, "{lifted_m}");
    }
}
