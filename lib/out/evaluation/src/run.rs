//! A file of predictions against scenes of a store.

use rayon::prelude::*;
use scene::SceneReader;
use schema::AgentId;

use crate::EvaluationError;
use crate::annotations::SceneAnnotations;
use crate::attribute;
use crate::boxes::{Prediction, SampleId, Solid, Target};
use crate::extent::Extent;
use crate::measures::of_modes;
use crate::mode::{Mode, SeenBy};
use crate::predictions::{FoundBox, PredictionFile, PredictionRow};
use crate::protocol::Protocol;
use crate::result::{Breakdown, Evaluation};
use crate::sample::{SceneRows, range_of};
use crate::samples::Samples;
use crate::tally::{Part, Wanted};
use crate::targets::{Label, SceneLabels};

/// As many boxes nuScenes lets a model find in a sample.
const MAX_BOXES: usize = 500;

/// What is evaluated, and by which metrics.
pub struct Plan<'a> {
    /// The metrics.
    pub protocols: &'a [Protocol],
    /// By whom a box must be seen to be a target.
    pub seen: SeenBy,
    /// The annotations of an export, which are nuScenes' targets then; none: these are of the store, too.
    pub annotations: Option<&'a PredictionFile>,
    /// Samples are frames 0, n, 2 n, ... of every ego; none: those that the file names.
    pub every_n_frames: Option<u32>,
    /// The part of an ego's surroundings in which targets and predictions count; none: all of it.
    pub extent: Option<Extent>,
    /// Whether nuScenes' attributes follow from speeds where the file says none.
    pub attributes_by_speed: bool,
    /// How many of the worst frames are told, with curves and what was found at which distance; none: nothing
    /// of all this.
    pub worst_frames: Option<usize>,
    /// What is told besides.
    pub breakdown: Breakdown,
    /// Which agents are egos.
    pub is_ego: &'a (dyn Fn(AgentId) -> bool + Sync),
}

/// Holds the predictions of some scenes against their boxes, on the threads of the pool at hand; the result
/// does not depend on how many these are. As many scenes are in memory as there are threads.
///
/// # Errors
/// The store or the file cannot be read; a prediction is of an agent, a frame or a scene that is none; there
/// is nothing to evaluate; nuScenes' metrics are asked for and a sample has more than 500 predictions; scenes
/// are to be drawn and there is but one.
pub fn evaluate(
    scenes: &[SceneReader],
    file: &PredictionFile,
    plan: &Plan<'_>,
) -> Result<Evaluation, EvaluationError> {
    let modes: Vec<Mode> = file.modes().collect();
    let (mut whole, mut of_scenes) = (Part::new(modes.len()), Vec::new());
    for some in scenes.chunks(rayon::current_num_threads().max(1)) {
        let parts: Vec<_> = some.par_iter().map(|scene| of_scene(scene, file, &modes, plan)).collect();
        for (part, scene) in parts.into_iter().zip(some) {
            let part = part?;
            if plan.breakdown.needs_scenes() && part.counts.samples > 0 {
                of_scenes.push((scene.info()?.map.clone(), part.clone()));
            }
            whole.append(part);
        }
    }
    if whole.counts.rows == 0 {
        let problem = "none of its rows is of a frame and agent that is evaluated".to_owned();
        return Err(EvaluationError::Predictions { path: file.path().to_owned(), problem });
    }
    let wanted = Wanted {
        protocols: plan.protocols.to_vec(),
        worst_frames: plan.worst_frames,
        has_attributes: file.has_attributes() || plan.attributes_by_speed,
    };
    let scores = whole.scores(&modes, &wanted);
    let numbers_alone = Wanted { worst_frames: None, ..wanted };
    let rows = plan.breakdown.rows(of_modes(&scores), &of_scenes, |some| {
        of_modes(&Part::of_all(modes.len(), some.iter().copied()).scores(&modes, &numbers_alone))
    })?;
    Ok(Evaluation { modes: scores, counts: whole.counts, rows })
}

fn of_scene(
    scene: &SceneReader,
    file: &PredictionFile,
    modes: &[Mode],
    plan: &Plan<'_>,
) -> Result<Part, EvaluationError> {
    let SceneRows { number, frames, labelled, agents, mut rows } = SceneRows::read(scene, file)?;
    if let Some(every) = plan.every_n_frames.filter(|every| !every.is_multiple_of(labelled)) {
        return Err(EvaluationError::Refused(format!(
            "scene {number} has boxes at every {labelled}th frame: every {every}th is no multiple of that"
        )));
    }
    let all = rows.len();
    rows.retain(|row| (plan.is_ego)(row.agent));
    let samples = match plan.every_n_frames {
        Some(every) => {
            rows.retain(|row| schema::rate::is_due(row.frame, every));
            let egos: Vec<AgentId> = agents.into_iter().filter(|agent| (plan.is_ego)(*agent)).collect();
            Samples::every(every, frames, &egos)
        }
        None => Samples::named(&rows),
    };
    let mut whole = Part::new(modes.len());
    (whole.counts.rows, whole.counts.left_out) = (rows.len() as u64, (all - rows.len()) as u64);
    (whole.counts.without_boxes, whole.counts.between) = (samples.without_boxes, samples.between);
    let labels = SceneLabels::read(scene, |frame| samples.has_frame(frame))?;
    let annotations = plan.annotations.map(|file| SceneAnnotations::read(file, scene)).transpose()?;
    let truth = (&labels, annotations.as_ref());
    let egos: Vec<_> = samples.frames().collect();
    let parts: Vec<_> = egos
        .par_iter()
        .map(|(ego, frames)| {
            let mut part = Part::new(modes.len());
            for frame in frames.iter() {
                add_sample(&mut part, (number, *frame, *ego), truth, &rows, modes, plan)?;
            }
            Ok::<Part, EvaluationError>(part)
        })
        .collect();
    for part in parts {
        whole.append(part?);
    }
    Ok(whole)
}

