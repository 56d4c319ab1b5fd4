//! Cells that are right and wrong.

use std::cmp::Ordering;

use schema::BevClass;

use crate::mode::Mode;
use crate::protocol::mean_of_numbers;
use crate::ring::Ring;

/// Scores from which on a cell counts as predicted.
pub const MASK_THRESHOLDS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Of [`MASK_THRESHOLDS`], as many does a score pass that is 0.5 or more.
const HALF: u8 = 5;
/// All cells, then the rings.
const LEVELS: usize = 4;
/// What keeps a quotient of nothing from being none.
const EPSILON: f64 = 1e-6;

/// How many of [`MASK_THRESHOLDS`] a score reaches, both as 32-bit floats; none of what is no score (0 to 1).
#[must_use]
pub fn passed(score: f32) -> Option<u8> {
    let reaches = |threshold: &&f64| score >= **threshold as f32;
    (0.0..=1.0).contains(&score).then(|| MASK_THRESHOLDS.iter().filter(reaches).count() as u8)
}

/// Where the cells of predictions lie on those of a store: as many of the store's cells as are `labelled` a
/// side, and of `predicted` a side, each of which covers `times` by `times` of the former; both have the ego
/// in the middle.
#[derive(Clone, Debug)]
pub struct Grid {
    labelled: usize,
    predicted: usize,
    times: usize,
    /// The first row and column of the store's that is covered.
    first: usize,
    /// The ring of each covered cell of the store's, row by row.
    rings: Vec<u8>,
}

/// Predictions whose cells do not lie on those of the store's masks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{predicted} cells of {predicted_m} m a side where the store has {labelled} of {labelled_m} m: {misfit}"
)]
pub struct GridError {
    /// Cells of predictions, a side.
    pub predicted: usize,
    /// Side of such a cell, m.
    pub predicted_m: f64,
    /// Cells of the store's masks, a side.
    pub labelled: usize,
    /// Side of such a cell, m.
    pub labelled_m: f64,
    /// What does not fit.
    pub misfit: Misfit,
}

/// In what the cells of predictions do not fit those of a store.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// Their size is no multiple.
    #[error("a cell must be once, twice, ... as large as the store's")]
    CellSize,
    /// They cover more ground.
    #[error("predictions must not reach farther than the store's masks")]
    Reach,
    /// Their borders lie within the store's cells.
    #[error("with the ego in the middle of both, cells do not lie on cells")]
    Phase,
}

impl Grid {
    /// Lays the grid of predictions upon that of the store.
    ///
    /// # Errors
    /// The cells of one do not lie on those of the other, or those of predictions reach farther.
    pub fn new(
        (labelled, labelled_m): (usize, f64),
        (predicted, predicted_m): (usize, f64),
    ) -> Result<Self, GridError> {
        let fault = |misfit| GridError { predicted, predicted_m, labelled, labelled_m, misfit };
        let times = (predicted_m / labelled_m).round();
        if !(times >= 1.0 && times <= labelled as f64 && (times * labelled_m - predicted_m).abs() < 1e-6) {
            return Err(fault(Misfit::CellSize));
        }
        let times = times as usize;
        let covered = predicted.checked_mul(times).filter(|covered| (1..=labelled).contains(covered));
        let Some(covered) = covered else {
            return Err(fault(Misfit::Reach));
        };
        if !(labelled - covered).is_multiple_of(2) {
            return Err(fault(Misfit::Phase));
        }
        let middle = |cell: usize| (cell as f64 + 0.5 - 0.5 * covered as f64) * labelled_m;
        let ring = |cell: usize| {
            let (x, y) = (middle(cell / covered), middle(cell % covered));
            Ring::of((x * x + y * y).sqrt()) as u8
        };
        let rings = (0..covered * covered).map(ring).collect();
        Ok(Self { labelled, predicted, times, first: (labelled - covered) / 2, rings })
    }

    /// Cells of the store's masks that are covered, a side.
    fn covered(&self) -> usize {
        self.predicted * self.times
    }
}

/// Cells of a class by ring, whether they are labelled, and how many thresholds their scores reach.
type Counts = [[[u64; MASK_THRESHOLDS.len() + 1]; 2]; 3];

