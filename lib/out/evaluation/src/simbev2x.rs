//! SimBEV2X's detection metrics: mAP by difficulty, four errors, SDS; and mAP by distance and by which
//! agents saw the target. Targets are found by the distance of centres (four thresholds) or by the overlap
//! of volumes (nine): the number of thresholds tells which.

use rayon::prelude::*;
use schema::DetectionClass;

use crate::boxes::{Prediction, SampleId, Target};
use crate::level::{Counts, LEVELS, Level};
use crate::matching::{Distances, by_score};
use crate::overlap::volume_iou;
use crate::protocol::{THRESHOLDS_M, THRESHOLDS_VOLUME_IOU, mean_of_numbers};

/// Names of the errors.
pub(crate) const ERRORS: [&str; 4] = ["ATE", "AOE", "ASE", "AVE"];
/// What falls below this precision is left out of a curve.
const MIN_PRECISION: f64 = 0.1;

/// Of how many predictions of a class a sample keeps the surest.
fn cap(class: usize) -> usize {
    use DetectionClass::{Car, Pedestrian, TrafficCone, TrafficLight, TrafficSign};
    match DetectionClass::ALL[class] {
        Car | Pedestrian => 100,
        TrafficSign => 60,
        TrafficLight | TrafficCone => 40,
        _ => 20,
    }
}

/// The predictions of a class in a sample that count: the surest first, of equal scores the earlier first,
/// and no more than the class's cap.
pub(crate) fn surest(class: usize, predictions: &[Prediction]) -> Vec<&Prediction> {
    let mut own: Vec<&Prediction> = predictions.iter().filter(|p| p.class == class).collect();
    own.sort_by(|a, b| by_score(a.score, b.score));
    own.truncate(cap(class));
    own
}

/// A prediction with what it found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit<const N: usize> {
    pub(crate) score: f64,
    /// By threshold.
    pub(crate) counts: [Counts; N],
}

#[derive(Clone, Debug)]
pub(crate) struct ClassTally<const N: usize> {
    /// By level.
    pub(crate) targets: [u64; LEVELS],
    pub(crate) hits: Vec<Hit<N>>,
    /// By threshold: pairs, and sums of their errors.
    pairs: [u64; N],
    errors: [[f64; 4]; N],
}

impl<const N: usize> Default for ClassTally<N> {
    fn default() -> Self {
        Self { targets: [0; LEVELS], hits: Vec::new(), pairs: [0; N], errors: [[0.0; 4]; N] }
    }
}

/// What was found and what not, sample by sample.
#[derive(Clone, Debug)]
pub struct SimBev2xTally<const N: usize = 4> {
    pub(crate) classes: Vec<ClassTally<N>>,
    /// Where samples begin, as far as that was said.
    pub(crate) marks: Vec<Mark>,
}

/// Where a sample begins.
#[derive(Clone, Debug)]
pub(crate) struct Mark {
    pub(crate) sample: SampleId,
    /// How many predictions and targets of each class stand before it.
    pub(crate) classes: [[u64; 2]; DetectionClass::ALL.len()],
}

impl<const N: usize> Default for SimBev2xTally<N> {
    fn default() -> Self {
        Self { classes: vec![ClassTally::default(); DetectionClass::ALL.len()], marks: Vec::new() }
    }
}

/// How predictions find targets.
pub(crate) struct Finding<const N: usize> {
    /// What is the less the nearer they are.
    away: fn(&Prediction, &Target) -> f64,
    /// As much as it may be, edges included.
    up_to: [f64; N],
}

impl<const N: usize> Finding<N> {
    /// Which target each of the surest predictions finds, by threshold: in their order they choose the
    /// nearest that is free, and find it up to the threshold.
    pub(crate) fn assigned(&self, surest: &[&Prediction], targets: &[&Target]) -> [Vec<Option<usize>>; N] {
        let distances = Distances::new(surest, targets, |p, t| (self.away)(p, t));
        self.up_to.map(|up_to| distances.assign(surest.len(), |away| away <= up_to))
    }
}

/// By the distance of centres in space.
pub(crate) const BY_DISTANCE: Finding<4> =
    Finding { away: |p, t| t.solid.distance_m(&p.solid), up_to: THRESHOLDS_M };

impl SimBev2xTally<4> {
    /// Adds a sample's targets and predictions, whose classes are numbers of [`DetectionClass::ALL`], found
    /// by the distance of their middles. Of equal scores the earlier counts as the surer, within a sample
    /// and among samples. Velocities that are not known count as none.
    pub fn add(&mut self, targets: &[Target], predictions: &[Prediction]) {
        self.add_by(targets, predictions, &BY_DISTANCE);
    }
}

