//! OPV2V's average precision: vehicles seen from above, found by overlap.

use rayon::prelude::*;
use schema::DetectionClass;

use crate::boxes::{Prediction, Target};
use crate::matching::{Distances, by_score};
use crate::overlap::bev_iou;

/// Overlaps over union from which on a prediction finds a target.
pub const THRESHOLDS_IOU: [f64; 3] = [0.3, 0.5, 0.7];
/// The one class of all targets and predictions.
pub(crate) const CLASS: &str = "vehicle";

/// Whether objects of a class are vehicles to OPV2V: cars, trucks (vans among them) and buses, as its export
/// has them.
pub(crate) fn is_opv2v_vehicle(class: DetectionClass) -> bool {
    matches!(class, DetectionClass::Car | DetectionClass::Truck | DetectionClass::Bus)
}

/// A prediction, and a bit for each threshold at which it found a target.
#[derive(Clone, Copy, Debug)]
struct Hit {
    score: f64,
    found: u8,
}

/// What was found and what not, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Opv2vTally {
    targets: u64,
    /// Those of a sample with the surest first.
    hits: Vec<Hit>,
}

impl Opv2vTally {
    /// Adds a sample's targets and predictions, all of which are vehicles whatever their classes say. Of
    /// equal scores the earlier counts as the surer. The surest first, each takes the free target that it
    /// overlaps most.
    pub fn add(&mut self, targets: &[Target], predictions: &[Prediction]) {
        self.targets += targets.len() as u64;
        let mut surest: Vec<&Prediction> = predictions.iter().collect();
        surest.sort_by(|a, b| by_score(a.score, b.score));
        // The more they overlap, the nearer they are.
        let apart = Distances::new(&surest, targets, |p, t| -bev_iou(&p.solid, &t.solid));
        let first = self.hits.len();
        self.hits.extend(surest.iter().map(|p| Hit { score: p.score, found: 0 }));
        for (bit, threshold) in THRESHOLDS_IOU.into_iter().enumerate() {
            let found = apart.assign(surest.len(), |away| -away >= threshold);
            for (hit, found) in self.hits[first..].iter_mut().zip(found) {
                hit.found |= u8::from(found.is_some()) << bit;
            }
        }
    }

    /// Adds what another has of later samples.
    pub fn append(&mut self, later: Self) {
        self.targets += later.targets;
        self.hits.extend(later.hits);
    }

    /// The scores of all samples.
    #[must_use]
    pub fn scores(&self) -> Opv2vScores {
        let mut order: Vec<u32> = (0..self.hits.len() as u32).collect();
        let hit = |i: u32| self.hits[i as usize];
        order.par_sort_unstable_by(|a, b| by_score(hit(*a).score, hit(*b).score).then(a.cmp(b)));
        let bits = [0, 1, 2];
        let ap = |found: &dyn Fn(usize) -> u8| {
            bits.map(|bit| {
                let is_right = (0..self.hits.len()).map(|i| found(i) >> bit & 1 == 1);
                average_precision(is_right, self.targets)
            })
        };
        Opv2vScores {
            targets: self.targets,
            sorted: ap(&|i| hit(order[i]).found),
            by_frame: ap(&|i| self.hits[i].found),
        }
    }
}

/// The area below the upper envelope of precision over recall (VOC 2010); NaN without targets.
fn average_precision(is_right: impl Iterator<Item = bool>, targets: u64) -> f64 {
    if targets == 0 {
        return f64::NAN;
    }
    // Precision where recall rises, which is by one target each time.
    let (mut right, mut precisions) = (0_u64, Vec::new());
    for (i, is_right) in is_right.enumerate() {
        if is_right {
            right += 1;
            precisions.push(right as f64 / (i + 1) as f64);
        }
    }
    let mut envelope = 0.0_f64;
    let area = precisions.iter().rev().map(|precision| {
        envelope = envelope.max(*precision);
        envelope
    });
    area.fold(0.0, |sum, precision| sum + precision) / targets as f64
}

/// Average precision at each of [`THRESHOLDS_IOU`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opv2vScores {
    /// How many targets there were.
    pub targets: u64,
    /// With the predictions of all frames in the order of their scores (`global_sort_detections`); NaN
    /// without targets.
    pub sorted: [f64; 3],
    /// With those of a frame after those of the frame before, as OPV2V's numbers are; likewise.
    pub by_frame: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_those_below_the_envelope() {
        let ap = |rights: &[u8], targets| average_precision(rights.iter().map(|r| *r == 1), targets);
        assert_eq!(ap(&[1, 1], 2), 1.0);
        // Precisions 1, 2/3, 3/4: the second is lifted.
        assert!((ap(&[1, 0, 1, 1], 4) - (1.0 + 0.75 + 0.75) / 4.0).abs() < 1e-12);
        assert_eq!((ap(&[0, 0], 3), ap(&[], 3)), (0.0, 0.0));
        assert!(ap(&[], 3).is_sign_positive(), "an empty sum is -0");
        assert!(ap(&[0], 0).is_nan());
    }
}
