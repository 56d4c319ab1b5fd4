//! nuScenes' numbers against those of nuscenes-devkit's own algorithms, those of SimBEV2X, OPV2V and BEV
//! masks against implementations in numpy that were written apart from ours: `golden.py` says how they were
//! made.

use std::path::{Path, PathBuf};
use std::process::Command;

use evaluation::{
    Grid, MaskTally, NuScenesTally, Opv2vTally, Prediction, Sighting, SimBev2xTally, Solid, Target, passed,
};
use schema::{BevClass, Difficulty};
use serde_json::Value;

/// How far numbers may be apart.
const TOLERANCE: f64 = 1e-9;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/evaluation")
}

fn read(name: &str) -> Vec<Value> {
    read_at(&folder().join("golden").join(name))
}

fn read_at(path: &Path) -> Vec<Value> {
    serde_json::from_slice(&std::fs::read(path).expect("reads")).expect("is a list")
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
    let target = |(i, row): (usize, &Value)| {
        let difficulty = [Difficulty::Easy, Difficulty::Medium, Difficulty::Hard][number(&row[10]) as usize];
        let sighting = [Sighting::Ego, Sighting::Partners, Sighting::Nobody][i % 3];
        let (class, solid, attribute) = (class(row), solid(row), attribute(row));
        Target { class, solid, distance_m: distance_m(&solid), difficulty, sighting, attribute }
    };
    let prediction = |row: &Value| Prediction {
        class: class(row),
        score: number(&row[10]),
        solid: solid(row),
        distance_m: distance_m(&solid(row)),
        attribute: attribute(row),
    };
    let (targets, predictions) = (samples(case, "targets"), samples(case, "predictions"));
    let both = targets.iter().zip(&predictions);
    both.map(|(t, p)| (t.iter().enumerate().map(target).collect(), p.iter().map(prediction).collect()))
        .collect()
}

