//! A folder of masks against scenes of a store.

use std::collections::BTreeMap;

use rayon::prelude::*;
use scene::{ArrayReader, SceneReader};
use schema::arrays::BEV_MASKS;
use schema::{AgentId, BevClass};
use serde::Deserialize;

use super::folder::MaskFolder;
use super::tally::{Grid, MaskMode, MaskTally};
use crate::EvaluationError;
use crate::measures::of_mask_modes;
use crate::result::{Breakdown, ResultRow};

/// Masks have at most so many channels.
const MOST_CLASSES: usize = 32;

/// What an archive of the store's masks says of itself.
#[derive(Debug, Deserialize)]
struct Description {
    classes: Vec<String>,
    cells: usize,
    cell_m: f64,
    every_n_frames: u32,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct MaskEvaluation {
    /// Scores by mode.
    pub modes: Vec<MaskMode>,
    /// All numbers: those of all scenes, then those of each map if they were asked for.
    pub rows: Vec<ResultRow>,
}

/// Which masks are evaluated, and what is said of them.
pub struct MaskPlan<'a> {
    /// Frames 0, n, 2 n, ... are evaluated; none: all that have masks.
    pub every_n_frames: Option<u32>,
    /// What is told besides.
    pub breakdown: Breakdown,
    /// Which agents are egos.
    pub is_ego: &'a (dyn Fn(AgentId) -> bool + Sync),
}

/// An ego of a scene.
struct Ego<'a> {
    scene: &'a SceneReader,
    agent: AgentId,
    frames: u32,
}

/// Holds predicted masks against those of some scenes, on the threads of the pool at hand; the result does
/// not depend on how many these are. A frame for each thread is in memory.
///
/// # Errors
/// The store or the folder cannot be read; an ego or frame that is evaluated has no masks; masks have other
/// classes than the store's, or cells that do not lie on its cells; a score is none; scenes are to be drawn
/// and there is but one.
pub fn evaluate_masks(
    scenes: &[SceneReader],
    masks: &MaskFolder,
    plan: &MaskPlan<'_>,
) -> Result<MaskEvaluation, EvaluationError> {
    let mut egos = Vec::new();
    for scene in scenes {
        let frames = scene.info()?.frames;
        let agents = scene.agents()?.into_iter().filter(|agent| (plan.is_ego)(*agent));
        egos.extend(agents.map(|agent| Ego { scene, agent, frames }));
    }
    let Some(first) = egos.first() else {
        return Err(EvaluationError::Refused(
            "no agent of these scenes is an ego: choose with --agents".into(),
        ));
    };
    let (classes, _) = describe(first)?;
    let mut of_scenes: BTreeMap<u32, (String, Vec<MaskTally>)> = BTreeMap::new();
    let nothing = vec![MaskTally::new(&classes); masks.modes().len()];
    for some in egos.chunks(4 * rayon::current_num_threads().max(1)) {
        let parts: Vec<_> =
            some.par_iter().map(|ego| of_ego(ego, masks, plan.every_n_frames, &classes)).collect();
        for (ego, part) in some.iter().zip(parts) {
            let scene = of_scenes.entry(ego.scene.scene());
            let (_, tallies) = scene.or_insert((ego.scene.info()?.map.clone(), nothing.clone()));
            append(tallies, &part?);
        }
    }
    let of_scenes: Vec<_> = of_scenes.into_values().collect();
    let scores = |some: &[&Vec<MaskTally>]| -> Vec<MaskMode> {
        let mut tallies = nothing.clone();
        some.iter().for_each(|part| append(&mut tallies, part));
        let modes = masks.modes().iter().zip(&tallies);
        modes.map(|(mode, tally)| MaskMode { mode: *mode, scores: tally.scores() }).collect()
    };
    let modes = scores(&of_scenes.iter().map(|(_, part)| part).collect::<Vec<_>>());
    let rows = plan.breakdown.rows(of_mask_modes(&modes), &of_scenes, |some| of_mask_modes(&scores(some)))?;
    Ok(MaskEvaluation { modes, rows })
}

/// Adds the tallies of each mode.
fn append(to: &mut [MaskTally], part: &[MaskTally]) {
    to.iter_mut().zip(part).for_each(|(tally, part)| tally.append(part));
}

/// What the store's masks of an ego are, and their classes.
fn describe(ego: &Ego<'_>) -> Result<(Vec<BevClass>, Description), EvaluationError> {
    let about: Description = scene::described(ego.scene, &BEV_MASKS, ego.agent)?;
    let named = about.classes.iter().map(|name| BevClass::from_name(name));
    match named.collect::<Option<Vec<_>>>().filter(|classes| classes.len() <= MOST_CLASSES) {
        Some(classes) => Ok((classes, about)),
        None => Err(wrong(ego, 0, format!("masks have classes {:?}, some of which are none", about.classes))),
    }
}

fn wrong(ego: &Ego<'_>, frame: u32, problem: String) -> EvaluationError {
    let (scene, agent) = (ego.scene.scene(), ego.agent.to_string());
    EvaluationError::Masks { scene, frame, agent, problem }
}

fn of_ego(
    ego: &Ego<'_>,
    masks: &MaskFolder,
    every_n_frames: Option<u32>,
    classes: &[BevClass],
) -> Result<Vec<MaskTally>, EvaluationError> {
    let (own, about) = describe(ego)?;
    let number = ego.scene.scene();
    if own != classes {
        return Err(EvaluationError::Refused(format!(
            "scene {number}, {}: its masks have other classes than those of scenes before it",
            ego.agent
        )));
    }
    let labelled = about.every_n_frames.max(1);
    let every = every_n_frames.unwrap_or(labelled);
    if !every.is_multiple_of(labelled) {
        return Err(EvaluationError::Refused(format!(
            "scene {number} has masks at every {labelled}th frame: every {every}th is no multiple of that"
        )));
    }
    let mut labels = ArrayReader::open(
        ego.scene,
        &BEV_MASKS,
        ego.agent,
        (classes.len() * about.cells * about.cells + (1 << 16)) as u64,
    )?;
    let mut archives = Vec::new();
    for mode in masks.modes() {
        archives.push(masks.archive(*mode, (number, ego.agent), (classes.len(), about.cells))?);
    }
    let mut tallies = vec![MaskTally::new(classes); archives.len()];
    let mut grids: Vec<Option<(usize, Grid)>> = vec![None; archives.len()];
    for frame in schema::rate::due(ego.frames, every) {
        let truth = labels.read(frame)?;
        for ((archive, grid), tally) in archives.iter_mut().zip(&mut grids).zip(&mut tallies) {
            let (passed, cells) = archive.passed(frame, classes.len())?;
            let grid = match grid {
                Some((known, grid)) if *known == cells => grid,
                _ => {
                    let cell_m = archive.cell_m.unwrap_or(about.cell_m);
                    let new = Grid::new((about.cells, about.cell_m), (cells, cell_m));
                    let new = new.map_err(|problem| {
                        archive.fault(format!("{}: {problem}", codecs::frame_member(frame)))
                    })?;
                    &mut grid.insert((cells, new)).1
                }
            };
            if !tally.add(grid, &truth.bytes, &passed) {
                let problem =
                    format!("masks have shape {:?}, their archive's comment says otherwise", truth.shape);
                return Err(wrong(ego, frame, problem));
            }
        }
    }
    Ok(tallies)
}
