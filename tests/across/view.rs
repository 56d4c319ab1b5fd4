//! The viewer's page over a real store, in a headless Chromium: every mode at a desktop's and a phone's
//! width, an excerpt from a file. Errors on the console fail. `CONVOY_SHOTS` names a folder that keeps the
//! screenshots.

use std::env;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Array, ArrayRef, FixedSizeListArray, Float64Array};
use arrow_schema::DataType;
use convoy_tests::{Bench, Outcome, TINY, program, workspace};
use testkit::chromium;

use crate::evaluate::{perfect, write};

/// Looks at a page and keeps what it saw below a folder.
fn take_shots(chromium: &str, address: &str, folder: &Path) {
    let script = workspace().join("viewer/test/look.mjs");
    let output =
        Command::new("node").arg(script).args([chromium, address]).arg(folder).output().expect("node starts");
    Outcome::of(&output).expect_done();
    let measures = std::fs::read_to_string(folder.join("measures.json")).expect("measures are written");
    assert!(measures.contains("scriptMsPerFrame"), "{measures}");
    for picture in ["desktop-3d-tag", "desktop-bev", "phone-3d", "phone-choices"] {
        let bytes =
            std::fs::read(folder.join(picture).with_extension("png")).expect("a screenshot is written");
        assert!(bytes.len() > 10_000, "{picture} is empty");
    }
}

/// `convoy view`, ended with the test.
struct Served(Child);

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn serve(store: &Path, args: &[&str]) -> (Served, String) {
    let mut command = Command::new(program("convoy"));
    let mut child = command
        .arg("view")
        .arg(store)
        .arg("--no-open")
        .args(args)
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("is piped")).read_line(&mut line).expect("it says where it is");
    let address = line
        .split_whitespace()
        .find(|word| word.starts_with("http://"))
        .expect("names an address")
        .to_owned();
    (Served(child), address)
}

#[test]
fn the_page_shows_a_store_and_an_excerpt_of_it() {
    let Some(chromium) = chromium() else { return };
    let bench =
        Bench::new(&TINY.replace("semantic = true\ndepth", "boxes_2d = true\nsemantic = true\ndepth"));
    bench.run("convoy", &["run"]).expect_done();
    let kept = env::var_os("CONVOY_SHOTS").map(PathBuf::from);
    let shots = kept.unwrap_or_else(|| bench.folder.path().join("shots"));

    let (_served, address) = serve(&bench.store(), &[]);
    take_shots(&chromium, &address, &shots.join("store"));

    let page = bench.folder.path().join("excerpt.html");
    let mut command = Command::new(program("view"));
    command.arg(bench.store()).arg("--embed").arg(&page).args(["--scene", "0", "--frames", "4..16"]);
    Outcome::of(&command.output().expect("it starts")).expect_done();
    let size = std::fs::metadata(&page).expect("it is written").len();
    assert!(size < 15_000_000, "{size} bytes");
    take_shots(&chromium, &format!("file://{}", page.display()), &shots.join("excerpt"));
}

/// Who sees what and what a model found, over a store and in an excerpt: predictions are the store's boxes,
/// every fifth of them far from where it was.
#[test]
fn the_page_shows_what_partners_add_and_what_a_model_saw() {
    let Some(chromium) = chromium() else { return };
    let bench =
        Bench::new(&TINY.replace("semantic = true\ndepth", "boxes_2d = true\nsemantic = true\ndepth"));
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let mut columns = perfect(&bench);
    for (name, values) in &mut columns {
        if *name == "center_m" {
            *values = every_fifth_moved(values);
        }
    }
    let file = write(bench.folder.path(), "predictions.parquet", columns);
    let kept = env::var_os("CONVOY_SHOTS").map(PathBuf::from);
    let shots = kept.unwrap_or_else(|| bench.folder.path().join("shots"));
    let look = |address: &str, name: &str| {
        let script = workspace().join("viewer/test/ask.mjs");
        let mut look = Command::new("node");
        look.arg(script).args([&chromium, address]).arg(shots.join(name));
        Outcome::of(&look.output().expect("node starts")).expect_done();
    };
    let predictions = file.display().to_string();
    let (_served, address) = serve(&bench.store(), &["--predictions", &predictions]);
    look(&address, "ask");

    let page = bench.folder.path().join("excerpt.html");
    let mut command = Command::new(program("view"));
    command.arg(bench.store()).args(["--predictions", &predictions, "--scene", "0", "--frames", "4..12"]);
    Outcome::of(&command.arg("--embed").arg(&page).output().expect("it starts")).expect_done();
    look(&format!("file://{}", page.display()), "ask-excerpt");
}

/// A column of places, every fifth 30 m farther east.
fn every_fifth_moved(places: &ArrayRef) -> ArrayRef {
    let list = places.as_fixed_size_list();
    let numbers = list.values().as_primitive::<Float64Type>().values();
    let moved: Float64Array =
        numbers.iter().enumerate().map(|(i, v)| if i % 15 == 0 { v + 30.0 } else { *v }).collect();
    let DataType::FixedSizeList(item, width) = list.data_type() else { unreachable!("it is one") };
    Arc::new(FixedSizeListArray::try_new(Arc::clone(item), *width, Arc::new(moved), None).expect("is a list"))
}

/// What is not made yet is told with the stage that makes it.
#[test]
fn the_page_says_which_stage_to_run() {
    let Some(chromium) = chromium() else { return };
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let (_served, address) = serve(&bench.store(), &[]);
    let script = workspace().join("viewer/test/unfinished.mjs");
    let output = Command::new("node").arg(script).args([&chromium, &address]).output().expect("node starts");
    Outcome::of(&output).expect_done();
}

/// What the dataset of an imported store did not say is not painted, and no stage is named that has no log to
/// be made from.
#[test]
fn the_page_says_what_imports_do_not_know() {
    let Some(chromium) = chromium() else { return };
    let bench = Bench::new(TINY);
    bench.run("convoy", &["run", "--progress", "none"]).expect_done();
    let at = |name: &str| bench.folder.path().join(name);
    let run = |name: &str, args: &[&str], folders: [(&str, PathBuf); 2]| {
        let mut command = Command::new(program(name));
        command.args(args).args(["--progress", "none"]);
        folders.iter().for_each(|(option, folder)| {
            command.arg(option).arg(folder);
        });
        Outcome::of(&command.output().expect("it starts")).expect_done();
    };
    run("export", &["simbev2x"], [("--store", bench.store()), ("--dest", at("dataset"))]);
    run("import", &["simbev2x"], [("--source", at("dataset")), ("--store", at("imported"))]);
    let (_served, address) = serve(&at("imported"), &[]);
    let kept = env::var_os("CONVOY_SHOTS").map(PathBuf::from);
    let shots = kept.unwrap_or_else(|| at("shots"));
    let script = workspace().join("viewer/test/imported.mjs");
    let mut look = Command::new("node");
    look.arg(script).args([&chromium, &address]).arg(shots.join("imported"));
    Outcome::of(&look.output().expect("node starts")).expect_done();
}
