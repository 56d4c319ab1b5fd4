//! The layout `simbev2x`, there and back.

use std::path::{Path, PathBuf};
use std::process::Command;

use convoy_tests::{Bench, Outcome, check_in_python, digests, program};

use super::export;

pub(super) fn check(bench: &Bench) {
    let (processed, outcome) = export(bench, "simbev2x", "processed", &["--threads", "1"]);
    outcome.expect_done();
    let (raw, outcome) = export(bench, "simbev2x", "raw", &["--state", "raw"]);
    outcome.expect_done();
    let packages = ["numpy", "pyarrow", "PIL"];
    check_in_python("exports/simbev2x.py", &packages, &[&bench.store(), &processed, &raw]);

    imports_are_as_what_was_exported(bench, &processed, &raw);

    // Of the same bytes for any number of threads, wherever it stands.
    let prefix = processed.to_string_lossy().into_owned();
    let (again, outcome) = export(bench, "simbev2x", "again", &["--threads", "2", "--path-prefix", &prefix]);
    outcome.expect_done();
    assert_eq!(digests(&processed), digests(&again));

    let (_, refused) = export(bench, "simbev2x", "gaps", &["--agents", "vehicle_1,rsu_0"]);
    assert!(refused.code == 2 && refused.stderr.contains("without gaps"), "{}", refused.stderr);
    let (_, refused) = export(bench, "simbev2x", "rsus", &["--agents", "rsu_*"]);
    assert!(refused.code == 2 && refused.stderr.contains("vehicle_0"), "{}", refused.stderr);
    let (thin, outcome) = export(bench, "simbev2x", "thin", &["--every", "5", "--sensors", "LIDAR"]);
    outcome.expect_done();
    assert!(outcome.stdout.contains("frames between"), "{}", outcome.stdout);
    let sweeps = digests(&thin.join("simbev2x/sweeps/vehicle-0/LIDAR"));
    assert_eq!(sweeps.len(), 4, "frames 0, 5, 10, 15 of 20");
    assert!(sweeps.keys().next_back().is_some_and(|name| name.contains("frame-0003")), "numbered anew");
}

/// Runs `convoy import` of an export; the store's path and how it ended.
fn import(bench: &Bench, source: &Path, store: &str, args: &[&str]) -> (PathBuf, Outcome) {
    let store = bench.folder.path().join(store);
    let mut command = Command::new(program("convoy"));
    command.args(["import", "simbev2x", "--source"]).arg(source).arg("--store").arg(&store);
    let output = command.args(["--progress", "none"]).args(args).output().expect("the program starts");
    (store, Outcome::of(&output))
}

/// Runs a program on a store that is not the bench's own.
fn on(bench: &Bench, store: &Path, name: &str, args: &[&str]) -> Outcome {
    let mut command = Command::new(program(name));
    if name != "check" {
        command.arg("--config").arg(bench.config()).args(["--progress", "none"]);
    }
    Outcome::of(&command.arg("--store").arg(store).args(args).output().expect("the program starts"))
}

