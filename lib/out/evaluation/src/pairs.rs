//! Which prediction found which box, for who draws both: by SimBEV2X's rule, which the metrics share.

use scene::SceneReader;
use schema::{AgentId, DetectionClass};

use crate::EvaluationError;
use crate::boxes::{Prediction, Solid, Target};
use crate::mode::{Mode, SeenBy};
use crate::predictions::{FoundBox, PredictionFile};
use crate::sample::{SceneRows, range_of};
use crate::samples::greatest_common_divisor;
use crate::simbev2x::{BY_DISTANCE, surest};
use crate::targets::SceneLabels;

/// A prediction with what it found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Its class.
    pub class: DetectionClass,
    /// How sure it is.
    pub score: f64,
    /// The box.
    pub solid: Solid,
    /// The id of the object that it found, by [`crate::THRESHOLDS_M`].
    ///
    /// Surer predictions choose first: what one found does not change where only those from a score on count.
    pub found: [Option<u16>; 4],
}

/// A frame of an ego, with what was predicted in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Frame number.
    pub frame: u32,
    /// The ego.
    pub ego: AgentId,
    /// With whom the model worked together.
    pub mode: Mode,
    /// Ids and classes of the boxes that are to be found, in the order of the ego's list.
    pub targets: Vec<(u16, DetectionClass)>,
    /// What was predicted: class by class in canonical order, the surest first.
    pub predictions: Vec<Paired>,
}

/// What the predictions of a scene found.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePairs {
    /// Samples are frames 0, n, 2 n, ...: n is the greatest step that meets all frames with predictions.
    pub every_n_frames: u32,
    /// By ego, frame and mode. Egos are those that the scene has predictions for.
    pub samples: Vec<Sample>,
}

impl ScenePairs {
    /// Holds the predictions of a scene against its boxes.
    ///
    /// # Errors
    /// The store or the file cannot be read; a prediction is of an agent or a frame that is none.
    pub fn read(scene: &SceneReader, file: &PredictionFile, seen: SeenBy) -> Result<Self, EvaluationError> {
        let SceneRows { number, frames, labelled, agents, rows } = SceneRows::read(scene, file)?;
        if rows.is_empty() {
            return Ok(Self { every_n_frames: labelled, samples: Vec::new() });
        }
        // Of frame 0 alone: no other one.
        let step = rows.iter().fold(0, |step, row| greatest_common_divisor(step, row.frame));
        let every_n_frames = if step == 0 { frames.next_multiple_of(labelled) } else { step };
        let labels = SceneLabels::read(scene, |frame| schema::rate::is_due(frame, every_n_frames))?;
        let egos = agents.into_iter().filter(|agent| rows.iter().any(|row| row.agent == *agent));
        let modes: Vec<Mode> = file.modes().collect();
        let mut samples = Vec::new();
        for ego in egos {
            for frame in schema::rate::due(frames, every_n_frames) {
                let Some(pose) = labels.pose(frame, ego) else {
                    let problem = "`agents` has no row of it".to_owned();
                    let agent = ego.to_string();
                    return Err(EvaluationError::Labels { scene: number, frame, agent, problem });
                };
                let mut seen = labels.of(frame, ego, seen);
                seen.retain(|label| label.is_seen);
                let targets: Vec<(u16, Target)> = seen
                    .iter()
                    .filter_map(|label| {
                        Some((label.id, label.target(label.class.in_simbev2x()?, pose.xyz_m)))
                    })
                    .collect();
                for mode in &modes {
                    let own = rows[range_of(&rows, ego, frame, *mode)].iter().filter_map(|row| {
                        let FoundBox { class, score, solid, attribute } = row.found?;
                        let (class, distance_m) = (class.in_simbev2x()?, solid.away_m(pose.xyz_m));
                        Some(Prediction { class, score, solid, distance_m, attribute })
                    });
                    let predictions = paired(&targets, &own.collect::<Vec<_>>());
                    let ids = targets.iter().map(|(id, target)| (*id, DetectionClass::ALL[target.class]));
                    samples.push(Sample { frame, ego, mode: *mode, targets: ids.collect(), predictions });
                }
            }
        }
        Ok(Self { every_n_frames, samples })
    }
}