fn add_sample(
    part: &mut Part,
    (scene, frame, ego): (u32, u32, AgentId),
    (labels, annotations): (&SceneLabels, Option<&SceneAnnotations>),
    rows: &[PredictionRow],
    modes: &[Mode],
    plan: &Plan<'_>,
) -> Result<(), EvaluationError> {
    let Some(pose) = labels.pose(frame, ego) else {
        let problem = "`agents` has no row of it".to_owned();
        return Err(EvaluationError::Labels { scene, frame, agent: ego.to_string(), problem });
    };
    let counts = |solid: &Solid| plan.extent.is_none_or(|extent| extent.holds(&pose, solid));
    let boxes: Vec<Label> =
        labels.of(frame, ego, plan.seen).into_iter().filter(|label| counts(&label.solid)).collect();
    part.counts.samples += 1;
    let target = |class: usize, label: &Label| label.target(class, pose.xyz_m);
    let seen = || boxes.iter().filter(|label| label.is_seen);
    let simbev2x: Vec<Target> =
        seen().filter_map(|label| Some(target(label.class.in_simbev2x()?, label))).collect();
    let vehicles = seen().filter(|label| label.id != pose.id && label.class.is_opv2v_vehicle());
    let opv2v: Vec<Target> = vehicles.map(|label| target(0, label)).collect();
    let has_points = |label: &&Label| plan.seen == SeenBy::Nobody || label.points > 0;
    let of_store = || {
        let others = boxes.iter().filter(|label| label.id != pose.id).filter(has_points);
        let near = others.filter_map(|label| {
            let (class, range_m) = label.class.in_nuscenes()?;
            Some(target(class, label)).filter(|target| target.distance_m < range_m)
        });
        near.collect()
    };
    let nuscenes: Vec<Target> = match annotations {
        Some(annotations) => {
            let targets = annotations.targets(frame, ego, pose.xyz_m).ok_or_else(|| {
                EvaluationError::Refused(format!(
                    "scene {scene}, frame {frame}, {ego}: the export has no such sample (--seen ego takes the store's boxes)"
                ))
            })?;
            targets.into_iter().filter(|target| counts(&target.solid)).collect()
        }
        None => of_store(),
    };
    for (mode, tally) in modes.iter().zip(&mut part.modes) {
        let found: Vec<&FoundBox> = rows[range_of(rows, ego, frame, *mode)]
            .iter()
            .filter_map(|row| row.found.as_ref())
            .filter(|found| counts(&found.solid))
            .collect();
        part.counts.predictions += found.len() as u64;
        tally.samples += u64::from(!found.is_empty());
        let prediction = |class, found: &FoundBox| Prediction {
            class,
            score: found.score,
            solid: found.solid,
            distance_m: found.solid.away_m(pose.xyz_m),
            attribute: found.attribute.or_else(|| {
                attribute::by_speed(found.class, found.solid.velocity_mps)
                    .filter(|_| plan.attributes_by_speed)
            }),
        };
        let of_simbev2x = |found: &&FoundBox| Some(prediction(found.class.in_simbev2x()?, found));
        let own: Vec<Prediction> = found.iter().filter_map(of_simbev2x).collect();
        if plan.protocols.contains(&Protocol::SimBev2x) {
            if plan.worst_frames.is_some() {
                tally.simbev2x.begin(SampleId { scene, frame, ego });
            }
            tally.simbev2x.add(&simbev2x, &own);
        }
        if plan.protocols.contains(&Protocol::SimBev2xIou) {
            tally.simbev2x_iou.add_by_overlap(&simbev2x, &own);
        }
        if plan.protocols.contains(&Protocol::NuScenes) {
            let known = || found.iter().filter_map(|found| Some((found.class.in_nuscenes()?, *found)));
            let count = known().count();
            if count > MAX_BOXES {
                return Err(EvaluationError::Refused(format!(
                    "scene {scene}, frame {frame}, {ego}: {count} predictions, nuScenes allows {MAX_BOXES} a sample \
                     (keep the surest, or evaluate with --metrics simbev2x)"
                )));
            }
            let near: Vec<Prediction> = known()
                .map(|((class, range_m), found)| (range_m, prediction(class, found)))
                .filter(|(range_m, prediction)| prediction.distance_m < *range_m)
                .map(|(_, prediction)| prediction)
                .collect();
            tally.nuscenes.add(&nuscenes, &near);
        }
        if plan.protocols.contains(&Protocol::Opv2v) {
            let vehicles = found.iter().filter(|found| found.class.is_opv2v_vehicle());
            tally.opv2v.add(&opv2v, &vehicles.map(|found| prediction(0, found)).collect::<Vec<_>>());
        }
    }
    Ok(())
}
