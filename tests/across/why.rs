//! `convoy status --why`: the whole chain of a stage of a scene.

use convoy_tests::{Bench, Outcome, TINY};

fn why(bench: &Bench, scene: &str, stage: &str) -> Outcome {
    bench.run("convoy", &["status", "--why", scene, stage])
}

/// A chain without what changes with every release: versions and sizes.
#[track_caller]
fn chain(bench: &Bench, stage: &str, done: bool) -> String {
    let outcome = why(bench, "0", stage);
    assert_eq!(outcome.code, i32::from(!done), "{outcome:?}");
    let line = |line: &str| match line.split_once("made by version ") {
        Some((indent, rest)) => {
            let again =
                rest.split_once(',').map_or("", |(_, rest)| rest.split_once(':').map_or("", |(a, _)| a));
            format!("{indent}made by version N{again}")
        }
        None => line.to_owned(),
    };
    outcome.stdout.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_chain_of_a_stage_reaches_down_to_the_plan() {
    let config = TINY.replace("flow = true\n", "");
    let bench = Bench::new(&config);
    insta::assert_snapshot!("why-nothing-is-there", chain(&bench, "bev-gt", false));
    for stage in ["spawn-planner", "simulate-and-log", "bev-gt", "stats"] {
        bench.run(stage, &[]).expect_done();
    }
    insta::assert_snapshot!("why-done", chain(&bench, "bev-gt", true));
    insta::assert_snapshot!("why-missing", chain(&bench, "merge-tracks", false));
    // Another size of masks, and another rig, which masks do not see.
    let masks = config.replacen("width = 160", "width = 240", 1);
    bench.configure(&format!("{masks}\n[bev]\ncells = 200\n"));
    insta::assert_snapshot!("why-configuration", chain(&bench, "bev-gt", false));
    bench.configure(&config);
    // A file cut short.
    let masks = bench.store().join("scenes/0000/bev/vehicle_0.npz");
    let whole = std::fs::read(&masks).expect("is there");
    std::fs::write(&masks, &whole[..100]).expect("is written");
    let cut = chain(&bench, "bev-gt", false).replace(&whole.len().to_string(), "N");
    insta::assert_snapshot!("why-size", cut);
    // The log made again, and a file lost.
    bench.run("simulate-and-log", &["--force"]).expect_done();
    std::fs::remove_file(&masks).expect("is there");
    insta::assert_snapshot!("why-input", chain(&bench, "bev-gt", false));
    insta::assert_snapshot!("why-statistics", chain(&bench, "stats", false));
    // Another plan of the scene.
    bench.configure(&config.replace("vehicles = 12", "vehicles = 13"));
    bench.run("spawn-planner", &["--redo"]).expect_done();
    insta::assert_snapshot!("why-plan", chain(&bench, "bev-gt", false));
    for (scene, stage, words) in [
        ("0", "bev", "--why: there is no stage `bev`; there are spawn-planner, "),
        ("x", "bev-gt", "--why: `x` is no number of a scene"),
        ("7", "bev-gt", "--why: no scene 7 in the plan (it has 0 to 0)"),
    ] {
        let outcome = why(&bench, scene, stage);
        assert!(outcome.code == 2 && outcome.stderr.contains(words), "{outcome:?}");
    }
}
