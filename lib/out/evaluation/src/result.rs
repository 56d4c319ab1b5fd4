//! What came of an evaluation.

use std::collections::BTreeMap;

use crate::measures::{Measure, of_modes};
use crate::mode::Mode;
use crate::resample::{Spread, spreads};
use crate::tally::{Counts, ModeScores, Part, Wanted};

/// What came of it.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Scores by mode.
    pub modes: Vec<ModeScores>,
    /// What was looked at and what not.
    pub counts: Counts,
    /// All numbers: those of all scenes, then those of each map if they were asked for.
    pub rows: Vec<ResultRow>,
}

/// A number of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultRow {
    /// The map whose scenes it is of; none: all scenes.
    pub map: Option<String>,
    /// The number.
    pub measure: Measure,
    /// How sure it is, if that was asked for.
    pub spread: Option<Spread>,
}

impl Evaluation {
    pub(crate) fn new(
        modes: Vec<Mode>,
        whole: &Part,
        of_scenes: Vec<(String, Part)>,
        bootstrap_rounds: u32,
        by_map: bool,
        wanted: Wanted,
    ) -> Self {
        let scores = whole.scores(&modes, &wanted);
        let numbers_alone = Wanted { worst_frames: None, ..wanted };
        let measures = |some: &[&Part]| {
            of_modes(&Part::of_all(modes.len(), some.iter().copied()).scores(&modes, &numbers_alone))
        };
        let mut by_name: BTreeMap<String, Vec<Part>> = BTreeMap::new();
        let mut parts = Vec::with_capacity(of_scenes.len());
        for (map, part) in of_scenes {
            if by_map {
                by_name.entry(map).or_default().push(part.clone());
            }
            parts.push(part);
        }
        let mut rows = rows_of(None, of_modes(&scores), &parts, bootstrap_rounds, measures);
        for (map, parts) in by_name {
            let values = measures(&parts.iter().collect::<Vec<_>>());
            rows.extend(rows_of(Some(map), values, &parts, bootstrap_rounds, measures));
        }
        Self { modes: scores, counts: whole.counts, rows }
    }
}

/// Rows of some measures, with their spread over the scenes of `parts` where there are at least two.
pub(crate) fn rows_of<P: Sync>(
    map: Option<String>,
    values: Vec<Measure>,
    parts: &[P],
    rounds: u32,
    measures: impl Fn(&[&P]) -> Vec<Measure> + Sync,
) -> Vec<ResultRow> {
    let mut spread = Vec::new();
    if rounds > 0 && parts.len() > 1 {
        spread = spreads(parts, rounds, measures);
    }
    let row = |(i, measure)| ResultRow { map: map.clone(), measure, spread: spread.get(i).copied() };
    values.into_iter().enumerate().map(row).collect()
}
