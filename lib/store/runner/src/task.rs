//! A task: one share of a plan's scenes, through some stages, on whichever machine an engine gives it.

use std::collections::BTreeMap;
use std::path::Path;

use settings::{DatasetSettings, change_lines};
use store::{Manifest, Scope, Store};

use crate::agreement::{Terms, agree};
use crate::costs::{Costs, PlannedWork};
use crate::editions::{self, EditionWish, Editions};
use crate::error::StageError;
use crate::forecast::Work;
use crate::foresight::{Blame, Foreseer, Intent};
use crate::graph::{Graph, StageSpec};
use crate::imported::is_imported;
use crate::options::Shard;
use crate::programs::Programs;
use crate::shares;
use crate::state::{CodeRule, State, StateError};
use crate::status::Status;

/// What a task may do without being asked.
#[derive(Clone, Copy, Debug, Default)]
pub struct TaskRules {
    /// Make finished work again, however much it is.
    pub redo: bool,
    /// Keep what older code made.
    pub accept_code: bool,
}

/// A scene of a task.
#[derive(Clone, Debug)]
pub struct TaskScene {
    /// Its number.
    pub scene: u32,
    /// The stages that are not done, in running order, each with its work by the forecast, seconds of one
    /// core.
    pub stages: Vec<(&'static StageSpec, f64)>,
}

/// The scenes of a task that have something to do, longest first.
///
/// The plan must stand by this configuration, made by a program whose stages make the same: whoever planned
/// was asked about all that would be made again, and nobody is asked here.
///
/// # Errors
/// There is no such plan, or finished work would be made again that nobody agreed to.
pub fn task(
    (config, store): (Option<&DatasetSettings>, &Path),
    shard: Shard,
    stages: &[&'static StageSpec],
    (programs, rules): (&Programs, TaskRules),
) -> Result<Vec<TaskScene>, StageError> {
    let store = Store::open(store)?;
    let settings = match config {
        Some(settings) => settings.clone(),
        None => editions::newest_recorded(&store)?,
    };
    let editions = Editions::of_store(&store, &settings, EditionWish::Known)?;
    let code = if rules.accept_code { CodeRule::Any } else { CodeRule::Same };
    let status = Status::new(&store, &editions, programs).by_code(code);
    let record = status.plan()?;
    let Some(plan) = record.sound() else { return Err(no_plan(&store)) };
    is_planned_by(plan, &status, &editions)?;
    stages.iter().try_for_each(|stage| versions_agree(plan, stage))?;

    let (scenes, costs) = share(&store, plan, &editions, shard)?;
    let intent = Intent { stages: stages.to_vec(), code, ..Intent::to_run_all(status.clone()) };
    let foreseer = Foreseer::new(&intent, &editions)?;
    let looked = status.side_by_side(&scenes, |&scene| {
        let survey = status.survey(Scope::Scene(scene));
        let states = stages.iter().map(|stage| Ok((*stage, survey.state(stage)?)));
        let states = states.collect::<Result<Vec<_>, StateError>>()?;
        let first = states.iter().position(|(_, state)| *state != State::Done).unwrap_or(stages.len());
        let found = foreseer.as_ref().map(|foreseer| foreseer.look(&survey, scene)).transpose()?;
        Ok::<_, StateError>((scene, stages[first..].to_vec(), found.unwrap_or_default()))
    })?;
    let mut todo = Vec::new();
    let mut found = Vec::new();
    for (scene, stages, of_scene) in looked {
        found.push((scene, of_scene));
        let work_s = |stage: &StageSpec| {
            let work = costs.get(&scene).and_then(|stages| stages.get(stage.name));
            work.map_or(0.0, |work| work.core_s)
        };
        let stages: Vec<_> = stages.into_iter().map(|stage| (stage, work_s(stage))).collect();
        todo.extend((!stages.is_empty()).then_some(TaskScene { scene, stages }));
    }
    if let Some(foreseer) = foreseer {
        let foresight = foreseer.sum(found)?;
        // Who planned with these versions was asked; which edited programs others run, nobody knows.
        let is_committed = programs.made_by(Graph::get().planner().name).commit.is_some();
        let terms = Terms {
            makes: &|_| true,
            ask_beyond_s: editions.given().store.ask_beyond_s,
            shares: shard.count,
            least: if is_committed { Blame::Configuration } else { Blame::Code },
            redo: rules.redo,
            may_ask: false,
        };
        agree(&foresight, &terms)?;
    }
    // The longest first, so that what is left at the end is short.
    let whole_s = |scene: u32| costs.get(&scene).map_or(0.0, sum_s);
    todo.sort_by(|a, b| whole_s(b.scene).total_cmp(&whole_s(a.scene)).then(a.scene.cmp(&b.scene)));
    Ok(todo)
}

/// The work of each stage of each scene of the plan; none without a plan, or without a configuration.
///
/// # Errors
/// The plan's tables cannot be read.
pub fn planned_work(status: &Status<'_>) -> Result<PlannedWork, StageError> {
    match (status.plan()?.sound(), status.editions()) {
        (Some(plan), Some(editions)) => Ok(Costs::read(status.store(), plan, editions)?),
        _ => Ok(BTreeMap::new()),
    }
}

/// Refuses a plan of another configuration: whoever plans is asked what that makes again.
fn is_planned_by(plan: &Manifest, status: &Status<'_>, editions: &Editions) -> Result<(), StageError> {
    let planner = Graph::get().planner();
    let is_another = || {
        let hash = status.config_hash(planner, Scope::Plan)?;
        Ok::<_, StageError>(hash.is_some_and(|hash| plan.config_hash != hash))
    };
    let changed: Vec<String> =
        change_lines(&editions.changes().0).iter().map(|line| format!("\n  {line}")).collect();
    if !is_imported(plan) && (!changed.is_empty() || is_another()?) {
        return Err(StageError::usage(format!(
            "the plan was made from another configuration: run convoy run --stages plan first{}",
            changed.concat()
        )));
    }
    Ok(())
}

/// That a place holds no plan.
pub(crate) fn no_plan(store: &Store) -> StageError {
    let (place, planner) = (store.location(""), Graph::get().planner().name);
    StageError::usage(format!("{place} holds no plan: run {planner} first"))
}

/// Refuses a plan of a program whose stage makes something else.
///
/// # Errors
/// It is one.
pub(crate) fn versions_agree(plan: &Manifest, spec: &StageSpec) -> Result<(), StageError> {
    let then = plan.made_by.as_ref().and_then(|made_by| made_by.versions.get(spec.name));
    let (stage, now) = (spec.name, crate::code_version(spec.name));
    match then {
        Some(then) if then != now => Err(StageError::usage(format!(
            "the plan is of a program whose {stage} has version {then}, and this one has version {now}: give all tasks one \
             release, or plan anew with this one (convoy run --stages plan)"
        ))),
        _ => Ok(()),
    }
}

/// Seconds of one core of all stages.
fn sum_s(stages: &BTreeMap<&'static str, Work>) -> f64 {
    stages.values().map(|work| work.core_s).sum()
}

/// The scenes of a share, and the work of all scenes.
///
/// # Errors
/// The plan's tables cannot be read.
pub(crate) fn share(
    store: &Store,
    plan: &Manifest,
    editions: &Editions,
    shard: Shard,
) -> Result<(Vec<u32>, PlannedWork), StageError> {
    let costs = Costs::read(store, plan, editions)?;
    let work_s = costs.iter().map(|(scene, stages)| (*scene, sum_s(stages))).collect();
    Ok((shares::scenes_of(&work_s, shard), costs))
}
