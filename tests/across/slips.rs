//! What is finished is not made again by a slip: a run with another configuration asks, or ends with 2 and
//! leaves every byte.

use std::path::Path;
use std::process::Command;

use convoy_tests::{Bench, Outcome, SMALL, TINY, program};

/// Two scenes without pictures; whatever would be made again is asked about.
fn config() -> String {
    let two = TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2");
    let pictures = [
        "width = 160\nheight = 90\nsemantic = true\ndepth = true\nflow = true\n",
        "width = 160\nheight = 90\n",
    ];
    let blind = pictures.iter().fold(two, |config, keys| config.replace(keys, "enabled = false\n"));
    format!("{blind}[store]\nask_beyond_s = 0\n")
}

fn run(bench: &Bench, args: &[&str]) -> Outcome {
    bench.run("convoy", &[&["run", "--progress", "none"], args].concat())
}

/// What a program said, without the folder and the amounts of work, which change with what drives by.
pub(crate) fn words(bench: &Bench, outcome: &Outcome) -> String {
    let said = outcome.stderr.replace(&bench.folder.path().display().to_string(), "FOLDER");
    let line = |line: &str| line.split(", about").next().unwrap_or_default().trim_end().to_owned() + "\n";
    said.lines().filter(|line| !line.contains(" done, ")).map(line).collect()
}

/// Expects that a run with a configuration is refused with some words, and changes nothing.
#[track_caller]
fn refused(bench: &Bench, config: &str, words: &[&str]) -> Outcome {
    let before = bench.digests();
    bench.configure(config);
    let outcome = run(bench, &[]);
    assert_eq!(outcome.code, 2, "{outcome:?}");
    for word in words {
        assert!(outcome.stderr.contains(word), "{word}: {}", outcome.stderr);
    }
    assert!(bench.digests() == before, "{words:?}: the store was touched");
    outcome
}

#[test]
fn a_slip_is_asked_about_and_touches_nothing() {
    let config = config();
    let bench = Bench::new(&config);
    run(&bench, &[]).expect_done();
    let with = |old: &str, new: &str| {
        assert!(config.contains(old), "{old}");
        config.replace(old, new)
    };
    let asks = "--redo makes it again";
    let _ = refused(&bench, &with("vehicles = 12", "vehicles = 13"), &["traffic.vehicles: 12 -> 13", asks]);
    let weather = with("sun_altitude_deg = 30", "sun_altitude_deg = 31");
    let _ = refused(
        &bench,
        &weather,
        &["weather.initial.sun_altitude_deg: 30.0 -> 31.0", "planned otherwise", asks],
    );
    // Masks that would be switched off: they would go.
    let masks = format!("{config}\n[bev]\nenabled = false\n");
    let _ = refused(
        &bench,
        &masks,
        &["bev-gt: scenes 0-1 (the configuration changed)", "bev.enabled: true -> false"],
    );
    let other = with("name = \"tiny\"", "name = \"other\"");
    let of_another = refused(&bench, &other, &["holds the dataset `tiny`", "--force"]);
    insta::assert_snapshot!("run-of-another-name", words(&bench, &of_another));
    for stage in ["render-sensors", "stats"] {
        let alone = bench.run(stage, &[]);
        assert!(alone.code == 2 && alone.stderr.contains("holds the dataset `tiny`"), "{alone:?}");
    }
    // Fewer scenes are asked for: those that are made stay.
    let scenes = |bench: &Bench| -> Vec<(String, String)> {
        bench.digests().into_iter().filter(|(name, _)| name.starts_with("scenes/")).collect()
    };
    let before = scenes(&bench);
    bench.configure(&with("\"convoy/demo\" = 2", "\"convoy/demo\" = 1"));
    run(&bench, &[]).expect_done();
    assert!(scenes(&bench) == before);
    bench.configure(&config);
    run(&bench, &[]).expect_done();
    assert!(scenes(&bench) == before);
    // A lidar is the sensors' alone, and what is made of them.
    let lidar = config.replacen("channels = 16", "channels = 8", 1);
    let sensors = ["render-sensors: scenes 0-1 (the configuration changed)", "(made from render-sensors)"];
    let keys = ["vehicle.lidars[LIDAR].scan.channels: 16 -> 8"];
    let asked = refused(&bench, &lidar, &[&sensors[..], &keys].concat());
    insta::assert_snapshot!("run-with-another-lidar", words(&bench, &asked));
    let before = bench.digests();
    let alone = bench.run("render-sensors", &[]);
    assert!(alone.code == 2 && alone.stderr.contains(sensors[0]), "{alone:?}");
    assert!(alone.stderr.contains("makes stale postprocess-valid"), "{alone:?}");
    assert!(!alone.stderr.contains("bev-gt") && bench.digests() == before, "{alone:?}");
    insta::assert_snapshot!("stage-with-another-lidar", words(&bench, &alone));
    // A store whose plan or record was lost is asked about all the more.
    for lost in ["plan/_manifest.json", "dataset.json", "plan/scenes.parquet"] {
        let path = bench.store().join(lost);
        let kept = std::fs::read(&path).expect("is there");
        std::fs::remove_file(&path).expect("goes");
        let asked = run(&bench, &[]);
        assert!(asked.code == 2 && asked.stderr.contains(sensors[0]), "{lost}: {asked:?}");
        std::fs::write(&path, kept).expect("is written");
    }
    // Asked for, it is done, once; whoever goes on with it after a kill is not asked again.
    let planned = bench.run("spawn-planner", &["--redo"]);
    planned.expect_done();
    let log = |digests: &std::collections::BTreeMap<String, String>| {
        digests.iter().filter(|(name, _)| name.contains("/log/")).map(|(_, d)| d.clone()).collect::<Vec<_>>()
    };
    let done = run(&bench, &[]);
    done.expect_done();
    assert!(done.stderr.contains("makes again render-sensors: scenes 0-1"), "{}", done.stderr);
    let after = bench.digests();
    assert!(after != before && log(&after) == log(&before));
    run(&bench, &[]).expect_done();
    assert!(bench.digests() == after, "all is done");
    // Little is made again without a question, and told.
    bench.configure(&lidar.replace("ask_beyond_s = 0", "").replacen("channels = 8", "channels = 4", 1));
    let little = run(&bench, &[]);
    little.expect_done();
    assert!(little.stderr.contains("scan.channels: 8 -> 4"), "{}", little.stderr);
}