impl SimBev2xTally<9> {
    /// Adds a sample's targets and predictions likewise, found by the overlap of their volumes: the surest
    /// first, each takes the free target that it overlaps most.
    pub fn add_by_overlap(&mut self, targets: &[Target], predictions: &[Prediction]) {
        let away = |p: &Prediction, t: &Target| -volume_iou(&p.solid, &t.solid);
        self.add_by(targets, predictions, &Finding { away, up_to: THRESHOLDS_VOLUME_IOU.map(|iou| -iou) });
    }
}

impl<const N: usize> SimBev2xTally<N> {
    /// Says which sample is added next.
    pub fn begin(&mut self, sample: SampleId) {
        self.marks.push(Mark { sample, classes: self.counts() });
    }

    /// How many predictions and targets of each class there are.
    fn counts(&self) -> [[u64; 2]; DetectionClass::ALL.len()] {
        let mut counts = [[0; 2]; DetectionClass::ALL.len()];
        for (count, tally) in counts.iter_mut().zip(&self.classes) {
            *count = [tally.hits.len() as u64, tally.targets[Level::All as usize]];
        }
        counts
    }

    /// Adds a sample's targets and predictions, whose classes are numbers of [`DetectionClass::ALL`]. Of
    /// equal scores the earlier counts as the surer, within a sample and among samples. Velocities that are
    /// not known count as none.
    fn add_by(&mut self, targets: &[Target], predictions: &[Prediction], finding: &Finding<N>) {
        for (class, tally) in self.classes.iter_mut().enumerate() {
            let targets: Vec<&Target> = targets.iter().filter(|t| t.class == class).collect();
            tally.add(&targets, &surest(class, predictions), finding);
        }
    }

    /// Adds what another has of later samples.
    pub fn append(&mut self, later: Self) {
        let before = self.counts();
        self.marks.extend(later.marks.into_iter().map(|mut mark| {
            for (own, before) in mark.classes.iter_mut().zip(before) {
                *own = [own[0] + before[0], own[1] + before[1]];
            }
            mark
        }));
        for (class, later) in self.classes.iter_mut().zip(later.classes) {
            class.hits.extend(later.hits);
            for (sum, part) in class.targets.iter_mut().zip(later.targets) {
                *sum += part;
            }
            for i in 0..N {
                class.pairs[i] += later.pairs[i];
                for (sum, part) in class.errors[i].iter_mut().zip(later.errors[i]) {
                    *sum += part;
                }
            }
        }
    }

    /// The scores of all samples.
    #[must_use]
    pub fn scores(&self) -> SimBev2xScores<N> {
        let classes = self.classes.par_iter().enumerate();
        SimBev2xScores {
            classes: classes.map(|(i, tally)| tally.scores(DetectionClass::ALL[i].name())).collect(),
        }
    }
}

impl<const N: usize> ClassTally<N> {
    fn add(&mut self, targets: &[&Target], surest: &[&Prediction], finding: &Finding<N>) {
        for target in targets {
            Level::of(target).for_each(|level| self.targets[level as usize] += 1);
        }
        let first = self.hits.len();
        self.hits.extend(surest.iter().map(|p| Hit { score: p.score, counts: [Counts::wrong(p); N] }));
        for (at, found) in finding.assigned(surest, targets).into_iter().enumerate() {
            for (position, target) in found.into_iter().enumerate() {
                let Some(target) = target.map(|target| targets[target]) else { continue };
                self.hits[first + position].counts[at] = Counts::right(target);
                self.pairs[at] += 1;
                for (sum, error) in self.errors[at].iter_mut().zip(errors(target, surest[position])) {
                    *sum += error;
                }
            }
        }
    }

    fn scores(&self, name: &'static str) -> SimBev2xClass<N> {
        let mut order: Vec<u32> = (0..self.hits.len() as u32).collect();
        let hit = |i: u32| self.hits[i as usize];
        order.par_sort_unstable_by(|a, b| by_score(hit(*a).score, hit(*b).score).then(a.cmp(b)));
        let surest: Vec<Hit<N>> = order.into_iter().map(hit).collect();
        let ap = std::array::from_fn(|at| {
            Level::ALL.map(|level| {
                let counts = surest.iter().filter_map(|hit| hit.counts[at].at(level));
                average_precision(counts, self.targets[level as usize])
            })
        });
        let mean = |at: usize, error: usize| match self.pairs[at] {
            0 => f64::NAN,
            pairs => self.errors[at][error] / pairs as f64,
        };
        let errors = std::array::from_fn(|at| [0, 1, 2, 3].map(|error| mean(at, error)));
        SimBev2xClass { name, targets: self.targets, ap, errors }
    }
}

