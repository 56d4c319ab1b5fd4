//! Bad input: one clear message each, the right exit code, nothing lost.

use convoy_tests::{Bench, TINY, program};

#[test]
fn three_mistakes_give_three_messages() {
    let config = TINY
        .replace("seed = 11", "seed = \"eleven\"")
        .replace("width = 160\nheight = 90\nsemantic", "widht = 160\nheight = 90\nsemantic")
        .replace("channels = 16\ncolumns = 256\nsemantic", "channels = 0\ncolumns = 256\nsemantic");
    let bench = Bench::new(&config);
    let outcome = bench.run("spawn-planner", &[]);
    assert_eq!(outcome.code, 2);
    let line_of = |text: &str| config.lines().position(|l| l.contains(text)).expect("is in the file") + 1;
    let messages: Vec<&str> = outcome.stderr.lines().collect();
    assert_eq!(messages.len(), 3, "{messages:#?}");
    for (message, (text, key)) in messages.iter().zip([
        ("eleven", "`seed` is a string"),
        ("widht", "unknown key `vehicle.camera.widht` (did you mean `width`?)"),
        ("channels = 0", "`vehicle.lidar.channels` is 0"),
    ]) {
        let place = format!("config.toml:{}:", line_of(text));
        assert!(message.contains(&place) && message.contains(key), "{message}: expected {place} {key}");
    }
    assert!(!bench.store().exists());
}

/// The whole run and the stage it is at stop when it is told to.
#[test]
fn a_signal_to_the_driver_reaches_its_stage() {
    let bench = Bench::new(&TINY.replace("columns = 256", "columns = 4096"));
    let mut driver = bench.start("convoy", &["run"]);
    let parts = bench.store().join("scenes/0000/log");
    // Somewhere in the middle: the log stands, the sensors take a while.
    let start = std::time::Instant::now();
    while !parts.exists() && start.elapsed().as_secs() < 120 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let told = std::process::Command::new("kill").arg(driver.id().to_string()).status().expect("kill runs");
    assert!(told.success());
    let status = driver.wait().expect("the driver ends");
    assert_eq!(status.code(), Some(75), "{status}");
    // Nobody writes any more.
    let before = bench.digests();
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert_eq!(before, bench.digests());
}

#[test]
fn a_missing_map_says_where_it_was_looked_for() {
    let bench = Bench::new(&TINY.replace("convoy/demo", "Nowhere"));
    let outcome = bench.run("spawn-planner", &[]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("Nowhere") && outcome.stderr.contains("--maps"), "{outcome:?}");
    let maps = bench.folder.path().join("maps");
    std::fs::create_dir(&maps).expect("makes the folder");
    let outcome = bench.run("spawn-planner", &["--maps", maps.to_str().expect("is UTF-8")]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("maps/Nowhere.xodr"), "{outcome:?}");
}

#[test]
fn a_changed_map_is_planned_again() {
    let bench = Bench::new(&TINY.replace("convoy/demo", "Town"));
    let maps = bench.folder.path().join("maps");
    std::fs::create_dir(&maps).expect("makes the folder");
    let folder = maps.to_str().expect("is UTF-8");
    let file = maps.join("Town.xodr");
    let path = file.to_str().expect("is UTF-8");
    let town = |seed: &str| {
        let args = ["town", "--name", "convoy/demo", "--seed", seed, "--out", path];
        let status = std::process::Command::new(program("convoy")).args(args).status().expect("convoy runs");
        assert!(status.success(), "{status}");
    };
    town("7");
    bench.run("spawn-planner", &["--maps", folder]).expect_done();
    let first = bench.digests();
    bench.run("spawn-planner", &["--maps", folder]).expect_done();
    assert_eq!(first, bench.digests(), "nothing changed");
    town("8");
    let plan = bench.run("spawn-planner", &["--maps", folder, "--dry-run"]);
    assert!(plan.stdout.contains("source/maps/Town.xodr.zst changed"), "{plan:?}");
    bench.run("spawn-planner", &["--maps", folder]).expect_done();
    let second = bench.digests();
    assert!(first["maps/Town.xodr.zst"] != second["maps/Town.xodr.zst"]);
    // Without the folder the store is complete by itself.
    bench.run("spawn-planner", &[]).expect_done();
    assert_eq!(second, bench.digests());
}

#[test]
fn a_broken_map_is_named_with_its_line() {
    let bench = Bench::new(&TINY.replace("convoy/demo", "Broken"));
    let maps = bench.folder.path().join("maps");
    std::fs::create_dir(&maps).expect("makes the folder");
    let folder = maps.to_str().expect("is UTF-8").to_owned();
    let write = |text: &str| std::fs::write(maps.join("Broken.xodr"), text).expect("writes");
    for (text, place) in [
        ("<OpenDRIVE>\n<road id=\"1\"\n", "Broken.xodr: line 2"),
        ("<OpenDRIVE><header/>\n\n<road id=\"1\" length=\"nan\"/></OpenDRIVE>\n", "Broken.xodr: line 3"),
        ("", "Broken.xodr: line 1"),
        ("<OpenDRIVE><header revMajor=\"1\" revMinor=\"7\"/></OpenDRIVE>\n", "no driving lanes"),
    ] {
        write(text);
        let outcome = bench.run("spawn-planner", &["--maps", &folder]);
        assert_eq!(outcome.code, 1, "{text}: {outcome:?}");
        assert!(outcome.stderr.contains("Broken") && outcome.stderr.contains(place), "{text}: {outcome:?}");
        assert!(!outcome.stderr.contains("panicked"), "{outcome:?}");
    }
}

#[test]
fn a_stage_without_a_plan_says_what_to_run() {
    let bench = Bench::new(TINY);
    let outcome = bench.run("bev-gt", &[]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("spawn-planner first"), "{outcome:?}");
}

#[test]
fn unknown_scenes_and_arguments_are_refused() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    let outcome = bench.run("bev-gt", &["--scenes", "0,7"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("[7]"), "{outcome:?}");
    assert_eq!(bench.run("bev-gt", &["--sheens", "0"]).code, 2);
    let dry = bench.run("simulate-and-log", &["--dry-run"]);
    assert_eq!(dry.code, 0);
    assert!(dry.stdout.contains("would run simulate-and-log scene 0000 (missing)"), "{dry:?}");
    assert!(!bench.store().join("scenes").exists());
}

#[test]
fn one_bad_scene_leaves_the_others_alone() {
    // Scene 1 needs the log of scene 1, which nobody made.
    let bench = Bench::new(&TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2"));
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &["--scenes", "0"]).expect_done();
    let outcome = bench.run("bev-gt", &[]);
    assert_eq!(outcome.code, 1, "{outcome:?}");
    assert!(outcome.stderr.contains("bev-gt scene 0001: simulate-and-log is missing"), "{outcome:?}");
    assert!(outcome.stderr.contains("1 done, 0 kept, 1 failed"), "{outcome:?}");
    let status = bench.run("convoy", &["status"]);
    assert!(status.stdout.contains("failed: simulate-and-log is missing"), "{status:?}");
}
