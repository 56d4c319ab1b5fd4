//! nuScenes' detection metrics: mAP, five errors, NDS.
//!
//! Defined by nuscenes-devkit 1.2.0 (`eval/detection`, configuration `detection_cvpr_2019`); tests hold all
//! numbers against its own code.

use rayon::prelude::*;

use crate::boxes::{Prediction, Target};
use crate::interpolation::{interpolate, running_means};
use crate::matching::{Distances, by_score};
use crate::protocol::{THRESHOLDS_M, mean_of_numbers};

/// Classes in the devkit's order with the distance from the ego up to which they count, m.
const CLASSES: [(&str, f64); 10] = [
    ("car", 50.0),
    ("truck", 50.0),
    ("bus", 50.0),
    ("trailer", 50.0),
    ("construction_vehicle", 50.0),
    ("pedestrian", 40.0),
    ("motorcycle", 40.0),
    ("bicycle", 40.0),
    ("traffic_cone", 30.0),
    ("barrier", 30.0),
];
const CONE: usize = 8;
const BARRIER: usize = 9;
/// Names of the errors.
pub(crate) const ERRORS: [&str; 5] = ["ATE", "ASE", "AOE", "AVE", "AAE"];
/// Which of them is that of attributes.
const AAE: usize = 4;
/// The one of [`THRESHOLDS_M`] at which errors are taken: 2 m.
const ERRORS_AT: usize = 2;
/// Recalls 0, 0.01, ..., 1.
const RECALLS: usize = 101;
/// The first of them that counts: 0.11.
const FIRST: usize = 11;
/// Precision below this counts as none.
const MIN_PRECISION: f64 = 0.1;

/// The number of a class among nuScenes', and the distance from the ego up to which it counts, m.
pub(crate) fn class_named(name: &str) -> Option<(usize, f64)> {
    CLASSES.iter().enumerate().find(|(_, c)| c.0 == name).map(|(i, c)| (i, c.1))
}

/// A prediction with what it found.
#[derive(Clone, Copy, Debug)]
struct Hit {
    score: f64,
    /// A bit for each threshold at which it found a target.
    found: u8,
    /// Which of the errors are its own, if it found one at 2 m.
    errors: u32,
}

#[derive(Clone, Debug, Default)]
struct ClassTally {
    targets: u64,
    hits: Vec<Hit>,
    errors: Vec<[f64; 5]>,
}

/// What was found and what not, sample by sample.
#[derive(Clone, Debug)]
pub struct NuScenesTally {
    classes: Vec<ClassTally>,
}

impl Default for NuScenesTally {
    fn default() -> Self {
        Self { classes: vec![ClassTally::default(); CLASSES.len()] }
    }
}

impl NuScenesTally {
    /// Adds a sample's targets and predictions, whose classes are numbers of nuScenes'. Of equal scores the
    /// later counts as the surer, within a sample and among samples.
    pub fn add(&mut self, targets: &[Target], predictions: &[Prediction]) {
        for (class, tally) in self.classes.iter_mut().enumerate() {
            let targets: Vec<&Target> = targets.iter().filter(|t| t.class == class).collect();
            let own: Vec<&Prediction> = predictions.iter().filter(|p| p.class == class).collect();
            tally.add(class, &targets, &own);
        }
    }

    /// Adds what another has of later samples.
    pub fn append(&mut self, later: Self) {
        for (class, later) in self.classes.iter_mut().zip(later.classes) {
            let offset = class.errors.len() as u32;
            class.targets += later.targets;
            class.errors.extend(later.errors);
            class.hits.extend(later.hits.into_iter().map(|hit| Hit { errors: hit.errors + offset, ..hit }));
        }
    }

    /// The scores of all samples; without AAE where predictions say no attributes.
    #[must_use]
    pub fn scores(&self, has_attributes: bool) -> NuScenesScores {
        let classes = self.classes.par_iter().enumerate();
        let classes = classes.map(|(class, tally)| tally.scores(class, has_attributes));
        NuScenesScores { classes: classes.collect(), has_attributes }
    }
}

