//! What pages show of SimBEV2X's metrics: curves, what was found at which distance, and the frames with the
//! most errors.

use std::cmp::Reverse;

use schema::DetectionClass;

use crate::boxes::SampleId;
use crate::level::Level;
use crate::matching::by_score;
use crate::simbev2x::{ClassTally, Hit, SimBev2xTally};

/// The one of [`THRESHOLDS_M`] at which it is told what was found: 2 m.
const FOUND_AT: usize = 2;
/// Curves have a point for each so small a part of recall.
const STEPS: f64 = 100.0;

/// What was found, missed, and wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Targets that were found.
    pub found: u64,
    /// Targets that were not.
    pub missed: u64,
    /// Predictions that found none.
    pub wrong: u64,
}

/// What pages show of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassDetails {
    /// Its name.
    pub name: &'static str,
    /// Recall and precision at each of [`crate::THRESHOLDS_M`], from the surest prediction on, at most some
    /// hundred points; empty where nothing was found.
    pub curves: [Vec<[f64; 2]>; 4],
    /// The score from which on predictions count in what follows: that with the best F1 at 2 m; none where
    /// nothing was found.
    pub score: Option<f64>,
    /// What was found up to 2 m, by [`crate::Ring`].
    pub rings: [Found; 3],
}

/// What pages show of all classes.
#[derive(Clone, Debug, PartialEq)]
pub struct Details {
    /// Class by class, in canonical order.
    pub classes: Vec<ClassDetails>,
    /// The frames with most that is missed or wrong, the worst first.
    pub worst: Vec<(SampleId, Found)>,
}

impl SimBev2xTally<4> {
    /// What pages show, with so many of the worst frames.
    #[must_use]
    pub fn details(&self, frames: usize) -> Details {
        let classes: Vec<ClassDetails> = self
            .classes
            .iter()
            .zip(DetectionClass::ALL)
            .map(|(tally, class)| of_class(tally, class.name()))
            .collect();
        let mut worst: Vec<(SampleId, Found)> = Vec::with_capacity(self.marks.len());
        for (i, mark) in self.marks.iter().enumerate() {
            let mut sum = Found::default();
            for (k, (tally, class)) in self.classes.iter().zip(&classes).enumerate() {
                let next = self.marks.get(i + 1).map(|next| next.classes[k]);
                let [hits, targets] = mark.classes[k];
                let [hits_end, targets_end] =
                    next.unwrap_or([tally.hits.len() as u64, tally.targets[Level::All as usize]]);
                let found = of_hits(&tally.hits[hits as usize..hits_end as usize], class.score, Level::All);
                sum.found += found.found;
                sum.wrong += found.wrong;
                sum.missed += targets_end - targets - found.found;
            }
            worst.push((mark.sample, sum));
        }
        // Of equally bad ones the earlier first.
        worst.sort_by_key(|(_, found)| Reverse(found.missed + found.wrong));
        worst.truncate(frames);
        worst.retain(|(_, found)| found.missed + found.wrong > 0);
        Details { classes, worst }
    }
}

/// What predictions from a score on have found.
fn of_hits(hits: &[Hit<4>], score: Option<f64>, level: Level) -> Found {
    let mut sum = Found::default();
    let Some(score) = score else { return sum };
    for is_right in
        hits.iter().filter(|hit| hit.score >= score).filter_map(|hit| hit.counts[FOUND_AT].at(level))
    {
        *(if is_right { &mut sum.found } else { &mut sum.wrong }) += 1;
    }
    sum
}

fn of_class(tally: &ClassTally<4>, name: &'static str) -> ClassDetails {
    let mut surest = tally.hits.clone();
    // Stable: of equal scores the earlier is the surer.
    surest.sort_by(|a, b| by_score(a.score, b.score));
    let targets = tally.targets[Level::All as usize];
    let curves = [0, 1, 2, 3].map(|at| curve(&surest, at, targets));
    let score = best_score(&surest, targets);
    let rings = [Level::Near, Level::Middle, Level::Far].map(|level| {
        let found = of_hits(&surest, score, level);
        Found { missed: tally.targets[level as usize] - found.found, ..found }
    });
    ClassDetails { name, curves, score, rings }
}

