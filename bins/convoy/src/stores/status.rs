//! The table of scenes and stages.

use std::path::Path;

use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_USAGE, EditionWish, Editions, Foresight, Graph, Programs, SceneList,
    StageError, StageSpec, State, StateError, Status, Suspicious, UnitKind, planned_scenes, say,
    settings_or_faults,
};
use store::{SceneKind, Scope, Store};

use super::replanning::Replanning;

/// Prints the table of a store as a configuration with its place among the editions has it. The exit code is
/// 0 where all is done.
pub(crate) fn status(
    (config, rule): (&Path, Suspicious),
    (store, wish): (&Path, EditionWish),
    only: Option<&SceneList>,
    (programs, replanning): (&Programs, &Replanning),
) -> u8 {
    let Some(settings) = settings_or_faults(config, rule) else { return EXIT_USAGE };
    let told = Store::open(store).map_err(StageError::from).and_then(|store| {
        let editions = Editions::of_store(&store, &settings, wish)?;
        let all_done = status_table(Status::new(&store, &editions, programs), Some(&editions), &store, only)?;
        let planner = Graph::get().planner();
        let is_planned = Status::new(&store, &editions, programs).state(planner, Scope::Plan)? == State::Done;
        // What another plan would be, the planner knows; of a store without scenes nothing is made again.
        if replanning.is_wanted(is_planned)
            && !store.backend().list("scenes")?.is_empty()
            && let Some((lines, is_kept)) = replanning.lines()
        {
            lines.iter().for_each(|line| say(line));
            return Ok(all_done && is_kept);
        }
        let foresight = Foresight::of_plan(&store, &editions, programs)?;
        for (_, line) in foresight.lines() {
            say(&format!("the next run makes again {line}"));
        }
        foresight.changed().for_each(|line| say(&line));
        Ok(all_done)
    });
    status_code(told)
}

fn status_code(told: Result<bool, StageError>) -> u8 {
    match told {
        Ok(true) => EXIT_DONE,
        Ok(false) => EXIT_SOME_FAILED,
        Err(e) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
    }
}

/// The table without a configuration, which stores of imports do not have.
pub(crate) fn status_of_import(path: &Path, only: Option<&SceneList>, programs: &Programs) -> u8 {
    let told = open_import(path)
        .and_then(|store| Ok(status_table(Status::of_import(&store, programs), None, &store, only)?));
    status_code(told)
}

/// Opens a store that was imported.
///
/// # Errors
/// There is none, or it was made here: then a configuration says what is stale.
pub(super) fn open_import(path: &Path) -> Result<Store, StageError> {
    let store = Store::open_made(path)?;
    if is_imported(&store)? {
        return Ok(store);
    }
    let place = path.display();
    Err(StageError::usage(format!(
        "{place}: was made here, not imported: what of it is stale is told by --config FILE"
    )))
}

/// Whether a store was imported from another layout.
pub(super) fn is_imported(store: &Store) -> Result<bool, store::StoreError> {
    match store.manifest(Scope::Plan, Graph::get().planner().name) {
        // What it was cannot be told; that it is damaged is told elsewhere.
        Err(store::StoreError::Corrupt { .. }) => Ok(false),
        plan => Ok(plan?.is_some_and(|plan| schema::is_imported(&plan.code_version))),
    }
}

fn status_table(
    status: Status<'_>,
    editions: Option<&Editions>,
    store: &Store,
    only: Option<&SceneList>,
) -> Result<bool, StateError> {
    let stages = &Graph::get().stages;
    let mut reasons = Vec::new();
    let mut all_done = true;
    let mut cell = |name: &str, stage: &StageSpec, scope: Scope| -> Result<&'static str, StateError> {
        let state = status.state(stage, scope)?;
        all_done &= state == State::Done;
        Ok(match state {
            State::Done => "done",
            State::Missing => "missing",
            State::Stale(why) => {
                reasons.push(format!("{name} {}: stale: {why}", stage.name));
                "stale"
            }
            State::Failed(why) => {
                reasons.push(format!("{name} {}: failed: {why}", stage.name));
                "failed"
            }
        })
    };
    for stage in stages.iter().filter(|s| s.unit == UnitKind::Plan) {
        say(&format!("{}: {}", stage.name, cell("plan", stage, Scope::Plan)?));
    }
    let per_scene: Vec<_> = stages.iter().filter(|s| s.unit == UnitKind::Scene).collect();
    let header: Vec<String> = per_scene.iter().map(|s| format!("{:>17}", s.name)).collect();
    let several = |editions: &&Editions| editions.all().len() > 1 || !editions.newest().groups.is_empty();
    let editions = editions.filter(several);
    let kinds = if editions.is_some() { "  edition and group" } else { "" };
    say(&format!("scene {}{kinds}", header.join(" ")));
    for scene in planned_scenes(store)?.unwrap_or_default() {
        if only.is_some_and(|list| !list.contains(scene)) {
            continue;
        }
        let name = format!("{scene:04} ");
        let mut line = name.clone();
        for stage in &per_scene {
            line.push_str(&format!(" {:>17}", cell(&name, stage, Scope::Scene(scene))?));
        }
        if let Some(editions) = editions {
            let SceneKind { edition, group } = editions.kind_of(scene);
            line.push_str(&format!("  {edition} {group}"));
        }
        say(&line);
    }
    for stage in stages.iter().filter(|s| s.unit == UnitKind::Stats) {
        say(&format!("{}: {}", stage.name, cell("stats", stage, Scope::Stats)?));
    }
    for reason in reasons {
        say(&reason);
    }
    Ok(all_done)
}
