//! Bad input: one clear message each, the right exit code, nothing lost.

use convoy_tests::{Bench, Outcome, TINY, program};

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
    // Twice, as a scheduler does that tells a script and all that it started.
    for _ in 0..2 {
        let told = std::process::Command::new("kill").arg(driver.id().to_string()).status();
        assert!(told.expect("kill runs").success());
    }
    let status = driver.wait().expect("the driver ends");
    assert_eq!(status.code(), Some(75), "{status}");
    let locks = bench.store().join("_locks");
    assert!(!locks.exists(), "both let the store go: {:?}", std::fs::read_dir(&locks));
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
    assert!(
        outcome.stderr.contains("is missing: run that first") && !outcome.stderr.contains("first: "),
        "{outcome:?}"
    );
    // Nothing was tried, so nothing failed: statistics cover the scene that is there, and say so.
    let status = bench.run("convoy", &["status"]);
    assert!(status.stdout.contains("missing") && !status.stdout.contains("failed"), "{status:?}");
    let stats = bench.run("stats", &[]);
    assert!(stats.code == 0 && stats.stderr.contains("statistics of 1 of 2 scenes"), "{stats:?}");
    let report = || std::fs::read_to_string(bench.store().join("stats/report.html")).expect("is there");
    assert!(report().contains("Statistics of 1 of 2 scenes"));
    let overview = std::fs::read_to_string(bench.store().join("stats/overview.csv")).expect("is there");
    assert!(overview.contains("scenes,1\nplanned_scenes,2\n"), "{overview}");

    // What is missing is named, with what else does not belong.
    std::fs::write(bench.store().join("scenes/0000/notes.txt"), "mine").expect("writes");
    let verify = bench.run("convoy", &["verify"]);
    assert_eq!(verify.code, 1);
    for line in [
        "scenes/0000/notes.txt: no manifest names this file",
        "scenes/0001/_manifests/bev-gt.json: no manifest: the stage is not done, or its manifest was deleted",
    ] {
        assert!(verify.stdout.lines().any(|l| l == line), "{line}: {verify:?}");
    }

    bench.run("simulate-and-log", &[]).expect_done();
    bench.run("bev-gt", &[]).expect_done();
    let status = bench.run("convoy", &["status"]);
    assert!(status.stdout.contains("stats: stale"), "{status:?}");
    bench.run("stats", &[]).expect_done();
    assert!(report().contains("Statistics of the dataset<"));

    // What is damaged is made again by the commands that are named.
    std::fs::remove_file(bench.store().join("scenes/0000/notes.txt")).expect("removes");
    let manifest =
        std::fs::read_to_string(bench.store().join("scenes/0001/_manifests/simulate-and-log.json"));
    let manifest: serde_json::Value = serde_json::from_str(&manifest.expect("is there")).expect("is JSON");
    let shard = bench.store().join(manifest["outputs"][0]["key"].as_str().expect("is a key"));
    let good = std::fs::read(&shard).expect("is there");
    std::fs::write(&shard, "nothing").expect("writes");
    let verify = bench.run("convoy", &["verify"]);
    let cures: Vec<&str> =
        verify.stdout.lines().filter_map(|line| line.strip_prefix("to make it again: convoy ")).collect();
    assert!(verify.code == 1 && cures.len() == 1, "{verify:?}");
    let words: Vec<&str> = cures[0].split(' ').collect();
    assert_eq!(words[..6], ["run", "--stages", "simulate-and-log", "--scenes", "1", "--force"]);
    bench.run("convoy", &words[..6]).expect_done();
    assert!(std::fs::read(&shard).expect("is there") == good);
}