/// A town of ours as a map file in a folder.
fn map_file(folder: &Path, seed: &str) {
    std::fs::create_dir_all(folder).expect("is made");
    let mut town = Command::new(program("convoy"));
    town.args(["town", "--name", "convoy/demo", "--seed", seed, "--out"]).arg(folder.join("mine.xodr"));
    Outcome::of(&town.output().expect("starts")).expect_done();
}

#[test]
fn another_map_of_the_same_name_is_asked_about() {
    let bench = Bench::new(&config().replace("\"convoy/demo\" = 2", "\"mine\" = 1"));
    let (here, there) = (bench.folder.path().join("here"), bench.folder.path().join("there"));
    map_file(&here, "5");
    map_file(&there, "6");
    let run = |folder: &Path| {
        let mut planner = bench.command("spawn-planner", &[]);
        Outcome::of(&planner.arg("--maps").arg(folder).output().expect("starts"))
    };
    run(&here).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let before = bench.digests();
    let refused = run(&there);
    assert_eq!(refused.code, 2, "{refused:?}");
    insta::assert_snapshot!("plan-of-another-map", words(&bench, &refused));
    assert!(bench.digests() == before);
    run(&here).expect_done();
    assert!(bench.digests() == before);
}

/// The demo's store is `dataset`; another configuration never gets into it by `make dataset CONFIG=...`.
#[test]
fn make_names_stores_as_their_configurations() {
    let said = |args: &[&str]| {
        let mut make = Command::new("make");
        make.arg("--no-print-directory").args(["-n", "verify"]).args(args);
        make.current_dir(convoy_tests::workspace()).env_remove("MAKEFLAGS").env_remove("STORE");
        let outcome = Outcome::of(&make.output().expect("make starts"));
        outcome.expect_done();
        outcome.stdout.split("--store ").nth(1).unwrap_or_default().trim().to_owned()
    };
    assert_eq!(said(&[]), "dataset");
    assert_eq!(said(&["CONFIG=configs/town10.toml"]), "town10");
    assert_eq!(said(&["CONFIG=elsewhere/mine.toml"]), "mine");
    assert_eq!(said(&["CONFIG=configs/town10.toml", "STORE=dataset"]), "dataset");
}

#[test]
fn status_says_what_another_plan_would_make_again_and_add() {
    let bench = Bench::new(SMALL);
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let before = bench.digests();
    let wish = SMALL.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 3");
    bench.configure(&wish.replace("vehicles = 12", "vehicles = 13"));
    let foreseen = |args: &[&str]| {
        let status = bench.run("convoy", &[&["status"], args].concat());
        assert_eq!(status.code, 1, "{status:?}");
        let said = |line: &&str| line.starts_with("the next run") || line.starts_with("changed");
        // How much it is changes with what drives by.
        let line = |line: &str| line.split(", about").next().unwrap_or_default().to_owned() + "\n";
        status.stdout.lines().filter(said).map(line).collect::<String>()
    };
    insta::assert_snapshot!(foreseen(&[]), @r"
    the next run makes again simulate-and-log: scene 0 (planned otherwise)
    the next run adds scenes 1-2
    changed: scenes.train.convoy/demo: 1 -> 3
    changed: traffic.vehicles: 12 -> 13
    ");
    insta::assert_snapshot!(foreseen(&["--grow"]), @"the next run adds scenes 1-2");
    assert!(bench.digests() == before, "status wrote");
}