/// What was right and wrong, frame by frame.
#[derive(Clone, Debug)]
pub struct MaskTally {
    classes: Vec<BevClass>,
    counts: Vec<Counts>,
    /// Cells that have a label g and a score of 0.5 or more for p, by g, then p.
    confusion: Vec<u64>,
    frames: u64,
}

impl MaskTally {
    /// Of the classes of the channels.
    #[must_use]
    pub fn new(classes: &[BevClass]) -> Self {
        Self {
            classes: classes.to_vec(),
            counts: vec![Counts::default(); classes.len()],
            confusion: vec![0; classes.len() * classes.len()],
            frames: 0,
        }
    }

    /// Adds a frame: labels `[classes, rows, columns]`, not 0 where they are, and how many thresholds the
    /// scores of predictions reach ([`passed`]), likewise. Nothing is added, and `false` said, where one of
    /// them has another number of cells.
    pub fn add(&mut self, grid: &Grid, labels: &[u8], passed: &[u8]) -> bool {
        let classes = self.classes.len();
        if labels.len() != classes * grid.labelled * grid.labelled
            || passed.len() != classes * grid.predicted * grid.predicted
        {
            return false;
        }
        self.frames += 1;
        let covered = grid.covered();
        let (mut labelled, mut predicted) = (vec![0_u32; covered], vec![0_u32; covered]);
        for row in 0..covered {
            labelled.fill(0);
            predicted.fill(0);
            let rings = &grid.rings[row * covered..][..covered];
            for (class, counts) in self.counts.iter_mut().enumerate() {
                let of_class = class * grid.labelled * grid.labelled;
                let labels = &labels[of_class + (grid.first + row) * grid.labelled + grid.first..][..covered];
                let of_class = class * grid.predicted * grid.predicted;
                let passed = &passed[of_class + row / grid.times * grid.predicted..][..grid.predicted];
                let mut put = |column: usize, passed: u8| {
                    let is_labelled = labels[column] != 0;
                    let bin = usize::from(passed).min(MASK_THRESHOLDS.len());
                    counts[usize::from(rings[column])][usize::from(is_labelled)][bin] += 1;
                    labelled[column] |= u32::from(is_labelled) << class;
                    predicted[column] |= u32::from(passed >= HALF) << class;
                };
                if grid.times == 1 {
                    (0..covered).for_each(|column| put(column, passed[column]));
                } else {
                    (0..covered).for_each(|column| put(column, passed[column / grid.times]));
                }
            }
            for (&labelled, &predicted) in labelled.iter().zip(&predicted) {
                for g in bits(labelled) {
                    bits(predicted).for_each(|p| self.confusion[g * classes + p] += 1);
                }
            }
        }
        true
    }

    /// Adds what another of the same classes has.
    pub fn append(&mut self, other: &Self) {
        self.frames += other.frames;
        for (sum, part) in self.confusion.iter_mut().zip(&other.confusion) {
            *sum += part;
        }
        let mine = self.counts.iter_mut().flatten().flatten().flatten();
        for (sum, part) in mine.zip(other.counts.iter().flatten().flatten().flatten()) {
            *sum += part;
        }
    }

    /// The scores of all frames.
    #[must_use]
    pub fn scores(&self) -> MaskScores {
        let of_class = |(class, counts): (&BevClass, &Counts)| {
            let rings = |level: usize| match level {
                0 => &counts[..],
                ring => &counts[ring - 1..ring],
            };
            let levels = [0, 1, 2, 3].map(|level| iou(rings(level)));
            MaskClass { name: class.name(), cells: levels.map(|l| l.0), iou: levels.map(|l| l.1) }
        };
        let classes: Vec<MaskClass> = self.classes.iter().zip(&self.counts).map(of_class).collect();
        let confusion = self.confusion.chunks(classes.len().max(1)).map(<[u64]>::to_vec).collect();
        MaskScores { classes, confusion, frames: self.frames }
    }
}

/// Numbers of the bits that are set.
fn bits(mut of: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = (of != 0).then(|| of.trailing_zeros() as usize);
        of &= of.wrapping_sub(1);
        lowest
    })
}