fn curve(surest: &[Hit<4>], threshold: usize, targets: u64) -> Vec<[f64; 2]> {
    let (mut right, mut points, mut step) = (0_u64, Vec::new(), -1.0);
    let mut last = None;
    for (i, hit) in surest.iter().enumerate() {
        right += u64::from(hit.counts[threshold].at(Level::All) == Some(true));
        let point = [right as f64 / targets.max(1) as f64, right as f64 / (i + 1) as f64];
        last = Some(point);
        if (point[0] * STEPS).floor() > step {
            step = (point[0] * STEPS).floor();
            points.push(point);
        }
    }
    if right == 0 {
        return Vec::new();
    }
    // Where the least sure one leads.
    points.extend(last.filter(|last| points.last() != Some(last)));
    points
}

/// The score from which on the harmonic mean of precision and recall is best, the highest of several.
fn best_score(surest: &[Hit<4>], targets: u64) -> Option<f64> {
    let (mut right, mut best) = (0_u64, (0.0, None));
    for (i, hit) in surest.iter().enumerate() {
        right += u64::from(hit.counts[FOUND_AT].at(Level::All) == Some(true));
        // Those of one score count together.
        let is_last = surest.get(i + 1).is_none_or(|next| next.score < hit.score);
        let f1 = 2.0 * right as f64 / ((i + 1) as f64 + targets as f64);
        if is_last && f1 > best.0 {
            best = (f1, Some(hit.score));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use schema::{AgentId, Difficulty};

    use super::*;
    use crate::boxes::{Prediction, Sighting, Solid, Target};

    fn solid(x: f64) -> Solid {
        Solid { center_m: [x, 0.0, 0.0], size_m: [4.0, 2.0, 1.5], ..Solid::default() }
    }

    fn target(x: f64) -> Target {
        let (difficulty, sighting) = (Difficulty::Easy, Sighting::Ego);
        Target { class: 2, solid: solid(x), distance_m: x, difficulty, sighting, attribute: None }
    }

    fn prediction(x: f64, score: f64) -> Prediction {
        Prediction { class: 2, score, solid: solid(x), distance_m: x, attribute: None }
    }

    fn sample(frame: u32) -> SampleId {
        SampleId { scene: 3, frame, ego: AgentId::vehicle(0) }
    }

    #[test]
    fn what_is_missed_and_wrong_is_told_by_ring_and_frame() {
        // Two frames in one tally, a third in one that is put behind it.
        let (mut tally, mut later) = (SimBev2xTally::<4>::default(), SimBev2xTally::<4>::default());
        tally.begin(sample(0));
        tally.add(&[target(10.0), target(30.0)], &[prediction(10.0, 0.9), prediction(30.1, 0.8)]);
        tally.begin(sample(1));
        tally.add(
            &[target(15.0), target(50.0)],
            &[prediction(15.0, 0.7), prediction(35.0, 0.75), prediction(5.0, 0.1)],
        );
        later.begin(sample(2));
        later.add(&[target(60.0)], &[prediction(60.0, 0.72), prediction(90.0, 0.1)]);
        tally.append(later);
        let details = tally.details(10);
        let class = &details.classes[2];
        // Of five targets four are found by five predictions from 0.7 on: F1 is 0.8.
        assert_eq!(class.score, Some(0.7));
        let found = |found, missed, wrong| Found { found, missed, wrong };
        assert_eq!(class.rings, [found(2, 0, 0), found(1, 0, 1), found(1, 1, 0)]);
        assert_eq!(details.worst, [(sample(1), found(1, 1, 1))]);
        assert_eq!(tally.details(0).worst, []);
        let curve = &class.curves[2];
        assert_eq!((curve[0], curve[1]), ([0.2, 1.0], [0.4, 1.0]));
        assert_eq!(curve.last(), Some(&[0.8, 4.0 / 7.0]));
        assert!(details.classes[1].curves.iter().all(Vec::is_empty) && details.classes[1].score.is_none());
    }
}