/// What the predictions of a sample found.
fn paired(targets: &[(u16, Target)], predictions: &[Prediction]) -> Vec<Paired> {
    let mut pairs = Vec::with_capacity(predictions.len());
    for (number, class) in DetectionClass::ALL.into_iter().enumerate() {
        let own = surest(number, predictions);
        let (ids, solids): (Vec<u16>, Vec<&Target>) =
            targets.iter().filter(|(_, t)| t.class == number).map(|(id, t)| (*id, t)).unzip();
        let found = BY_DISTANCE.assigned(&own, &solids);
        pairs.extend(own.iter().enumerate().map(|(position, prediction)| Paired {
            class,
            score: prediction.score,
            solid: prediction.solid,
            found: [0, 1, 2, 3].map(|at| found[at][position].map(|target| ids[target])),
        }));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use schema::Difficulty;

    use super::*;
    use crate::boxes::Sighting;
    use crate::simbev2x::SimBev2xTally;

    fn target(class: usize, x_m: f64) -> Target {
        let solid = Solid { center_m: [x_m, 0.0, 0.0], size_m: [4.0, 2.0, 1.5], ..Solid::default() };
        let (difficulty, sighting) = (Difficulty::Easy, Sighting::Ego);
        Target { class, solid, distance_m: x_m.abs(), difficulty, sighting, attribute: None }
    }

    fn prediction(class: usize, x_m: f64, score: f64) -> Prediction {
        let Target { solid, distance_m, .. } = target(class, x_m);
        Prediction { class, score, solid, distance_m, attribute: None }
    }

    #[test]
    fn the_surest_chooses_first_and_only_among_its_class() {
        let targets = [(7, target(0, 10.0)), (9, target(0, 11.0)), (3, target(1, 10.0))];
        let predictions = [prediction(0, 10.1, 0.4), prediction(0, 10.2, 0.9), prediction(1, 30.0, 0.5)];
        let pairs = paired(&targets, &predictions);
        let scores: Vec<f64> = pairs.iter().map(|p| p.score).collect();
        assert_eq!(scores, [0.9, 0.4, 0.5]);
        assert_eq!(pairs[0].found, [Some(7); 4]);
        // 0.9 m from the one that is left: too far for half a metre.
        assert_eq!(pairs[1].found, [None, Some(9), Some(9), Some(9)]);
        assert_eq!(pairs[2].found, [None; 4]);
    }

    #[test]
    fn as_many_are_found_as_the_metrics_count() {
        let targets: Vec<(u16, Target)> =
            (0..60).map(|i| (100 + i, target(usize::from(i % 3), f64::from(i) * 1.7))).collect();
        let predictions: Vec<Prediction> = (0..400)
            .map(|i| prediction(i % 3, (i * 37 % 401) as f64 * 0.26, (i * 53 % 97) as f64 / 97.0))
            .collect();
        let pairs = paired(&targets, &predictions);
        let mut tally = SimBev2xTally::<4>::default();
        tally.add(&targets.iter().map(|(_, t)| *t).collect::<Vec<_>>(), &predictions);
        for (number, class) in DetectionClass::ALL.into_iter().enumerate() {
            let own: Vec<&Paired> = pairs.iter().filter(|p| p.class == class).collect();
            let hits = &tally.classes[number].hits;
            assert_eq!(own.len(), hits.len());
            for (pair, hit) in own.iter().zip(hits) {
                let right = hit.counts.map(|counts| counts.at(crate::Level::All) == Some(true));
                assert_eq!((pair.score, pair.found.map(|id| id.is_some())), (hit.score, right));
            }
        }
        assert!(pairs.iter().any(|p| p.found[0].is_none() && p.found[3].is_some()));
    }

    #[test]
    fn steps_meet_all_frames() {
        let step =
            |frames: &[u32]| frames.iter().fold(0, |step, frame| greatest_common_divisor(step, *frame));
        assert_eq!([step(&[0, 10, 30]), step(&[4, 6]), step(&[0]), step(&[0, 7])], [10, 2, 0, 7]);
    }
}