/// Labelled cells of some rings, and the IoU at each threshold.
fn iou(rings: &[[[u64; MASK_THRESHOLDS.len() + 1]; 2]]) -> (u64, [f64; MASK_THRESHOLDS.len()]) {
    let from = |label: usize, threshold: usize| -> u64 {
        rings.iter().flat_map(|ring| &ring[label][threshold..]).sum()
    };
    let labelled = from(1, 0);
    let mut all = [0.0; MASK_THRESHOLDS.len()];
    for (i, iou) in all.iter_mut().enumerate() {
        let (right, wrong) = (from(1, i + 1), from(0, i + 1));
        // Labelled cells are right or missed.
        *iou = right as f64 / ((wrong + labelled) as f64 + EPSILON);
    }
    (labelled, all)
}

/// The scores of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskClass {
    /// Its name.
    pub name: &'static str,
    /// Labelled cells: all, and those of each ring.
    pub cells: [u64; LEVELS],
    /// IoU at each of [`MASK_THRESHOLDS`], likewise; 0 of a class without labels.
    pub iou: [[f64; MASK_THRESHOLDS.len()]; LEVELS],
}

impl MaskClass {
    /// The largest IoU of all cells, and the threshold at which it is, the first of several.
    #[must_use]
    pub fn best(&self) -> (f64, f64) {
        let all = self.iou[0].into_iter().zip(MASK_THRESHOLDS).rev();
        all.max_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal)).unwrap_or_default()
    }
}

/// The scores of the masks of one mode.
#[derive(Clone, Debug)]
pub struct MaskMode {
    /// With whom the model worked together.
    pub mode: Mode,
    /// Its scores.
    pub scores: MaskScores,
}

/// The scores of all classes.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskScores {
    /// Class by class, in the order of the channels.
    pub classes: Vec<MaskClass>,
    /// Cells that have a label g and a score of 0.5 or more for p, by g, then p.
    pub confusion: Vec<Vec<u64>>,
    /// How many frames of egos they are.
    pub frames: u64,
}

impl MaskScores {
    /// Mean IoU over all classes, those without labels too, of all cells and of each ring.
    #[must_use]
    pub fn mean_iou(&self) -> [[f64; MASK_THRESHOLDS.len()]; LEVELS] {
        let mut means = [[0.0; MASK_THRESHOLDS.len()]; LEVELS];
        for (level, means) in means.iter_mut().enumerate() {
            for (threshold, mean) in means.iter_mut().enumerate() {
                *mean = mean_of_numbers(self.classes.iter().map(|class| class.iou[level][threshold]));
            }
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_reach_thresholds() {
        assert_eq!([0.0, 0.09, 0.1, 0.5, 0.899, 0.9, 1.0].map(passed), [0, 0, 1, 5, 8, 9, 9].map(Some));
        assert_eq!([-0.1, 1.1, f32::NAN].map(passed), [None; 3]);
    }

    #[test]
    fn grids_lie_on_each_other_or_are_refused() {
        assert_eq!(Grid::new((400, 0.4), (400, 0.4)).expect("is the same").first, 0);
        assert_eq!(Grid::new((400, 0.4), (200, 0.4)).expect("is a crop").first, 100);
        let coarse = Grid::new((400, 0.4), (100, 0.8)).expect("is coarser");
        assert_eq!((coarse.times, coarse.first, coarse.covered()), (2, 100, 200));
        let misfit = |cells, cell_m| Grid::new((400, 0.4), (cells, cell_m)).expect_err("does not fit").misfit;
        assert_eq!(misfit(401, 0.4), Misfit::Reach);
        assert_eq!(misfit(201, 0.8), Misfit::Reach);
        assert_eq!(misfit(0, 0.4), Misfit::Reach);
        assert_eq!(misfit(199, 0.4), Misfit::Phase);
        for cell_m in [0.5, 0.2, 0.0, -0.4, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(misfit(100, cell_m), Misfit::CellSize, "{cell_m}");
        }
    }

    #[test]
    fn areas_of_rings_are_those_of_circles() {
        let grid = Grid::new((400, 0.4), (400, 0.4)).expect("is the same");
        let area_m2 = |ring: u8| grid.rings.iter().filter(|r| **r == ring).count() as f64 * 0.16;
        let circle = |radius_m: f64| std::f64::consts::PI * radius_m * radius_m;
        assert!((area_m2(0) / circle(20.0) - 1.0).abs() < 1e-3);
        assert!((area_m2(1) / (circle(40.0) - circle(20.0)) - 1.0).abs() < 1e-3);
    }
}