/// Two machines that share a store and the scenes make what one would.
#[test]
fn shards_make_the_same_dataset_as_one_run() {
    let config = TINY.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 3");
    let stages = ["simulate-and-log", "bev-gt"];
    let whole = Bench::new(&config);
    whole.run("spawn-planner", &[]).expect_done();
    for stage in stages {
        whole.run(stage, &[]).expect_done();
    }

    let by_hand = Bench::new(&config);
    by_hand.run("spawn-planner", &[]).expect_done();
    let logs = |bench: &Bench| {
        (0..3).filter(|s| bench.store().join(format!("scenes/{s:04}/log")).exists()).collect()
    };
    by_hand.run(stages[0], &["--shard", "0/2"]).expect_done();
    let first: Vec<u32> = logs(&by_hand);
    assert_eq!(first, [0, 1], "the two scenes with an RSU take longest");
    by_hand.run(stages[0], &["--shard", "1/2"]).expect_done();
    let all: Vec<u32> = logs(&by_hand);
    assert_eq!(all, [0, 1, 2]);
    for shard in ["1/2", "0/2"] {
        by_hand.run(stages[1], &["--shard", shard]).expect_done();
    }
    assert_eq!(whole.digests(), by_hand.digests());

    // The same by the number of an array job, both at once.
    let by_array = Bench::new(&config);
    by_array.run("spawn-planner", &[]).expect_done();
    for stage in stages {
        let tasks = ["0", "1"].map(|task| {
            let mut command = by_array.command(stage, &["--shard", "2"]);
            command.env("SLURM_ARRAY_TASK_ID", task).spawn().expect("starts")
        });
        for mut task in tasks {
            assert!(task.wait().expect("ends").success());
        }
    }
    assert_eq!(whole.digests(), by_array.digests());
    let nowhere = by_array.run(stages[0], &["--shard", "2"]);
    assert!(nowhere.code == 2 && nowhere.stderr.contains("SLURM_ARRAY_TASK_ID"), "{nowhere:?}");
}

/// Whatever keeps a file of `convoy` from being written, the exit code is that of a stage that cannot write:
/// the limit on the size of files stands for quotas and full disks.
#[test]
fn convoy_ends_like_a_stage_when_it_cannot_write() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let town = folder.path().join("town.xodr");
    // Without the signal, the write itself fails (EFBIG).
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", script, "sh"]).arg(program("convoy"));
    command.args(["town", "--name", "convoy/demo", "--out"]).arg(&town);
    let outcome = Outcome::of(&command.output().expect("sh starts"));
    assert_eq!(outcome.code, 75, "{outcome:?}");
    assert!(outcome.stderr.contains("town.xodr: cannot write: File too large"), "{outcome:?}");
    assert!(!town.exists());
    // A folder that cannot be made.
    std::fs::write(folder.path().join("file"), "").expect("writes");
    let mut command = std::process::Command::new(program("convoy"));
    command.args(["town", "--name", "convoy/demo", "--out"]).arg(folder.path().join("file/town.xodr"));
    let outcome = Outcome::of(&command.output().expect("starts"));
    assert_eq!(outcome.code, 75, "{outcome:?}");
}

/// What a reader of scenes finds in a store of another version is told as a stage would tell it.
#[test]
fn convoy_ends_like_a_stage_when_a_store_is_of_another_version() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let path = bench.store().join("scenes/0000/_manifests/simulate-and-log.json");
    let manifest = std::fs::read_to_string(&path).expect("is there");
    let version = format!("\"format_version\": {}", schema::FORMAT_VERSION);
    assert!(manifest.contains(&version), "{manifest}");
    std::fs::write(&path, manifest.replace(&version, "\"format_version\": 99")).expect("writes");
    let mut film = std::process::Command::new(program("convoy"));
    film.args(["scene-video", "--scene", "0", "--store"]).arg(bench.store());
    film.arg("--out").arg(bench.folder.path().join("film.png"));
    let outcome = Outcome::of(&film.output().expect("starts"));
    assert!(outcome.code == 2 && outcome.stderr.contains("store format 99"), "{outcome:?}");
}

