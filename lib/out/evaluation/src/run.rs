//! A file of predictions against scenes of a store.

use rayon::prelude::*;
use scene::SceneReader;
use schema::AgentId;

use crate::EvaluationError;
use crate::boxes::{Prediction, SampleId, Target};
use crate::details::Details;
use crate::mode::{Mode, SeenBy};
use crate::nuscenes::{NuScenesScores, NuScenesTally, nuscenes_class};
use crate::opv2v::{Opv2vScores, Opv2vTally, is_opv2v_vehicle};
use crate::predictions::{PredictionFile, PredictionRow};
use crate::protocol::Protocol;
use crate::sample::{SceneRows, range_of};
use crate::simbev2x::{SimBev2xScores, SimBev2xTally, canonical_class};
use crate::targets::{Label, SceneLabels};

/// As many boxes nuScenes lets a model find in a sample.
const MAX_BOXES: usize = 500;

/// What is evaluated, and by which metrics.
pub struct Plan<'a> {
    /// The metrics.
    pub protocols: &'a [Protocol],
    /// By whom a box must be seen to be a target.
    pub seen: SeenBy,
    /// Samples are frames 0, n, 2 n, ...; none: all that have boxes.
    pub every_n_frames: Option<u32>,
    /// How many of the worst frames are told, with curves and what was found at which distance; none: nothing
    /// of all this.
    pub worst_frames: Option<usize>,
    /// Which agents are egos.
    pub is_ego: &'a (dyn Fn(AgentId) -> bool + Sync),
}

/// The scores of the predictions of one mode.
#[derive(Clone, Debug)]
pub struct ModeScores {
    /// With whom the model worked together.
    pub mode: Mode,
    /// How many samples have predictions of it.
    pub samples: u64,
    /// SimBEV2X's scores, if they were asked for.
    pub simbev2x: Option<SimBev2xScores>,
    /// What pages show of SimBEV2X's metrics, if they and it were asked for.
    pub details: Option<Details>,
    /// nuScenes' scores, likewise.
    pub nuscenes: Option<NuScenesScores>,
    /// OPV2V's scores, likewise.
    pub opv2v: Option<Opv2vScores>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Scores by mode.
    pub modes: Vec<ModeScores>,
    /// Frames of egos that were looked at.
    pub samples: u64,
    /// Predictions that were looked at.
    pub predictions: u64,
    /// Predictions of other frames and egos of these scenes, which were left out.
    pub left_out: u64,
}

#[derive(Default)]
struct Tally {
    samples: u64,
    simbev2x: SimBev2xTally,
    nuscenes: NuScenesTally,
    opv2v: Opv2vTally,
}

/// What a scene, or an ego of it, gives.
struct PartialScores {
    modes: Vec<Tally>,
    samples: u64,
    predictions: u64,
    left_out: u64,
}

impl PartialScores {
    fn new(modes: usize) -> Self {
        let modes = std::iter::repeat_with(Tally::default).take(modes).collect();
        Self { modes, samples: 0, predictions: 0, left_out: 0 }
    }

    fn append(&mut self, later: Self) {
        self.samples += later.samples;
        self.predictions += later.predictions;
        self.left_out += later.left_out;
        for (tally, later) in self.modes.iter_mut().zip(later.modes) {
            tally.samples += later.samples;
            tally.simbev2x.append(later.simbev2x);
            tally.nuscenes.append(later.nuscenes);
            tally.opv2v.append(later.opv2v);
        }
    }
}

/// Holds the predictions of some scenes against their boxes, on the threads of the pool at hand; the result
/// does not depend on how many these are. As many scenes are in memory as there are threads.
///
/// # Errors
/// The store or the file cannot be read; a prediction is of an agent, a frame or a scene that is none; there
/// is nothing to evaluate; nuScenes' metrics are asked for and a sample has more than 500 predictions.
pub fn evaluate(
    scenes: &[SceneReader],
    file: &PredictionFile,
    plan: &Plan<'_>,
) -> Result<Evaluation, EvaluationError> {
    let modes: Vec<Mode> = file.modes().collect();
    let mut whole = PartialScores::new(modes.len());
    for some in scenes.chunks(rayon::current_num_threads().max(1)) {
        let parts: Vec<_> = some.par_iter().map(|scene| of_scene(scene, file, &modes, plan)).collect();
        for part in parts {
            whole.append(part?);
        }
    }
    if whole.predictions == 0 {
        let problem = "none of its rows is of a frame and agent that is evaluated".to_owned();
        return Err(EvaluationError::Predictions { path: file.path().to_owned(), problem });
    }
    let scores = modes.into_iter().zip(&whole.modes).map(|(mode, tally)| ModeScores {
        mode,
        samples: tally.samples,
        simbev2x: plan.protocols.contains(&Protocol::SimBev2x).then(|| tally.simbev2x.scores()),
        details: plan
            .worst_frames
            .filter(|_| plan.protocols.contains(&Protocol::SimBev2x))
            .map(|frames| tally.simbev2x.details(frames)),
        nuscenes: plan.protocols.contains(&Protocol::NuScenes).then(|| tally.nuscenes.scores()),
        opv2v: plan.protocols.contains(&Protocol::Opv2v).then(|| tally.opv2v.scores()),
    });
    let modes = scores.collect();
    let PartialScores { samples, predictions, left_out, .. } = whole;
    Ok(Evaluation { modes, samples, predictions, left_out })
}

