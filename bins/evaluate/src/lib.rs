//! Scores predicted boxes and BEV masks against a finished store.

mod error;
mod page;
mod table;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use arguments::evaluate as asked;
use arguments::evaluate::{Evaluate, Metrics};
use evaluation::{
    Breakdown, Evaluation, EvaluationError, ExportedSamples, Extent, MaskEvaluation, MaskFolder, MaskPlan,
    Plan, PredictionFile, Protocol, SeenBy, evaluate, evaluate_masks, read_annotations, read_results,
    write_measures,
};
use export_core::{Selection, Source, matches};
use runner::{EXIT_DONE, report, say};
use scene::SceneReader;
use schema::AgentId;
use schema::arrays::BEV_MASKS;
use schema::table::Row;
use schema::tables::{AgentRow, ValidBoxRow};
use store::Store;

use error::EvaluateError;

/// What must be made of a scene whose boxes are evaluated.
const NEEDED_OF_BOXES: [&str; 2] = [AgentRow::STAGE, ValidBoxRow::STAGE];

/// The egos whose predictions are evaluated where nothing is said.
const VEHICLES: &str = "vehicle_*";

/// As many frames are named on the page.
const WORST_FRAMES: usize = 20;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    let args = arguments::parse::<Evaluate>(&words, build_stamp::STAMP);
    runner::init_logging();
    ExitCode::from(match run(&args) {
        Ok(()) => EXIT_DONE,
        Err(fault) => {
            tracing::error!("{}", report(&fault));
            fault.exit_code()
        }
    })
}

fn run(args: &Evaluate) -> Result<(), EvaluateError> {
    for (name, value) in [("--comm-range-m", args.comm_range_m), ("--elevation-m", args.elevation_m)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(refused(format!("{name} is {value}, expected metres from 0 on")));
        }
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| refused(format!("--threads: {e}")))?;
    let out = args.out.as_deref();
    if let Some(out) = out.filter(|out| !out.extension().is_some_and(|end| end == "json" || end == "parquet"))
    {
        return Err(refused(format!(
            "--out {}: results are written to names in .parquet or .json",
            out.display()
        )));
    }
    let store = Store::open(&args.store)?;
    let found = match &args.predictions {
        Some(predictions) => Some(pool.install(|| boxes(args, &store, predictions))?),
        None => None,
    };
    let painted = match &args.bev_masks {
        Some(folder) => Some(pool.install(|| masks(args, &store, folder))?),
        None => None,
    };
    let mut rows = Vec::new();
    if let Some(result) = found.as_ref() {
        warn_of_gaps(result);
        say(&table::of_boxes(result));
        rows.extend(result.rows.iter().cloned());
    }
    if let Some(result) = &painted {
        say(&table::of_masks(result));
        rows.extend(result.rows.iter().cloned());
    }
    if args.bootstrap > 0 || args.by.is_some() {
        say(&table::of_means(&rows));
    }
    if let Some(out) = out {
        write_measures(out, &rows)?;
    }
    if let Some(path) = &args.report {
        let name = Source::open(&store, &Selection::default(), &[])?.dataset()?;
        let name = name.pointer("/config/name").and_then(|name| name.as_str()).unwrap_or("dataset");
        let page = page::page(name, found.as_ref(), painted.as_ref());
        std::fs::write(path, page).map_err(|e| {
            let (path, problem) = (path.display().to_string(), e.to_string());
            EvaluateError::from(EvaluationError::Write { path, problem })
        })?;
    }
    Ok(())
}

fn refused(problem: String) -> EvaluateError {
    EvaluationError::Refused(problem).into()
}

fn is_ego(args: &Evaluate, agent: AgentId, by_default: &str) -> bool {
    let name = agent.to_string();
    match args.agents.as_slice() {
        [] => matches(by_default, &name),
        some => some.iter().any(|pattern| matches(pattern, &name)),
    }
}

/// The part of the ego's frame in which boxes count.
fn extent(args: &Evaluate) -> Result<Option<Extent>, EvaluateError> {
    let Some([x0, y0, x1, y1]) = args.range_m else { return Ok(None) };
    // Not so where one of them is no number.
    if x0 < x1 && y0 < y1 {
        return Ok(Some(Extent { from_m: [x0, y0], to_m: [x1, y1] }));
    }
    Err(refused(format!(
        "--range-m is {:?}, expected the least x and y, then the greatest, such as -51.2,-51.2,51.2,51.2",
        [x0, y0, x1, y1]
    )))
}

fn breakdown(args: &Evaluate) -> Breakdown {
    Breakdown { bootstrap_rounds: args.bootstrap, by_map: args.by == Some(asked::Part::Map) }
}

/// Frames that a file leaves out between others are no samples: scores may be better than the model is.
fn warn_of_gaps(result: &Evaluation) {
    if result.counts.between > 0 {
        tracing::warn!(
            "{} samples lie between those that the file names and are not evaluated: name those in which nothing was \
             found by a row without a class (docs/evaluation.md), or give --every N",
            result.counts.between
        );
    }
}

