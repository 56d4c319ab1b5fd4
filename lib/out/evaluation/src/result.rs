//! What came of an evaluation.

use std::collections::BTreeMap;

use crate::EvaluationError;
use crate::measures::Measure;
use crate::resample::{Spread, spreads};
use crate::tally::{Counts, ModeScores};

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

/// What is told besides the numbers of all scenes together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Breakdown {
    /// How often as many scenes as there are are drawn to say how sure scores are; 0: never.
    pub bootstrap_rounds: u32,
    /// Whether scores are given by map, too.
    pub by_map: bool,
}

impl Breakdown {
    /// Whether it asks for what each scene gave.
    pub(crate) fn needs_scenes(&self) -> bool {
        self.bootstrap_rounds > 0 || self.by_map
    }

    /// The rows of all scenes, whose numbers are `whole`, and of each map; `of_scenes` has the map and the
    /// part of each scene, and `measures` the numbers of some parts.
    ///
    /// # Errors
    /// Scenes are to be drawn and there is but one.
    pub(crate) fn rows<P: Sync>(
        &self,
        whole: Vec<Measure>,
        of_scenes: &[(String, P)],
        measures: impl Fn(&[&P]) -> Vec<Measure> + Sync,
    ) -> Result<Vec<ResultRow>, EvaluationError> {
        if self.bootstrap_rounds > 0 && of_scenes.len() < 2 {
            return Err(EvaluationError::Refused(
                "--bootstrap draws scenes, and there is but one that is evaluated".into(),
            ));
        }
        let all: Vec<&P> = of_scenes.iter().map(|(_, part)| part).collect();
        let mut rows = self.rows_of(None, whole, &all, &measures);
        let mut by_map: BTreeMap<&str, Vec<&P>> = BTreeMap::new();
        for (map, part) in of_scenes.iter().filter(|_| self.by_map) {
            by_map.entry(map).or_default().push(part);
        }
        for (map, parts) in by_map {
            rows.extend(self.rows_of(Some(map), measures(&parts), &parts, &measures));
        }
        Ok(rows)
    }

    /// Rows of some values, with their spread over the scenes of `parts` where there are at least two.
    fn rows_of<P: Sync>(
        &self,
        map: Option<&str>,
        values: Vec<Measure>,
        parts: &[&P],
        measures: &(impl Fn(&[&P]) -> Vec<Measure> + Sync),
    ) -> Vec<ResultRow> {
        let mut spread = Vec::new();
        if self.bootstrap_rounds > 0 && parts.len() > 1 {
            spread = spreads(parts, &values, self.bootstrap_rounds, measures);
        }
        let row =
            |(i, measure)| ResultRow { map: map.map(str::to_owned), measure, spread: spread.get(i).copied() };
        values.into_iter().enumerate().map(row).collect()
    }
}
