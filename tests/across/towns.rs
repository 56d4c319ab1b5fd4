//! Towns as files: written, drawn, checked from outside, used by a dataset.

use std::io::Write;
use std::path::Path;
use std::process::Command;

use convoy_tests::{Bench, TINY, check_in_python, program};

/// Runs `convoy` in a folder: exit code, standard output, standard error.
fn convoy(folder: &Path, args: &[&str]) -> (i32, String, String) {
    let output = Command::new(program("convoy")).current_dir(folder).args(args).output().expect("starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_town_is_written_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let town = |args: &[&str]| convoy(at, &[&["town", "--name", "convoy/demo"], args].concat());
    let (code, _, err) = town(&["--out", "new/demo.xodr", "--picture", "demo.svg"]);
    assert_eq!(code, 0, "{err}");
    let network =
        opendrive::read_bytes(&std::fs::read(at.join("new/demo.xodr")).expect("is there")).expect("reads");
    assert_eq!(network.header.name, "convoy/demo");
    assert!(std::fs::read_to_string(at.join("demo.svg")).expect("is there").contains("convoy/demo"));

    assert_eq!(town(&["--seed", "8", "--out", "other.xodr"]).0, 0);
    assert_eq!(town(&["--out", "same.xodr"]).0, 0);
    let bytes = |name: &str| std::fs::read(at.join(name)).expect("is there");
    assert_eq!(bytes("same.xodr"), bytes("new/demo.xodr"));
    assert_ne!(bytes("other.xodr"), bytes("new/demo.xodr"));

    let (code, _, err) = convoy(
        at,
        &["map-picture", "--map", "same.xodr", "--out", "part.png", "--around=-20,30", "--radius", "50"],
    );
    assert_eq!(code, 0, "{err}");
    assert!(bytes("part.png").starts_with(b"\x89PNG"));
}

#[test]
fn wrong_requests_say_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::write(at.join("broken.xodr"), "<OpenDRIVE>\n<road").expect("writes");
    std::fs::write(at.join("mine.toml"), "style = \"grid\"\n[grid]\ncolums = 2\n").expect("writes");
    for (args, code, message) in [
        (&["town", "--name", "convoy/nowhere", "--out", "a.xodr"][..], 2, "convoy/demo"),
        (&["town", "--name", "convoy/demo", "--out", "a.xodr", "--picture", "a.jpg"], 2, ".svg or .png"),
        (&["town", "--parameters", "mine.toml", "--out", "a.xodr"], 2, "colums"),
        (&["map-picture", "--map", "broken.xodr", "--out", "a.png"], 1, "broken.xodr: line 2"),
        (&["map-picture", "--map", "missing.xodr", "--out", "a.png"], 2, "missing.xodr"),
        (&["map-picture", "--map", "broken.xodr", "--out", "a.png", "--around", "1;2"], 2, "120,-45"),
    ] {
        let (got, _, err) = convoy(at, args);
        assert_eq!(got, code, "{args:?}: {err}");
        assert!(err.contains(message), "{args:?}: {err}");
    }
    assert!(!at.join("a.xodr").exists() && !at.join("a.png").exists());
}

#[test]
fn a_dataset_takes_maps_by_their_path() {
    let bench = Bench::new(TINY);
    let at = bench.folder.path();
    assert_eq!(convoy(at, &["town", "--name", "convoy/demo", "--out", "maps/own.xodr"]).0, 0);
    let text = std::fs::read(at.join("maps/own.xodr")).expect("is there");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&text).expect("packs");
    std::fs::write(at.join("maps/packed.xodr.gz"), packed.finish().expect("packs")).expect("writes");

    let path = at.join("maps/own.xodr").display().to_string();
    for (written, stem, maps) in [(path.as_str(), "own", None), ("packed.xodr.gz", "packed", Some("maps"))] {
        bench.configure(&TINY.replace("convoy/demo", written));
        let folder = maps.map(|m| at.join(m).display().to_string());
        let args: Vec<&str> = folder.iter().flat_map(|f| ["--maps", f.as_str()]).collect();
        bench.run("spawn-planner", &args).expect_done();
        let kept = bench.store().join(format!("maps/{stem}.xodr.zst"));
        assert!(kept.is_file(), "{} is missing", kept.display());
    }
    let twice = format!("\"{path}\" = 1\n\"own.xodr\" = 1");
    bench.configure(&TINY.replace("\"convoy/demo\" = 1", &twice));
    let outcome = bench.run("spawn-planner", &[]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("both called `own`"), "{outcome:?}");
}

#[test]
fn a_scene_is_filmed() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let at = bench.folder.path();
    let film = |scene: &str, out: &str| {
        convoy(at, &["scene-video", "--store", "store", "--scene", scene, "--out", out, "--frames", "frames"])
    };
    let (code, _, err) = film("0", "film.png");
    assert_eq!(code, 0, "{err}");
    // One second, every second frame; the animation control chunk says how many.
    assert_eq!(std::fs::read_dir(at.join("frames")).expect("is there").count(), 10);
    let bytes = std::fs::read(at.join("film.png")).expect("is there");
    let control = bytes.windows(4).position(|w| w == b"acTL").expect("is animated");
    assert_eq!(bytes[control + 4..control + 8], [0, 0, 0, 10]);
    // Agents move, so no two frames are the same.
    let frame = |n: &str| std::fs::read(at.join("frames").join(n)).expect("is there");
    assert_ne!(frame("0000.png"), frame("0018.png"));

    let (code, _, err) = film("7", "film.png");
    assert!(code == 2 && err.contains("scene 7 has no log"), "{code}: {err}");
    let (code, _, err) = film("0", "film.gif");
    assert!(code == 2 && err.contains("must end in .png"), "{code}: {err}");
}

/// The reader of the script and the ASAM checker find nothing wrong with any town.
#[test]
fn outside_checkers_find_no_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, _, err) = convoy(folder.path(), &["towns", "--dest", "towns"]);
    assert_eq!(code, 0, "{err}");
    check_in_python("check_towns.py", &[], &[&folder.path().join("towns")]);
}
