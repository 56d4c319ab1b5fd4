//! What is suspicious is said once, with file and line, and is an error where a run is strict.

use convoy_tests::{Bench, Outcome, SMALL};

/// Rain that is hardly meant, and a rig of nobody.
fn odd() -> String {
    let weather = "\n[weather.initial]\nprecipitation = 0.7\nfog_density = 0\n[weather.final]\nprecipitation = 0\nfog_density = 0\n";
    format!("{SMALL}{weather}[[rigs]]\nagents = [\"vehicle_1\"]\n[rsu.imu]\nnoise_accel_mps2 = 0.1\n")
}

/// The lines of a program that name the configuration, from its name on.
fn said(bench: &Bench, outcome: &Outcome) -> String {
    let folder = format!("{}/", bench.folder.path().display());
    let lines = outcome.stderr.lines().filter_map(|line| line.split_once(folder.as_str()));
    lines.map(|(_, line)| format!("{line}\n")).collect()
}

#[test]
fn what_is_suspicious_is_said_once() {
    let bench = Bench::new(&odd());
    let planned = bench.run("spawn-planner", &[]);
    planned.expect_done();
    insta::assert_snapshot!(said(&bench, &planned), @r"
    config.toml:28: `weather.initial.precipitation` is 0.7 of 100 percent, next to nothing: write 70 if a share is meant
    config.toml:34: `rigs[0].agents`: no scene has `vehicle_1`: `agents.max_vehicles` allows one, number 0
    config.toml:35: `rsu.imu` has no effect: `rsu.imu.enabled` is false
    config.toml: `vehicle.lidar.weather`, `rsu.lidar.weather`, `rigs[0].lidar.weather` are false, and 1 of 1 scenes have rain or fog (0): these lidars do not feel it; switch it on, or fix `precipitation` and `fog_density` at 0
    ");
    // The plan stands: what is odd in it was said.
    let again = bench.run("spawn-planner", &[]);
    assert_eq!(said(&bench, &again).lines().count(), 3, "{again:?}");
    for stage in ["simulate-and-log", "render-sensors", "stats"] {
        assert_eq!(said(&bench, &bench.run(stage, &["--dry-run"])), "", "{stage}");
    }
    assert_eq!(said(&bench, &bench.run("convoy", &["status"])), "");
    assert_eq!(said(&bench, &bench.run("spawn-planner", &["--dry-run"])).lines().count(), 4);
}

#[test]
fn strict_runs_refuse_what_is_suspicious() {
    let bench = Bench::new(&odd());
    for (program, args) in [
        ("spawn-planner", &["--strict"][..]),
        ("spawn-planner", &["--strict", "--dry-run"]),
        ("convoy", &["run", "--strict"]),
        ("convoy", &["status", "--strict"]),
        ("render-sensors", &["--strict"]),
    ] {
        let outcome = bench.run(program, args);
        assert_eq!(outcome.code, 2, "{program} {args:?}: {outcome:?}");
        assert_eq!(said(&bench, &outcome).lines().count(), 3, "{program} {args:?}: {outcome:?}");
        assert!(outcome.stderr.contains("--strict: warnings are errors (3)"), "{outcome:?}");
        let all = outcome.stderr.replace(&bench.folder.path().display().to_string(), "FOLDER");
        insta::assert_snapshot!("strict-run", all);
        assert!(!bench.store().join("plan").exists(), "{program} {args:?}");
    }
    // What only the plan shows.
    let wet = SMALL.replace("[timing]", "[weather.initial]\nprecipitation = 70\n\n[timing]");
    bench.configure(&wet);
    for _ in 0..2 {
        let outcome = bench.run("convoy", &["run", "--strict"]);
        assert!(outcome.code == 2 && outcome.stderr.contains("have rain or fog (0)"), "{outcome:?}");
        assert!(!bench.store().join("scenes").exists());
        // A plan that was made without a word is looked at all the same.
        bench.run("spawn-planner", &[]).expect_done();
    }
    let fair = "[weather.initial]\nprecipitation = 0\nfog_density = 0\n[weather.final]\nprecipitation = 0\nfog_density = 0\n\n[timing]";
    bench.configure(&SMALL.replace("[timing]", fair));
    bench.run("spawn-planner", &["--strict", "--redo"]).expect_done();
    // Nothing but what is missing keeps it from 0.
    assert_eq!(bench.run("convoy", &["status", "--strict"]).code, 1);
}
