//! A store that grows by other rules: what was planned keeps its own.

use std::collections::BTreeMap;
use std::time::Duration;

use convoy_tests::{Bench, LEAN, Outcome};
use schema::tables::PlanSceneRow;
use store::{Scope, Store, keys};

use crate::slips::words;

fn run(bench: &Bench, args: &[&str]) -> Outcome {
    bench.run("convoy", &[&["run", "--progress", "none"], args].concat())
}

fn asking(config: &str) -> String {
    format!("{config}\n[store]\nask_beyond_s = 0\n")
}

/// The first rules: two scenes with twelve vehicles.
fn first() -> String {
    asking(&LEAN.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2"))
}

/// Other rules: more traffic, another lidar, three scenes in all.
fn second() -> String {
    first()
        .replace("\"convoy/demo\" = 2", "\"convoy/demo\" = 3")
        .replace("vehicles = 12", "vehicles = 20")
        .replace("channels = 8", "channels = 4")
}

fn scenes(bench: &Bench, wanted: &[u32]) -> BTreeMap<String, String> {
    let is_wanted = |name: &String| wanted.iter().any(|n| name.starts_with(&format!("scenes/{n:04}/")));
    bench.digests().into_iter().filter(|(name, _)| is_wanted(name)).collect()
}

fn vehicles(bench: &Bench) -> Vec<Option<i32>> {
    let store = Store::open(bench.store()).expect("opens");
    let manifest = store.manifest(Scope::Plan, "spawn-planner").expect("reads").expect("is planned");
    let plan: Vec<PlanSceneRow> = store.read_rows(&manifest, keys::PLAN_SCENES).expect("reads");
    plan.iter().map(|scene| scene.background_vehicles).collect()
}

#[test]
fn a_store_grows_by_other_rules() {
    let bench = Bench::new(&first());
    run(&bench, &[]).expect_done();
    let (all, two) = (bench.digests(), scenes(&bench, &[0, 1]));

    // Without --grow the run says what it would redo, and touches nothing.
    bench.configure(&second());
    let asked = run(&bench, &[]);
    assert_eq!(asked.code, 2, "{asked:?}");
    insta::assert_snapshot!("run-by-other-rules", words(&bench, &asked));
    assert!(bench.digests() == all, "nothing was touched");

    let grown = run(&bench, &["--grow"]);
    grown.expect_done();
    assert_eq!(scenes(&bench, &[0, 1]), two, "shards and manifests of the first two");
    assert_eq!(vehicles(&bench), [Some(12), Some(12), Some(20)]);
    assert!(!grown.stderr.contains("makes again"), "{}", grown.stderr);
    let grown = bench.digests();

    // Both configurations are known: with either all is done.
    for config in [first(), second()] {
        bench.configure(&config);
        bench.run("convoy", &["status"]).expect_done();
        run(&bench, &[]).expect_done();
        assert_eq!(bench.digests(), grown);
    }
    let status = bench.run("convoy", &["status"]);
    assert!(status.stdout.contains("edition and group"), "{}", status.stdout);
    let verified = bench.run("convoy", &["verify"]);
    verified.expect_done();

    // A changed lidar is that of the newest edition, or of the one that is named.
    let lidar = second().replace("channels = 4", "channels = 2");
    bench.configure(&lidar);
    let asked = run(&bench, &[]);
    insta::assert_snapshot!("run-with-another-lidar-of-an-edition", words(&bench, &asked));
    let asked = run(&bench, &["--edition", "0"]);
    assert_eq!(asked.code, 2, "{asked:?}");
    assert!(asked.stderr.contains("simulate-and-log: scenes 0-1 (planned otherwise)"), "{}", asked.stderr);
    let none = run(&bench, &["--edition", "2"]);
    assert_eq!(none.code, 2, "{none:?}");
    insta::assert_snapshot!("run-of-an-edition-that-is-not-there", words(&bench, &none));
    assert_eq!(bench.digests(), grown);
    bench.configure(&first().replace("channels = 8", "channels = 16"));
    run(&bench, &["--edition", "0", "--redo"]).expect_done();
    assert_eq!(
        scenes(&bench, &[2]),
        grown.into_iter().filter(|(n, _)| n.starts_with("scenes/0002/")).collect()
    );

    // No scene is asked for beyond those that are there.
    bench.configure(&first().replace("vehicles = 12", "vehicles = 7"));
    let before = bench.digests();
    let none = run(&bench, &["--grow"]);
    assert_eq!(none.code, 2, "{none:?}");
    insta::assert_snapshot!("growth-by-no-scene", words(&bench, &none));
    assert_eq!(bench.digests(), before);
}

#[test]
fn a_growth_that_is_killed_ends_with_the_same_bytes() {
    let whole = Bench::new(&first());
    run(&whole, &[]).expect_done();
    whole.configure(&second());
    run(&whole, &["--grow"]).expect_done();
    let digests = whole.digests();

    let bench = Bench::new(&first());
    run(&bench, &[]).expect_done();
    bench.configure(&second());
    let mut killed = 0;
    for stage in ["spawn-planner", "simulate-and-log", "render-sensors", "bev-gt"] {
        for wait_ms in [3, 20, 60] {
            let mut child = bench.start(stage, &["--grow"]);
            std::thread::sleep(Duration::from_millis(wait_ms));
            killed += u32::from(child.try_wait().expect("is known").is_none());
            child.kill().expect("is killed");
            child.wait().expect("ends");
        }
        bench.run(stage, &["--grow"]).expect_done();
    }
    assert!(killed >= 4, "{killed} kills came in time");
    run(&bench, &["--grow"]).expect_done();
    // Which frames a killed run made first is nobody's business but the shards'.
    assert_eq!(bench.digests(), digests);
}
