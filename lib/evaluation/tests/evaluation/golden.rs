//! nuScenes' numbers against those of nuscenes-devkit's own algorithms, SimBEV2X's against an implementation in numpy that was
//! written apart from ours: `golden.py` says how they were made.

use std::path::{Path, PathBuf};
use std::process::Command;

use evaluation::{NuScenesTally, Prediction, SimBev2xTally, Solid, Target};
use schema::Difficulty;
use serde_json::Value;

/// How far numbers may be apart.
const TOLERANCE: f64 = 1e-9;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/evaluation")
}

fn read(name: &str) -> Vec<Value> {
    let bytes = std::fs::read(folder().join("golden").join(name)).expect("reads");
    serde_json::from_slice(&bytes).expect("is a list")
}

/// A number; NaN where there is none.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn solid(row: &Value) -> Solid {
    let at = |i: usize| number(&row[i]);
    Solid {
        center_m: [at(1), at(2), at(3)],
        size_m: [at(4), at(5), at(6)],
        yaw_rad: at(7),
        velocity_mps: [at(8), at(9)],
    }
}

fn class(row: &Value) -> usize {
    row[0].as_u64().expect("is a class") as usize
}

fn attribute(row: &Value) -> Option<u8> {
    u8::try_from(row[11].as_i64().expect("is an attribute or -1")).ok()
}

fn samples(case: &Value, side: &str) -> Vec<Vec<Value>> {
    let lists = case[side].as_array().expect("has samples");
    lists.iter().map(|list| list.as_array().expect("is a list").clone()).collect()
}

/// The samples of a case: targets and predictions.
pub(crate) fn case(case: &Value) -> Vec<(Vec<Target>, Vec<Prediction>)> {
    let target = |row: &Value| {
        let difficulty = [Difficulty::Easy, Difficulty::Medium, Difficulty::Hard][number(&row[10]) as usize];
        Target { class: class(row), solid: solid(row), difficulty, attribute: attribute(row) }
    };
    let prediction = |row: &Value| Prediction {
        class: class(row),
        score: number(&row[10]),
        solid: solid(row),
        attribute: attribute(row),
    };
    let (targets, predictions) = (samples(case, "targets"), samples(case, "predictions"));
    let both = targets.iter().zip(&predictions);
    both.map(|(t, p)| (t.iter().map(target).collect(), p.iter().map(prediction).collect())).collect()
}

/// All cases.
pub(crate) fn cases() -> Vec<Vec<(Vec<Target>, Vec<Prediction>)>> {
    read("cases.json").iter().map(case).collect()
}

/// Compares numbers with those of a list of lists of any depth; how many they are.
#[track_caller]
fn check(found: impl IntoIterator<Item = f64>, expected: &Value, what: &str) -> usize {
    fn flat(value: &Value, into: &mut Vec<f64>) {
        match value.as_array() {
            Some(list) => list.iter().for_each(|value| flat(value, into)),
            None => into.push(number(value)),
        }
    }
    let (mut want, found) = (Vec::new(), found.into_iter().collect::<Vec<_>>());
    flat(expected, &mut want);
    assert_eq!(found.len(), want.len(), "{what}");
    for (i, (found, want)) in found.iter().zip(&want).enumerate() {
        let is_same = found.is_nan() && want.is_nan() || (found - want).abs() <= TOLERANCE;
        assert!(is_same, "{what}: number {i} is {found}, expected {want}");
    }
    want.len()
}

#[test]
fn nuscenes_scores_are_those_of_its_devkit() {
    let mut numbers = 0;
    for (i, (samples, want)) in cases().into_iter().zip(read("nuscenes.json")).enumerate() {
        // In two parts, put together.
        let (mut tally, mut later) = (NuScenesTally::default(), NuScenesTally::default());
        for (k, (targets, predictions)) in samples.iter().enumerate() {
            let part = if k < samples.len() / 2 { &mut tally } else { &mut later };
            part.add(targets, predictions);
        }
        tally.append(later);
        let scores = tally.scores();
        let name = |what: &str| format!("case {i}, {what}");
        numbers += check(scores.classes.iter().flat_map(|c| c.ap), &want["ap"], &name("AP"));
        numbers += check(scores.classes.iter().flat_map(|c| c.errors), &want["errors"], &name("errors"));
        numbers += check([scores.mean_ap()], &want["mean_ap"], &name("mAP"));
        numbers += check(scores.mean_errors(), &want["mean_errors"], &name("mean errors"));
        numbers += check([scores.nds()], &want["nds"], &name("NDS"));
    }
    assert_eq!(numbers, 8 * (40 + 50 + 1 + 5 + 1));
}

fn check_simbev2x(expected: &[Value]) {
    let mut numbers = 0;
    for (i, (samples, want)) in cases().into_iter().zip(expected).enumerate() {
        let (mut tally, mut later) = (SimBev2xTally::default(), SimBev2xTally::default());
        for (k, (targets, predictions)) in samples.iter().enumerate() {
            let part = if k < samples.len() / 2 { &mut tally } else { &mut later };
            part.add(targets, predictions);
        }
        tally.append(later);
        let scores = tally.scores();
        let name = |what: &str| format!("case {i}, {what}");
        numbers += check(scores.classes.iter().flat_map(|c| c.ap).flatten(), &want["ap"], &name("AP"));
        numbers +=
            check(scores.classes.iter().flat_map(|c| c.errors).flatten(), &want["errors"], &name("errors"));
        numbers += check(scores.mean_ap(), &want["mean_ap"], &name("mAP"));
        numbers += check(scores.mean_errors(), &want["mean_errors"], &name("mean errors"));
        numbers += check([scores.sds()], &want["sds"], &name("SDS"));
    }
    assert_eq!(numbers, 8 * (160 + 160 + 4 + 4 + 1));
}

#[test]
fn simbev2x_scores_are_those_of_a_second_implementation() {
    check_simbev2x(&read("simbev2x.json"));
}

#[test]
fn the_second_implementation_still_gives_them() {
    let Some(python) = testkit::python(&["numpy"]) else { return };
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let file = temporary.path().join("scores.json");
    let script = folder().join("golden.py");
    let status = Command::new(python).arg(script).arg("simbev2x").arg(&file).status();
    assert!(status.expect("Python starts").success());
    check_simbev2x(
        &serde_json::from_slice::<Vec<Value>>(&std::fs::read(file).expect("reads")).expect("is a list"),
    );
}
