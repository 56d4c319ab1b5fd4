//! Scenes made on several machines become one store.

use std::fs;
use std::path::Path;

use convoy_tests::{Bench, LEAN, Outcome, TINY};

fn config() -> String {
    TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2")
}

/// A store with the first stages of one of the plan's two scenes, or of both.
fn made(config: &str, scenes: &str) -> Bench {
    let bench = Bench::new(config);
    bench.run("spawn-planner", &[]).expect_done();
    for stage in ["simulate-and-log", "bev-gt"] {
        bench.run(stage, &["--scenes", scenes]).expect_done();
    }
    bench
}

fn merge(into: &Bench, others: &[&Path]) -> Outcome {
    let others: Vec<String> = others.iter().map(|other| other.display().to_string()).collect();
    let args: Vec<&str> = ["merge"].into_iter().chain(others.iter().map(String::as_str)).collect();
    into.run("convoy", &args)
}

#[test]
fn stores_of_one_plan_become_one() {
    let (first, second, whole) = (made(&config(), "0"), made(&config(), "1"), made(&config(), "0-1"));
    let sources = [first.digests(), second.digests()];
    let joined = Bench::new(&config());
    let both = [&*first.store(), &*second.store()];
    let outcome = merge(&joined, &both);
    outcome.expect_done();
    assert!(outcome.stdout.contains("2 stages of 1 scenes taken"), "{}", outcome.stdout);
    // The same as if one machine had made all of it, and done, as far as it goes.
    assert_eq!(joined.digests(), whole.digests());
    assert_eq!(sources, [first.digests(), second.digests()], "they stay as they are");
    let stage = joined.run("bev-gt", &[]);
    assert!(stage.stderr.contains("0 done, 2 kept"), "{}", stage.stderr);

    // Once more: all is there. Then what a killed merge leaves: a shard cut short, a manifest not there yet.
    let again = merge(&joined, &both);
    assert!(again.stdout.contains("0 stages of 0 scenes taken, 0.0 MB; 2 were there"), "{}", again.stdout);
    let scene = joined.store().join("scenes/0001");
    let shard = fs::read_dir(scene.join("bev")).expect("is there").next().expect("has one").expect("reads");
    fs::write(shard.path(), b"PK").expect("writes");
    fs::remove_file(scene.join("_manifests/simulate-and-log.json")).expect("is there");
    merge(&joined, &both).expect_done();
    assert_eq!(joined.digests(), whole.digests());
}

#[test]
fn some_scenes_are_copied() {
    let (whole, second) = (made(&config(), "0-1"), made(&config(), "1"));
    let copy = Bench::new(&config());
    let args = |scenes: &str| {
        copy.run("convoy", &["merge", "--scenes", scenes, &whole.store().display().to_string()])
    };
    let unknown = args("1,7");
    assert!(unknown.code == 2 && unknown.stderr.contains("nothing is done of scene 7"), "{}", unknown.stderr);
    assert!(!copy.store().exists());
    args("1").expect_done();
    assert_eq!(copy.digests(), second.digests());
}

#[test]
fn stores_of_other_plans_are_refused() {
    let here = made(&config(), "0");
    let before = here.digests();
    let expect = |other: &Bench, text: &str| {
        let outcome = merge(&here, &[&*other.store()]);
        assert_eq!(outcome.code, 2, "{}", outcome.stderr);
        assert!(outcome.stderr.contains(text), "{}", outcome.stderr);
        assert_eq!(here.digests(), before, "nothing was taken");
    };
    let seed = config().lines().find(|line| line.starts_with("seed")).expect("has a seed").to_owned();
    expect(
        &made(&config().replace(&seed, "seed = 77"), "1"),
        "have different settings (scene 1): seed: 11 -> 77",
    );
    // A larger plan has scenes that this one does not.
    let larger = TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 3");
    expect(&made(&larger, "2"), "its scene 2 is not planned");
    // The same scene, made again by force.
    let forced = made(&config(), "0");
    forced.run("bev-gt", &["--scenes", "0", "--force"]).expect_done();
    expect(&forced, "bev-gt of scenes/0000 is another");
    let empty = Bench::new(&config());
    expect(&empty, "holds no plan");
    // What has the larger plan takes in the smaller.
    let larger = made(&larger, "2");
    merge(&larger, &[&*here.store()]).expect_done();
    let status = larger.run("bev-gt", &["--dry-run"]);
    assert!(status.code == 0 && larger.store().join("scenes/0000/_manifests/bev-gt.json").exists());
}

#[test]
fn unlike_stores_become_one_when_asked() {
    let day = LEAN.to_owned();
    let dense = format!("first_scene = 100\n{}", LEAN.replace("vehicles = 12", "vehicles = 20"));
    let run =
        |bench: &Bench, args: &[&str]| bench.run("convoy", &[&["run", "--progress", "none"], args].concat());
    let (here, there) = (Bench::new(&day), Bench::new(&dense));
    run(&here, &[]).expect_done();
    run(&there, &[]).expect_done();
    let scenes = |bench: &Bench| -> Vec<(String, String)> {
        bench.digests().into_iter().filter(|(name, _)| name.starts_with("scenes/")).collect()
    };
    let (before, own) = (here.digests(), scenes(&here));
    let place = there.store().display().to_string();
    let refused = here.run("convoy", &["merge", &place]);
    assert!(refused.code == 2 && refused.stderr.contains("--mixed"), "{refused:?}");
    assert_eq!(here.digests(), before);
    for _ in 0..2 {
        here.run("convoy", &["merge", "--mixed", &place]).expect_done();
    }
    let expected: Vec<_> = own.into_iter().chain(scenes(&there)).collect();
    assert_eq!(scenes(&here), expected);
    // With either configuration all is done but the plan and the statistics.
    for config in [&day, &dense] {
        here.configure(config);
        let kept = scenes(&here);
        let outcome = run(&here, &[]);
        outcome.expect_done();
        assert!(!outcome.stderr.contains("makes again"), "{}", outcome.stderr);
        assert_eq!(scenes(&here), kept);
        here.run("convoy", &["status"]).expect_done();
        here.run("convoy", &["verify"]).expect_done();
    }
}
