//! What must hold whatever the numbers are.

use evaluation::{LEVELS, NuScenesTally, Prediction, Sighting, SimBev2xScores, SimBev2xTally, Solid, Target};
use schema::Difficulty;

use crate::golden::cases;

/// Boxes on a grid, so far apart that each can be taken for itself alone.
fn targets() -> Vec<Target> {
    let target = |i: usize| Target {
        class: i % 10,
        solid: Solid {
            center_m: [10.0 * i as f64, 0.0, 1.0],
            size_m: [4.0, 2.0, 1.5],
            yaw_rad: 0.1 * i as f64,
            velocity_mps: [1.0, i as f64],
        },
        distance_m: 10.0 * i as f64,
        difficulty: [Difficulty::Easy, Difficulty::Medium, Difficulty::Hard][i / 10 % 3],
        sighting: [Sighting::Ego, Sighting::Partners][i / 10 % 2],
        attribute: None,
    };
    (0..90).map(target).collect()
}

fn copy(target: &Target, score: f64) -> Prediction {
    let Target { class, solid, distance_m, .. } = *target;
    Prediction { class, score, solid, distance_m, attribute: None }
}

fn simbev2x(samples: &[(Vec<Target>, Vec<Prediction>)]) -> SimBev2xScores {
    let mut tally = SimBev2xTally::default();
    samples.iter().for_each(|(targets, predictions)| tally.add(targets, predictions));
    tally.scores()
}

#[test]
fn copies_of_which_every_third_is_shifted() {
    let targets = targets();
    let predictions = targets.iter().enumerate().map(|(i, target)| {
        let mut found = copy(target, 0.5);
        found.solid.center_m[2] += if (i / 10).is_multiple_of(3) { 0.6 } else { 0.0 };
        found
    });
    let scores = simbev2x(&[(targets.clone(), predictions.collect())]);
    for class in &scores.classes {
        assert_eq!(class.targets[..4], [9, 3, 3, 3]);
        assert_eq!(class.targets[4..7].iter().sum::<u64>(), 9);
        assert_eq!(class.targets[7..], [5, 4]);
        for (ap, targets) in class.ap[1..].iter().flat_map(|ap| ap.iter().zip(class.targets)) {
            assert!(if targets == 0 { ap.is_nan() } else { *ap == 1.0 }, "{}: {ap} of {targets}", class.name);
        }
        assert_eq!(class.ap[0][1], 0.0, "easy ones are shifted farther than 0.5 m");
        assert_eq!(class.errors[0], [0.0; 4]);
        for errors in &class.errors[1..] {
            assert!((errors[0] - 0.6 * 3.0 / 9.0).abs() < 1e-12 && errors[1..] == [0.0; 3], "{errors:?}");
        }
    }
}

#[test]
fn perfect_twice_and_no_predictions() {
    let targets = targets();
    let once: Vec<Prediction> = targets.iter().map(|target| copy(target, 0.9)).collect();
    let perfect = simbev2x(&[(targets.clone(), once.clone())]);
    assert_eq!((perfect.mean_ap(), perfect.mean_errors(), perfect.sds()), ([1.0; LEVELS], [0.0; 4], 1.0));
    // What comes a second time, less sure, changes nothing.
    let twice = [once.clone(), targets.iter().map(|target| copy(target, 0.1)).collect()].concat();
    assert_eq!(simbev2x(&[(targets.clone(), twice)]).sds(), 1.0);
    let nothing = simbev2x(&[(targets.clone(), Vec::new())]);
    assert_eq!((nothing.mean_ap(), nothing.sds()), ([0.0; LEVELS], 0.0));
    assert!(nothing.mean_errors()[0].is_nan());
    assert!(simbev2x(&[(Vec::new(), once.clone())]).sds().is_nan());
    let mut nuscenes = NuScenesTally::default();
    nuscenes.add(&targets, &once);
    let scores = nuscenes.scores(true);
    assert!((scores.mean_ap() - 1.0).abs() < 1e-12, "{}", scores.mean_ap());
    // Attributes that are unknown are a whole error; where no prediction says any there is no such error.
    assert!((scores.nds() - 0.9).abs() < 1e-12, "{}", scores.nds());
    let scores = nuscenes.scores(false);
    assert!((scores.nds() - 1.0).abs() < 1e-12 && scores.mean_errors()[4].is_nan(), "{}", scores.nds());
    assert_eq!(scores.nds_name(), "NDS without AAE");
}

#[test]
fn scores_count_by_their_order_alone() {
    for samples in cases() {
        let cubed = samples.iter().map(|(targets, predictions)| {
            let cube = |p: &Prediction| Prediction { score: p.score * p.score * p.score * 7.0 - 3.0, ..*p };
            (targets.clone(), predictions.iter().map(cube).collect())
        });
        let cubed: Vec<_> = cubed.collect();
        let same = |one: &SimBev2xScores, other: &SimBev2xScores| format!("{one:?}") == format!("{other:?}");
        assert!(same(&simbev2x(&samples), &simbev2x(&cubed)));
    }
}

#[test]
fn a_turn_of_the_world_changes_nothing() {
    let turn = |solid: &Solid| {
        // A quarter, and somewhere else.
        let [x, y, z] = solid.center_m;
        let [vx, vy] = solid.velocity_mps;
        Solid {
            center_m: [100.0 - y, x - 50.0, z + 3.0],
            yaw_rad: solid.yaw_rad + std::f64::consts::FRAC_PI_2,
            velocity_mps: [-vy, vx],
            ..*solid
        }
    };
    for samples in cases() {
        let turned = samples.iter().map(|(targets, predictions)| {
            let targets = targets.iter().map(|t| Target { solid: turn(&t.solid), ..*t }).collect();
            (targets, predictions.iter().map(|p| Prediction { solid: turn(&p.solid), ..*p }).collect())
        });
        let (one, other) = (simbev2x(&samples), simbev2x(&turned.collect::<Vec<_>>()));
        assert!((one.sds() - other.sds()).abs() < 1e-9, "{} {}", one.sds(), other.sds());
    }
}