/// The errors of a pair, in the order of [`ERRORS`].
fn errors(target: &Target, prediction: &Prediction) -> [f64; 4] {
    let truth = target.solid.at_rest_where_unknown();
    let guess = prediction.solid.at_rest_where_unknown();
    [
        truth.distance_m(&guess),
        truth.yaw_error_rad(&guess, std::f64::consts::TAU),
        truth.scale_error(&guess),
        truth.velocity_error_mps(&guess),
    ]
}

/// The area below precision over recall, from (0, 1) on and without points of low precision; NaN without
/// targets. A prediction that found a target of another level is neither right nor wrong, and not counted.
fn average_precision(is_right: impl Iterator<Item = bool>, targets: u64) -> f64 {
    if targets == 0 {
        return f64::NAN;
    }
    let (mut right, mut wrong) = (0_u64, 0_u64);
    let (mut recall, mut precision, mut area) = (0.0, 1.0, 0.0);
    for is_right in is_right {
        *(if is_right { &mut right } else { &mut wrong }) += 1_u64;
        let point = if right == 0 { 0.0 } else { right as f64 / (right + wrong) as f64 };
        if point >= MIN_PRECISION {
            let next = right as f64 / targets as f64;
            area += (next - recall) * (point + precision) / 2.0;
            (recall, precision) = (next, point);
        }
    }
    area.clamp(0.0, 1.0)
}

/// The scores of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct SimBev2xClass<const N: usize = 4> {
    /// Its name.
    pub name: &'static str,
    /// How many targets there were at each of [`Level::ALL`].
    pub targets: [u64; LEVELS],
    /// Average precision at each threshold ([`THRESHOLDS_M`], or [`THRESHOLDS_VOLUME_IOU`]), for the targets
    /// of each level; NaN where there are none.
    pub ap: [[f64; LEVELS]; N],
    /// ATE (m), AOE (rad), ASE, AVE (m/s) at each threshold; NaN where nothing was found.
    pub errors: [[f64; 4]; N],
}

/// The first threshold that means are taken over: of overlaps 0.3, of distances the first.
const fn first_of_means<const N: usize>() -> usize {
    if N == THRESHOLDS_VOLUME_IOU.len() { 2 } else { 0 }
}

impl<const N: usize> SimBev2xClass<N> {
    /// Mean average precision of the targets of a level; NaN where there are none.
    #[must_use]
    pub fn mean_ap(&self, level: Level) -> f64 {
        mean_of_numbers(self.ap[first_of_means::<N>()..].iter().map(|ap| ap[level as usize]))
    }

    /// The means of the errors; NaN where nothing was found.
    #[must_use]
    pub fn mean_errors(&self) -> [f64; 4] {
        [0, 1, 2, 3]
            .map(|error| mean_of_numbers(self.errors[first_of_means::<N>()..].iter().map(|e| e[error])))
    }
}

/// The scores of all classes.
#[derive(Clone, Debug, PartialEq)]
pub struct SimBev2xScores<const N: usize = 4> {
    /// Class by class, in canonical order.
    pub classes: Vec<SimBev2xClass<N>>,
}

impl<const N: usize> SimBev2xScores<N> {
    /// Mean average precision of the targets of each level, over classes that have some; NaN where none has.
    #[must_use]
    pub fn mean_ap(&self) -> [f64; LEVELS] {
        Level::ALL.map(|level| {
            let of_class = |class: &SimBev2xClass<N>| {
                class.ap[first_of_means::<N>()..].iter().map(|ap| ap[level as usize]).collect::<Vec<_>>()
            };
            mean_of_numbers(self.classes.iter().flat_map(of_class))
        })
    }

    /// The means of the errors over classes and thresholds; NaN where nothing was found.
    #[must_use]
    pub fn mean_errors(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|error| {
            let of_class = |class: &SimBev2xClass<N>| {
                class.errors[first_of_means::<N>()..].iter().map(|e| e[error]).collect::<Vec<_>>()
            };
            mean_of_numbers(self.classes.iter().flat_map(of_class))
        })
    }

    /// SimBEV2X's detection score; NaN without targets. An error of nothing found counts as a whole one.
    #[must_use]
    pub fn sds(&self) -> f64 {
        // The greater of 0 and NaN is 0.
        let right: f64 = self.mean_errors().iter().map(|error| (1.0 - error).max(0.0)).sum();
        (4.0 * self.mean_ap()[0] + right) / 8.0
    }
}