impl ClassTally {
    fn add(&mut self, class: usize, targets: &[&Target], predictions: &[&Prediction]) {
        self.targets += targets.len() as u64;
        let mut order: Vec<usize> = (0..predictions.len()).collect();
        order.sort_unstable_by(|a, b| by_score(predictions[*a].score, predictions[*b].score).then(b.cmp(a)));
        let surest: Vec<&Prediction> = order.iter().map(|i| predictions[*i]).collect();
        let distances = Distances::new(&surest, targets, |p, t| t.solid.planar_distance_m(&p.solid));
        let first = self.hits.len();
        self.hits.extend(predictions.iter().map(|p| Hit { score: p.score, found: 0, errors: 0 }));
        for (bit, threshold_m) in THRESHOLDS_M.into_iter().enumerate() {
            let found = distances.assign(surest.len(), |away| away < threshold_m);
            for (position, target) in found.into_iter().enumerate() {
                let Some(target) = target else { continue };
                let hit = &mut self.hits[first + order[position]];
                hit.found |= 1 << bit;
                if bit == ERRORS_AT {
                    hit.errors = self.errors.len() as u32;
                    self.errors.push(errors(class, targets[target], surest[position]));
                }
            }
        }
    }

    fn scores(&self, class: usize, has_attributes: bool) -> NuScenesClass {
        let mut order: Vec<u32> = (0..self.hits.len() as u32).collect();
        let hit = |i: u32| self.hits[i as usize];
        order.par_sort_unstable_by(|a, b| by_score(hit(*a).score, hit(*b).score).then(b.cmp(a)));
        let surest: Vec<Hit> = order.into_iter().map(hit).collect();
        let recalls = [0, 1, 2, 3].map(|bit| Resampled::new(&surest, bit, self.targets));
        let ap = recalls.each_ref().map(|r| r.as_ref().map_or(0.0, Resampled::average_precision));
        let mut errors = recalls[ERRORS_AT].as_ref().map_or([1.0; 5], |at| self.errors(&surest, at));
        let unknown: &[usize] = match class {
            CONE => &[2, 3, 4],
            BARRIER => &[3, 4],
            _ => &[],
        };
        unknown.iter().for_each(|error| errors[*error] = f64::NAN);
        if !has_attributes {
            errors[AAE] = f64::NAN;
        }
        NuScenesClass { name: CLASSES[class].0, targets: self.targets, ap, errors }
    }

    /// The five errors at 2 m: means over the recalls that are reached of the running means.
    fn errors(&self, surest: &[Hit], at: &Resampled) -> [f64; 5] {
        let found: Vec<&Hit> = surest.iter().filter(|hit| hit.found >> ERRORS_AT & 1 == 1).collect();
        let last = at.scores.iter().rposition(|score| *score != 0.0).unwrap_or(0);
        if last < FIRST {
            return [1.0; 5];
        }
        // From the least sure on: points of a line go up.
        let scores: Vec<f64> = found.iter().rev().map(|hit| hit.score).collect();
        [0, 1, 2, 3, 4].map(|error| {
            let values: Vec<f64> = found.iter().map(|hit| self.errors[hit.errors as usize][error]).collect();
            let mut means = running_means(&values);
            means.reverse();
            let at_recall = at.scores[FIRST..=last].iter().map(|s| interpolate(*s, &scores, &means, None));
            at_recall.sum::<f64>() / (last + 1 - FIRST) as f64
        })
    }
}