/// From where `golden.py` has the ego.
pub(crate) fn distance_m(solid: &Solid) -> f64 {
    let [x, y] = [solid.center_m[0] + 15.0, solid.center_m[1] - 5.0];
    (x * x + y * y).sqrt()
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

/// Adds the samples of a case, the first half to one tally, the others to another that is put behind it.
fn tallied<T: Default>(
    samples: &[(Vec<Target>, Vec<Prediction>)],
    add: impl Fn(&mut T, &[Target], &[Prediction]),
    append: impl Fn(&mut T, T),
) -> T {
    let (mut tally, mut later) = (T::default(), T::default());
    for (k, (targets, predictions)) in samples.iter().enumerate() {
        add(if k < samples.len() / 2 { &mut tally } else { &mut later }, targets, predictions);
    }
    append(&mut tally, later);
    tally
}

fn check_nuscenes(cases: impl IntoIterator<Item = Vec<(Vec<Target>, Vec<Prediction>)>>, expected: &[Value]) {
    let mut numbers = 0;
    for (i, (samples, want)) in cases.into_iter().zip(expected).enumerate() {
        let scores = tallied(&samples, NuScenesTally::add, NuScenesTally::append).scores(true);
        let name = |what: &str| format!("case {i}, {what}");
        numbers += check(scores.classes.iter().flat_map(|c| c.ap), &want["ap"], &name("AP"));
        numbers += check(scores.classes.iter().flat_map(|c| c.errors), &want["errors"], &name("errors"));
        numbers += check([scores.mean_ap()], &want["mean_ap"], &name("mAP"));
        numbers += check(scores.mean_errors(), &want["mean_errors"], &name("mean errors"));
        numbers += check([scores.nds()], &want["nds"], &name("NDS"));
    }
    assert_eq!(numbers, 8 * (40 + 50 + 1 + 5 + 1));
}

#[test]
fn nuscenes_scores_are_those_of_its_devkit() {
    check_nuscenes(cases(), &read("nuscenes.json"));
}

#[test]
fn the_devkit_says_the_same_of_other_cases() {
    let Some(python) = testkit::devkit() else { return };
    let temporary = tempfile::tempdir().expect("a temporary folder");
    for seed in ["1", "2", "3"] {
        let mut golden = Command::new(&python);
        golden.arg(folder().join("golden.py")).arg("live").arg(temporary.path()).arg(seed);
        assert!(golden.status().expect("Python starts").success(), "seed {seed}");
        let cases = read_at(&temporary.path().join("cases.json"));
        check_nuscenes(cases.iter().map(case), &read_at(&temporary.path().join("nuscenes.json")));
    }
}

fn check_simbev2x(expected: &[Value]) {
    let mut numbers = 0;
    for (i, (samples, want)) in cases().into_iter().zip(expected).enumerate() {
        let scores = tallied(&samples, SimBev2xTally::add, SimBev2xTally::append).scores();
        let name = |what: &str| format!("case {i}, {what}");
        numbers += check(scores.classes.iter().flat_map(|c| c.ap).flatten(), &want["ap"], &name("AP"));
        numbers +=
            check(scores.classes.iter().flat_map(|c| c.errors).flatten(), &want["errors"], &name("errors"));
        numbers += check(scores.mean_ap(), &want["mean_ap"], &name("mAP"));
        numbers += check(scores.mean_errors(), &want["mean_errors"], &name("mean errors"));
        numbers += check([scores.sds()], &want["sds"], &name("SDS"));
    }
    assert_eq!(numbers, 8 * (360 + 160 + 9 + 4 + 1));
}

fn check_simbev2x_iou(expected: &[Value]) {
    let mut numbers = 0;
    for (i, (samples, want)) in cases().into_iter().zip(expected).enumerate() {
        let scores = tallied(&samples, SimBev2xTally::add_by_overlap, SimBev2xTally::append).scores();
        let name = |what: &str| format!("case {i}, by overlap, {what}");
        let of_all = scores.classes.iter().flat_map(|class| class.ap.map(|levels| levels[0]));
        numbers += check(of_all, &want["ap"], &name("AP"));
        numbers += check(scores.mean_ap(), &want["mean_ap"], &name("mAP"));
        numbers += check(scores.mean_errors(), &want["mean_errors"], &name("mean errors"));
        numbers += check([scores.sds()], &want["sds"], &name("SDS"));
    }
    assert_eq!(numbers, 8 * (90 + 9 + 4 + 1));
}

fn check_opv2v(expected: &[Value]) {
    let mut numbers = 0;
    for (i, (samples, want)) in cases().into_iter().zip(expected).enumerate() {
        let scores = tallied(&samples, Opv2vTally::add, Opv2vTally::append).scores();
        numbers += check(scores.sorted, &want["sorted"], &format!("case {i}, sorted"));
        numbers += check(scores.by_frame, &want["by_frame"], &format!("case {i}, by frame"));
    }
    assert_eq!(numbers, 8 * 6);
}

/// Digits of tenths as how many thresholds they reach, `[classes, rows, columns]`.
fn digits(frame: &Value) -> Vec<u8> {
    let rows =
        frame.as_array().expect("has classes").iter().flat_map(|class| class.as_array().expect("has rows"));
    let digits = rows.flat_map(|row| row.as_str().expect("is digits").chars());
    digits.map(|digit| digit.to_digit(16).expect("is a digit") as u8).collect()
}

fn check_masks(expected: &[Value]) {
    let classes = [BevClass::Road, BevClass::Car, BevClass::Rider];
    for (i, case) in expected.iter().enumerate() {
        let name = |what: &str| format!("case {i}, {what}");
        let at = |k: usize| number(&case["grid"][k]);
        let grid = Grid::new((at(0) as usize, at(1)), (at(2) as usize, at(3))).expect("lies on the other");
        let (mut tally, mut later) = (MaskTally::new(&classes), MaskTally::new(&classes));
        let frames = |what: &str| case[what].as_array().expect("has frames").clone();
        for (k, (labels, scores)) in frames("labels").iter().zip(frames("scores")).enumerate() {
            let reached = |tenths: u8| passed(f32::from(tenths) / 10.0).expect("is a score");
            let scores: Vec<u8> = digits(&scores).into_iter().map(reached).collect();
            let part = if k == 0 { &mut tally } else { &mut later };
            assert!(part.add(&grid, &digits(labels), &scores));
            assert!(
                !part.add(&grid, &digits(labels)[1..], &scores) && !part.add(&grid, &digits(labels), &[])
            );
        }
        tally.append(&later);
        let scores = tally.scores();
        assert_eq!(scores.frames, 3);
        check(scores.classes.iter().flat_map(|c| c.iou).flatten(), &case["iou"], &name("IoU"));
        check(scores.mean_iou().into_iter().flatten(), &case["mean_iou"], &name("mIoU"));
        let confused = scores.confusion.iter().flatten().map(|cells| *cells as f64);
        check(confused, &case["confusion"], &name("confusion"));
    }
    assert_eq!(expected.len(), 3);
}

#[test]
fn scores_are_those_of_a_second_implementation() {
    check_simbev2x(&read("simbev2x.json"));
    check_simbev2x_iou(&read("simbev2x_iou.json"));
    check_opv2v(&read("opv2v.json"));
    check_masks(&read("masks.json"));
}

#[test]
fn the_second_implementation_still_gives_them() {
    let Some(python) = testkit::python(&["numpy"]) else { return };
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let again = |what: &str| -> Vec<Value> {
        let file = temporary.path().join(what);
        let status = Command::new(&python).arg(folder().join("golden.py")).arg(what).arg(&file).status();
        assert!(status.expect("Python starts").success(), "{what}");
        serde_json::from_slice(&std::fs::read(file).expect("reads")).expect("is a list")
    };
    check_simbev2x(&again("simbev2x"));
    check_simbev2x_iou(&again("simbev2x_iou"));
    check_opv2v(&again("opv2v"));
    check_masks(&again("masks"));
}