fn imports_are_as_what_was_exported(bench: &Bench, processed: &Path, raw: &Path) {
    let packages = ["numpy", "pyarrow", "PIL"];
    let (one, outcome) = import(bench, processed, "imported", &["--threads", "1"]);
    outcome.expect_done();
    check_in_python("exports/imported.py", &packages, &[&bench.store(), &one]);
    let (two, outcome) = import(bench, processed, "imported-again", &["--threads", "2"]);
    outcome.expect_done();
    assert_eq!(files(&one), files(&two), "other bytes for another number of threads");
    let (_, kept) = import(bench, processed, "imported", &[]);
    assert!(kept.stdout.contains("0 scenes imported"), "{}", kept.stdout);
    a_fresh_import_is_whole(bench, &one);

    // Tracks are made as of any store, statistics too; what would need the log is refused.
    on(bench, &one, "merge-tracks", &[]).expect_done();
    on(bench, &one, "bev-gt", &[]).expect_done();
    let refused = on(bench, &one, "bev-gt", &["--force"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("imported, without a log that bev-gt"), "{}", refused.stderr);
    on(bench, &one, "stats", &[]).expect_done();
    let status = Command::new(program("convoy")).args(["status", "--store"]).arg(&one).output();
    Outcome::of(&status.expect("the program starts")).expect_done();
    // With a configuration and without: an import has none.
    let config = bench.config().display().to_string();
    for given in [&["--config", &config][..], &[]] {
        let mut why = Command::new(program("convoy"));
        why.args(["status", "--why", "0"]).args(["merge-tracks"]).args(given).arg("--store").arg(&one);
        let why = Outcome::of(&why.output().expect("the program starts"));
        why.expect_done();
        assert!(why.stdout.contains("merge-tracks: done\n"), "{}", why.stdout);
        assert!(why.stdout.contains(": done\n    imported\n"), "{}", why.stdout);
    }
    let made_here = Command::new(program("convoy"))
        .args(["status", "--why", "0", "bev-gt", "--store"])
        .arg(bench.store())
        .output();
    let made_here = Outcome::of(&made_here.expect("the program starts"));
    // By the configuration that it was planned by.
    assert!(made_here.code == 0 && made_here.stdout.contains("bev-gt: done"), "{made_here:?}");
    on(bench, &one, "check", &[]).expect_done();
    exports_of_imports_say_what_they_lack(bench, &one);
    pictures_of_imports_say_what_they_lack(bench, &one);
    let (again, outcome) = import(bench, raw, "imported-raw", &[]);
    outcome.expect_done();
    check_in_python("exports/imported.py", &packages, &[&bench.store(), &again, Path::new("raw")]);
    let refused = on(bench, &again, "postprocess-valid", &[]);
    assert!(refused.code == 2 && refused.stderr.contains("imported"), "{}", refused.stderr);

    // What is somebody else's is left alone.
    let (_, refused) = import(bench, processed, "store", &[]);
    assert!(refused.code == 2 && refused.stderr.contains("made here"), "{}", refused.stderr);
    let (_, refused) = import(bench, processed, "imported-raw", &[]);
    assert!(refused.code == 2 && refused.stderr.contains("another scene"), "{}", refused.stderr);

    let scratch = bench.folder.path().join("foreign");
    std::fs::create_dir(&scratch).expect("made");
    check_in_python("exports/foreign.py", &packages, &[&program("import"), &scratch]);
}

/// An import has no configuration: none is asked for. What has not been made of it is no fault.
fn a_fresh_import_is_whole(bench: &Bench, store: &Path) {
    let folder = bench.folder.path().display().to_string();
    let run = |command: &str, store: &Path| {
        let mut program = Command::new(program("convoy"));
        program.arg(command).arg("--store").arg(store);
        Outcome::of(&program.output().expect("the program starts"))
    };
    let said = |text: &str| {
        let line = |line: &str| line.split_once("ERROR ").map_or(line, |(_, rest)| rest).to_owned();
        text.replace(&folder, "FOLDER").lines().map(line).collect::<Vec<_>>().join("\n")
    };
    let verified = run("verify", store);
    verified.expect_done();
    let notes = verified.stdout.lines().filter(|line| line.starts_with("note: "));
    insta::assert_snapshot!("verify-of-an-import", notes.collect::<Vec<_>>().join("\n"));
    assert!(verified.stdout.contains(": 0 faulty"), "{}", verified.stdout);
    let status = run("status", store);
    assert_eq!(status.code, 1, "tracks and statistics are missing: {status:?}");
    insta::assert_snapshot!("status-of-an-import", said(&status.stdout));
    // A file whose manifest was lost is found all the same.
    let manifest = store.join("scenes/0000/_manifests/postprocess-valid.json");
    let kept = std::fs::read(&manifest).expect("is there");
    std::fs::remove_file(&manifest).expect("goes");
    let faulty = run("verify", store);
    assert!(faulty.code == 1 && faulty.stdout.contains("boxes_valid.parquet: no manifest"), "{faulty:?}");
    std::fs::write(&manifest, kept).expect("is written");
    // What was made here has the configuration that it was planned by.
    let (told, by_file) = (run("status", &bench.store()), bench.run("convoy", &["status"]));
    assert_eq!((told.code, told.stdout), (by_file.code, by_file.stdout));
}

/// What the dataset did not say is no reading: thinned clouds go by elevation, labels of points and lanes are
/// left out.
fn exports_of_imports_say_what_they_lack(bench: &Bench, store: &Path) {
    let export = |layout: &str, dest: &str, args: &[&str]| {
        let dest = bench.folder.path().join(dest);
        let mut command = Command::new(program("export"));
        command.arg(layout).arg("--store").arg(store).arg("--dest").arg(&dest).args(args);
        let output = command.args(["--progress", "none"]).output().expect("the program starts");
        (dest, Outcome::of(&output))
    };
    let (dest, told) = export("opv2v", "imported-opv2v", &[]);
    told.expect_done();
    for word in ["scenes that were imported never had them", "bev_lane on convoy/demo", "it was imported"] {
        assert!(told.stdout.contains(word), "{word}: {}", told.stdout);
    }
    let bytes = |ending: &str| {
        let names = digests(&dest).into_keys().filter(|name| name.ends_with(ending));
        names.map(|name| dest.join(name).metadata().expect("is there").len()).sum::<u64>() as f64
    };
    let (all, half) = (bytes("_32.pcd"), bytes("_16.pcd"));
    assert!(all > 0.0 && (0.35..0.65).contains(&(half / all)), "{half} of {all}");

    let (_, refused) = export("nuscenes", "imported-nuscenes", &[]);
    assert!(refused.code == 2 && refused.stderr.contains("--no-map-mask"), "{}", refused.stderr);
    assert!(!refused.stderr.contains("spawn-planner"), "{}", refused.stderr);
    let (dest, told) = export("nuscenes", "imported-nuscenes", &["--no-map-mask"]);
    told.expect_done();
    assert!(told.stdout.contains("lidarseg (nobody knows the tags"), "{}", told.stdout);
    assert!(!digests(&dest).keys().any(|name| name.contains("lidarseg")), "neither a table nor a file");
}

/// Colours that nobody knows are refused; where nothing is chosen there are pictures.
fn pictures_of_imports_say_what_they_lack(bench: &Bench, store: &Path) {
    let run = |args: &[&str]| {
        let mut command = Command::new(program("viz"));
        let (head, rest) = args.split_at(usize::from(!args[0].starts_with('-')));
        command.args(head).arg("--store").arg(store).args(rest);
        Outcome::of(&command.output().expect("the program starts"))
    };
    let at = |name: &str| bench.folder.path().join(name).to_string_lossy().into_owned();
    let refused = run(&["--modes", "LIDAR-FAR", "--colour", "tag", "--dest", &at("tags")]);
    assert!(refused.code == 2 && refused.stderr.contains("nobody knows the tag"), "{}", refused.stderr);
    run(&["--modes", "LIDAR-FAR,SEG-LIDAR-FAR", "--dest", &at("usual")]).expect_done();
    assert!(Path::new(&at("usual")).join("vehicle_0/SEG-LIDAR-FAR").is_dir());
    run(&["preview", "--width", "800", "--out", &at("sheet.png")]).expect_done();
}

/// Digests of the files of a store but for its name, which stands in `dataset.json` and so in the plan's
/// manifest.
fn files(store: &Path) -> std::collections::BTreeMap<String, String> {
    let mut files = digests(store);
    files.retain(|name, _| name != "dataset.json" && name != "plan/_manifest.json");
    files
}