/// The errors of a pair, in the order of [`ERRORS`].
fn errors(class: usize, target: &Target, prediction: &Prediction) -> [f64; 5] {
    use std::f64::consts::{PI, TAU};
    let (truth, guess) = (&target.solid, &prediction.solid);
    // Of a barrier nobody can tell the front.
    let period = if class == BARRIER { PI } else { TAU };
    let attribute = match target.attribute {
        None => f64::NAN,
        known if known == prediction.attribute => 0.0,
        _ => 1.0,
    };
    [
        truth.planar_distance_m(guess),
        truth.scale_error(guess),
        truth.yaw_error_rad(guess, period),
        truth.velocity_error_mps(guess),
        attribute,
    ]
}

/// Precision and score at each of the recalls.
struct Resampled {
    precisions: Vec<f64>,
    scores: Vec<f64>,
}

impl Resampled {
    /// Of predictions, surest first; none where no target is found.
    fn new(surest: &[Hit], bit: usize, targets: u64) -> Option<Self> {
        let (mut found, mut recalls, mut precisions) = (0_u64, Vec::new(), Vec::new());
        for (i, hit) in surest.iter().enumerate() {
            found += u64::from(hit.found >> bit & 1);
            recalls.push(found as f64 / targets as f64);
            precisions.push(found as f64 / (i + 1) as f64);
        }
        if found == 0 {
            return None;
        }
        let scores: Vec<f64> = surest.iter().map(|hit| hit.score).collect();
        let at = |ys: &[f64]| -> Vec<f64> {
            // As numpy's linspace counts them.
            let recall = |i: usize| if i + 1 == RECALLS { 1.0 } else { i as f64 * 0.01 };
            (0..RECALLS).map(|i| interpolate(recall(i), &recalls, ys, Some(0.0))).collect()
        };
        Some(Self { precisions: at(&precisions), scores: at(&scores) })
    }

    fn average_precision(&self) -> f64 {
        let above = self.precisions[FIRST..].iter().map(|p| (p - MIN_PRECISION).max(0.0));
        above.sum::<f64>() / (RECALLS - FIRST) as f64 / (1.0 - MIN_PRECISION)
    }
}

/// The scores of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct NuScenesClass {
    /// nuScenes' name of it.
    pub name: &'static str,
    /// How many targets there were.
    pub targets: u64,
    /// Average precision at each of [`THRESHOLDS_M`]; 0 of a class without targets.
    pub ap: [f64; 4],
    /// ATE (m), ASE, AOE (rad), AVE (m/s), AAE at 2 m; 1 where too little was found, NaN where the class has
    /// none.
    pub errors: [f64; 5],
}

/// The scores of all classes.
#[derive(Clone, Debug, PartialEq)]
pub struct NuScenesScores {
    /// Class by class, in the devkit's order.
    pub classes: Vec<NuScenesClass>,
    /// Whether predictions say attributes: without them there is no AAE, and NDS is without it.
    pub has_attributes: bool,
}

impl NuScenesScores {
    /// Mean average precision: of classes without targets, too.
    #[must_use]
    pub fn mean_ap(&self) -> f64 {
        let of_class = |class: &NuScenesClass| class.ap.iter().sum::<f64>() / class.ap.len() as f64;
        self.classes.iter().map(of_class).sum::<f64>() / self.classes.len() as f64
    }

    /// The means over classes of the errors.
    #[must_use]
    pub fn mean_errors(&self) -> [f64; 5] {
        [0, 1, 2, 3, 4].map(|error| mean_of_numbers(self.classes.iter().map(|class| class.errors[error])))
    }

    /// nuScenes' detection score: mAP counts five times, each error once.
    #[must_use]
    pub fn nds(&self) -> f64 {
        let errors = if self.has_attributes { ERRORS.len() } else { AAE };
        let right: f64 = self.mean_errors()[..errors].iter().map(|error| (1.0 - error).max(0.0)).sum();
        (5.0 * self.mean_ap() + right) / (5 + errors) as f64
    }

    /// Its name: NDS without AAE is another number.
    #[must_use]
    pub fn nds_name(&self) -> &'static str {
        if self.has_attributes { "NDS" } else { "NDS without AAE" }
    }
}