/// The scores of predicted boxes.
fn boxes(args: &Evaluate, store: &Store, predictions: &Path) -> Result<Evaluation, EvaluateError> {
    let all = Source::open(store, &Selection::default(), &NEEDED_OF_BOXES)?;
    let (file, export) = open_predictions(args, &all, predictions)?;
    let scenes = scenes_of_boxes(args, &all, &file)?;
    let protocols: Vec<Protocol> = match args.metrics.as_slice() {
        [] => Protocol::USUAL.to_vec(),
        some => Protocol::ALL.into_iter().filter(|p| some.iter().any(|m| protocol(*m) == *p)).collect(),
    };
    // An export to nuScenes is of the boxes that each agent sees by itself.
    let of_export = export.is_some();
    let seen = match args.seen {
        Some(asked::SeenBy::Ego) => SeenBy::Ego,
        None if of_export => SeenBy::Ego,
        Some(asked::SeenBy::Nobody) => SeenBy::Nobody,
        Some(asked::SeenBy::Partners) | None => {
            SeenBy::Partners { range_m: args.comm_range_m, elevation_m: args.elevation_m }
        }
    };
    let annotations = match &export {
        Some(export) if args.seen.is_none() && protocols.contains(&Protocol::NuScenes) => {
            Some(read_annotations(export)?)
        }
        _ => None,
    };
    let egos = if of_export { "*" } else { VEHICLES };
    let plan = Plan {
        protocols: &protocols,
        seen,
        annotations: annotations.as_ref(),
        every_n_frames: args.every,
        extent: extent(args)?,
        attributes_by_speed: args.attributes_by_speed,
        worst_frames: args.report.is_some().then_some(WORST_FRAMES),
        breakdown: breakdown(args),
        is_ego: &|agent| is_ego(args, agent, egos),
    };
    if args.every.is_none() {
        let named: BTreeSet<u32> = file.scenes().collect();
        let silent = scenes.iter().filter(|scene| !named.contains(&scene.scene())).count();
        // Whoever chose scenes expects all of them to be looked at.
        let is_chosen = args.scenes.is_some()
            || [args.split.is_empty(), args.group.is_empty(), args.edition.is_empty()].contains(&false);
        if silent > 0 && is_chosen {
            tracing::warn!(
                "{silent} of the {} scenes that are wanted are not in the file and not evaluated",
                scenes.len()
            );
        }
    }
    Ok(evaluate(&scenes, &file, &plan)?)
}

/// Opens a file of predictions: our own, or nuScenes' results with the export that they are of.
fn open_predictions(
    args: &Evaluate,
    all: &Source,
    path: &Path,
) -> Result<(PredictionFile, Option<ExportedSamples>), EvaluateError> {
    let is_json = path.extension().is_some_and(|end| end == "json");
    match &args.nuscenes {
        Some(folder) if is_json => {
            let map_of = |number: u32| {
                let scene = all.scenes.iter().find(|scene| scene.number() == number)?;
                Some(scene.info().map.clone())
            };
            let export = ExportedSamples::read(folder, map_of)?;
            Ok((read_results(path, &export)?, Some(export)))
        }
        None if is_json => Err(refused(format!(
            "{}: results of nuScenes need the export that they are of: --nuscenes FOLDER",
            path.display()
        ))),
        Some(_) => Err(refused("--nuscenes goes with --predictions in .json".into())),
        None => Ok((PredictionFile::open(path)?, None)),
    }
}

/// The scores of predicted BEV masks.
fn masks(args: &Evaluate, store: &Store, folder: &Path) -> Result<MaskEvaluation, EvaluateError> {
    let folder = MaskFolder::open(folder)?;
    let wanted = wanted(args, store, &[AgentRow::STAGE, BEV_MASKS.stage])?;
    let plan = MaskPlan {
        every_n_frames: args.every,
        breakdown: breakdown(args),
        is_ego: &|agent| is_ego(args, agent, VEHICLES),
    };
    Ok(evaluate_masks(&readers(&wanted)?, &folder, &plan)?)
}

fn protocol(metrics: Metrics) -> Protocol {
    match metrics {
        Metrics::Simbev2x => Protocol::SimBev2x,
        Metrics::Simbev2xIou => Protocol::SimBev2xIou,
        Metrics::Nuscenes => Protocol::NuScenes,
        Metrics::Opv2v => Protocol::Opv2v,
    }
}

/// The scenes that are wanted, as far as some stages have finished them.
fn wanted(args: &Evaluate, store: &Store, needs: &[&'static str]) -> Result<Source, EvaluateError> {
    let scenes = args.scenes.as_ref().map(|scenes| scenes.ranges().to_vec());
    let selection = Selection {
        scenes,
        splits: args.split.clone(),
        editions: args.edition.clone(),
        groups: args.group.clone(),
        ..Selection::default()
    };
    Ok(Source::open(store, &selection, needs)?)
}

/// Those that are finished, of which there must be some.
fn readers(wanted: &Source) -> Result<Vec<SceneReader>, EvaluateError> {
    if !wanted.unfinished.is_empty() {
        tracing::warn!("{} scenes are not finished and not evaluated", wanted.unfinished.len());
    }
    if wanted.scenes.is_empty() {
        let place = wanted.store.location("");
        return Err(refused(format!(
            "no scene that is wanted is finished: run `convoy run --store {place}` first"
        )));
    }
    Ok(wanted.scenes.iter().map(|scene| scene.reader().clone()).collect())
}

/// The scenes whose boxes are evaluated: those that are wanted and finished. The file may have rows of others
/// of the plan.
fn scenes_of_boxes(
    args: &Evaluate,
    all: &Source,
    file: &PredictionFile,
) -> Result<Vec<SceneReader>, EvaluateError> {
    let fault = |problem: String| EvaluationError::Predictions { path: file.path().to_owned(), problem };
    let known =
        |scene: u32| all.unfinished.contains_key(&scene) || all.scenes.iter().any(|s| s.number() == scene);
    if let Some(scene) = file.scenes().find(|scene| !known(*scene)) {
        let place = args.store.display();
        return Err(fault(format!("has rows of scene {scene}, which is not in the plan of {place}")).into());
    }
    let wanted = wanted(args, &all.store, &NEEDED_OF_BOXES)?;
    for scene in file.scenes() {
        if let Some(missing) = wanted.unfinished.get(&scene) {
            return Err(fault(format!("has rows of scene {scene}, which is not finished ({missing})")).into());
        }
    }
    readers(&wanted)
}
