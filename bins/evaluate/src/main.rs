//! Scores predicted boxes against a finished store.

mod error;
mod table;

use std::process::ExitCode;

use arguments::evaluate::{Evaluate, Metrics, SeenBy};
use clap::Parser;
use evaluation::{EvaluationError, Plan, PredictionFile, Protocol, Seen, evaluate, write_measures};
use export_core::{Selection, Source, matches};
use pipeline::{EXIT_DONE, report, say};
use scene::SceneReader;
use schema::table::Row;
use schema::tables::{AgentRow, ValidBoxRow};
use store::Store;

use error::EvaluateError;

fn main() -> ExitCode {
    let args = Evaluate::parse();
    pipeline::init_logging();
    ExitCode::from(match run(&args) {
        Ok(()) => EXIT_DONE,
        Err(fault) => {
            tracing::error!("{}", report(&fault));
            fault.exit_code()
        }
    })
}

fn run(args: &Evaluate) -> Result<(), EvaluateError> {
    let refuse = |problem: String| EvaluateError::from(EvaluationError::Refused(problem));
    for (name, value) in [("--comm-range-m", args.comm_range_m), ("--elevation-m", args.elevation_m)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(refuse(format!("{name} is {value}, expected metres from 0 on")));
        }
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| refuse(format!("--threads: {e}")))?;
    let out = args.out.as_deref();
    if let Some(out) = out.filter(|out| !out.extension().is_some_and(|end| end == "json" || end == "parquet"))
    {
        return Err(refuse(format!(
            "--out {}: results are written to names in .parquet or .json",
            out.display()
        )));
    }
    let file = PredictionFile::open(&args.predictions)?;
    let scenes = scenes(args, &file)?;
    let protocols: Vec<Protocol> = match args.metrics.as_slice() {
        [] => Protocol::ALL.to_vec(),
        some => Protocol::ALL.into_iter().filter(|p| some.iter().any(|m| protocol(*m) == *p)).collect(),
    };
    let seen = match args.seen {
        SeenBy::Partners => Seen::Partners { range_m: args.comm_range_m, elevation_m: args.elevation_m },
        SeenBy::Ego => Seen::Ego,
        SeenBy::Nobody => Seen::Nobody,
    };
    let plan = Plan {
        protocols: &protocols,
        seen,
        every_n_frames: args.every,
        is_ego: &|agent| args.agents.iter().any(|pattern| matches(pattern, &agent.to_string())),
    };
    let result = pool.install(|| evaluate(&scenes, &file, &plan))?;
    say(&table::table(&result));
    if let Some(out) = out {
        write_measures(out, &result.measures())?;
    }
    Ok(())
}

fn protocol(metrics: Metrics) -> Protocol {
    match metrics {
        Metrics::Simbev2x => Protocol::SimBev2x,
        Metrics::Nuscenes => Protocol::NuScenes,
    }
}

/// The scenes that are evaluated: those that are wanted and finished. The file may have rows of others of the plan.
fn scenes(args: &Evaluate, file: &PredictionFile) -> Result<Vec<SceneReader>, EvaluateError> {
    let store = Store::open(&args.store)?;
    let needs = [AgentRow::STAGE, ValidBoxRow::STAGE];
    let all = Source::open(&store, &Selection::default(), &needs)?;
    let known =
        |scene: u32| all.unfinished.contains_key(&scene) || all.scenes.iter().any(|s| s.number() == scene);
    if let Some(scene) = file.scenes().find(|scene| !known(*scene)) {
        let problem =
            format!("has rows of scene {scene}, which is not in the plan of {}", args.store.display());
        return Err(EvaluationError::Predictions { path: file.path().to_owned(), problem }.into());
    }
    let scenes = args.scenes.as_ref().map(|scenes| scenes.ranges().to_vec());
    let selection = Selection { scenes, splits: args.split.clone(), ..Selection::default() };
    let wanted = Source::open(&store, &selection, &needs)?;
    for scene in file.scenes() {
        if let Some(missing) = wanted.unfinished.get(&scene) {
            let problem = format!("has rows of scene {scene}, which is not finished ({missing})");
            return Err(EvaluationError::Predictions { path: file.path().to_owned(), problem }.into());
        }
    }
    if !wanted.unfinished.is_empty() {
        tracing::warn!("{} scenes are not finished and not evaluated", wanted.unfinished.len());
    }
    if wanted.scenes.is_empty() {
        return Err(EvaluationError::Refused(
            "no scene that is wanted is finished: run `make dataset` first".into(),
        )
        .into());
    }
    Ok(wanted.scenes.iter().map(|scene| scene.reader().clone()).collect())
}