fn of_scene(
    scene: &SceneReader,
    file: &PredictionFile,
    modes: &[Mode],
    plan: &Plan<'_>,
) -> Result<PartialScores, EvaluationError> {
    let SceneRows { number, frames, labelled, agents, mut rows } = SceneRows::read(scene, file)?;
    let every = plan.every_n_frames.unwrap_or(labelled);
    if !every.is_multiple_of(labelled) {
        return Err(EvaluationError::Refused(format!(
            "scene {number} has boxes at every {labelled}th frame: every {every}th is no multiple of that"
        )));
    }
    let all = rows.len();
    rows.retain(|row| schema::rate::is_due(row.frame, every) && (plan.is_ego)(row.agent));
    let labels = SceneLabels::read(scene, every)?;
    let egos: Vec<AgentId> = agents.into_iter().filter(|agent| (plan.is_ego)(*agent)).collect();
    let parts: Vec<_> = egos
        .par_iter()
        .map(|ego| {
            let mut part = PartialScores::new(modes.len());
            for frame in schema::rate::due(frames, every) {
                add_sample(&mut part, (number, frame, *ego), &labels, &rows, modes, plan)?;
            }
            Ok::<PartialScores, EvaluationError>(part)
        })
        .collect();
    let mut whole = PartialScores::new(modes.len());
    whole.left_out = (all - rows.len()) as u64;
    for part in parts {
        whole.append(part?);
    }
    Ok(whole)
}

fn add_sample(
    part: &mut PartialScores,
    (scene, frame, ego): (u32, u32, AgentId),
    labels: &SceneLabels,
    rows: &[PredictionRow],
    modes: &[Mode],
    plan: &Plan<'_>,
) -> Result<(), EvaluationError> {
    let Some((own, xyz_m)) = labels.pose(frame, ego) else {
        let problem = "`agents` has no row of it".to_owned();
        return Err(EvaluationError::Labels { scene, frame, agent: ego.to_string(), problem });
    };
    let boxes = labels.of(frame, ego, plan.seen);
    part.samples += 1;
    let target = |class: usize, label: &Label| label.target(class, xyz_m);
    let seen = || boxes.iter().filter(|label| label.is_seen);
    let simbev2x: Vec<Target> =
        seen().filter_map(|label| canonical_class(label.class).map(|class| target(class, label))).collect();
    let vehicles = seen().filter(|label| label.id != own && is_opv2v_vehicle(label.class));
    let opv2v: Vec<Target> = vehicles.map(|label| target(0, label)).collect();
    let has_points = |label: &&Label| plan.seen == SeenBy::Nobody || label.points > 0;
    let nuscenes: Vec<Target> = boxes
        .iter()
        .filter(|label| label.id != own)
        .filter(has_points)
        .filter_map(|label| {
            let (class, range_m) = nuscenes_class(label.class)?;
            Some(target(class, label)).filter(|target| target.distance_m < range_m)
        })
        .collect();
    for (mode, tally) in modes.iter().zip(&mut part.modes) {
        let found = &rows[range_of(rows, ego, frame, *mode)];
        part.predictions += found.len() as u64;
        tally.samples += u64::from(!found.is_empty());
        let prediction = |class, row: &PredictionRow| Prediction {
            class,
            score: row.score,
            solid: row.solid,
            distance_m: row.solid.away_m(xyz_m),
            attribute: row.attribute,
        };
        if plan.protocols.contains(&Protocol::SimBev2x) {
            let found: Vec<Prediction> = found
                .iter()
                .filter_map(|row| canonical_class(row.class).map(|class| prediction(class, row)))
                .collect();
            if plan.worst_frames.is_some() {
                tally.simbev2x.begin(SampleId { scene, frame, ego });
            }
            tally.simbev2x.add(&simbev2x, &found);
        }
        if plan.protocols.contains(&Protocol::NuScenes) {
            let known = || found.iter().filter_map(|row| Some((nuscenes_class(row.class)?, row)));
            let count = known().count();
            if count > MAX_BOXES {
                return Err(EvaluationError::Refused(format!(
                    "scene {scene}, frame {frame}, {ego}: {count} predictions, nuScenes allows {MAX_BOXES} a sample \
                     (keep the surest, or evaluate with --metrics simbev2x)"
                )));
            }
            let found: Vec<Prediction> = known()
                .map(|((class, range_m), row)| (range_m, prediction(class, row)))
                .filter(|(range_m, prediction)| prediction.distance_m < *range_m)
                .map(|(_, prediction)| prediction)
                .collect();
            tally.nuscenes.add(&nuscenes, &found);
        }
        if plan.protocols.contains(&Protocol::Opv2v) {
            let vehicles = found.iter().filter(|row| is_opv2v_vehicle(row.class));
            tally.opv2v.add(&opv2v, &vehicles.map(|row| prediction(0, row)).collect::<Vec<_>>());
        }
    }
    Ok(())
}