/// `dataset.json` of a release to come: nobody opens its store without a word.
#[test]
fn a_store_of_a_newer_format_is_refused_by_all() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    let path = bench.store().join("dataset.json");
    let dataset = std::fs::read_to_string(&path).expect("is there");
    let version = format!("\"format_version\": {}", schema::FORMAT_VERSION);
    assert!(dataset.contains(&version), "{dataset}");
    std::fs::write(&path, dataset.replace(&version, "\"format_version\": 99")).expect("writes");
    let before = bench.digests();
    let store = bench.store().display().to_string();
    let out = bench.folder.path().join("out.png").display().to_string();
    let mut said = vec![
        bench.run("spawn-planner", &["--force"]),
        bench.run("simulate-and-log", &[]),
        bench.run("convoy", &["status"]),
        bench.run("convoy", &["verify"]),
    ];
    for args in [
        &["check", "--store", &store][..],
        &["view", &store, "--no-open"],
        &["preview", "--store", &store, "--out", &out],
        &["export", "kitti", "--store", &store, "--dest", &out],
    ] {
        let output = std::process::Command::new(program("convoy")).args(args).output();
        said.push(Outcome::of(&output.expect("starts")));
    }
    let mut told = String::new();
    for outcome in said {
        let both = outcome.stderr.contains("store format 99")
            && outcome.stderr.contains(&schema::FORMAT_VERSION.to_string());
        assert!(outcome.code == 2 && both, "{outcome:?}");
        told.push_str(&outcome.stderr.replace(&bench.folder.path().display().to_string(), "FOLDER"));
    }
    insta::assert_snapshot!("stores-of-a-newer-format", told);
    assert_eq!(bench.digests(), before);
}

/// A wrong path is a wrong argument: nothing that another try would mend.
#[test]
fn a_store_where_a_file_is_or_nothing_is_a_wrong_argument() {
    let bench = Bench::new(TINY);
    let verify = bench.run("convoy", &["verify"]);
    assert!(verify.code == 2 && verify.stderr.contains("is no store"), "{verify:?}");
    let convoy = |args: &[&str]| {
        let output = std::process::Command::new(program("convoy")).args(args).output();
        Outcome::of(&output.expect("starts"))
    };
    let store = bench.store().display().to_string();
    let check = convoy(&["check", "--store", &store]);
    assert!(check.code == 2 && check.stderr.contains("is no store"), "{check:?}");
    let tidy = convoy(&["tidy", "--store", &store]);
    assert!(tidy.code == 2 && tidy.stderr.contains("is no store"), "{tidy:?}");
    let mut told = [&verify, &check, &tidy].map(|outcome| outcome.stderr.clone()).concat();
    std::fs::write(bench.store(), "a file").expect("is written");
    for (name, args) in [("spawn-planner", &[][..]), ("convoy", &["status"]), ("convoy", &["run"])] {
        let outcome = bench.run(name, args);
        assert!(outcome.code == 2 && outcome.stderr.contains("is a file"), "{name}: {outcome:?}");
        told.push_str(&outcome.stderr);
    }
    let below = format!("{store}/deep/er");
    let config = bench.config().display().to_string();
    let outcome = convoy(&["run", "--config", &config, "--store", &below, "--progress", "none"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("lies below a file"), "{outcome:?}");
    told.push_str(&outcome.stderr);
    let told = told.replace(&bench.folder.path().display().to_string(), "FOLDER");
    insta::assert_snapshot!("places-that-are-no-store", told);
}

#[test]
fn a_store_of_an_unknown_kind_says_what_is_known() {
    let bench = Bench::new(TINY);
    for (name, args) in [("spawn-planner", &[][..]), ("convoy", &["verify"]), ("convoy", &["status"])] {
        let mut command = std::process::Command::new(program(name));
        command.args(args).args(["--store", "ftp://server/set"]);
        if args != ["verify"] {
            command.arg("--config").arg(bench.config());
        }
        let output = command.output().expect("starts");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{name} {args:?}: {text}");
        assert!(text.contains("no store of kind `ftp`") && text.contains("file:///FOLDER"), "{text}");
    }
    let url = format!("file://{}", bench.store().display());
    let mut planner = std::process::Command::new(program("spawn-planner"));
    planner.arg("--config").arg(bench.config()).args(["--store", &url, "--progress", "none"]);
    assert!(planner.status().expect("starts").success());
    assert!(bench.store().join("dataset.json").is_file());
}
