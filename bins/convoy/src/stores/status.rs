//! The table of scenes and stages.

use std::path::Path;
use std::time::Duration;

use runner::{
    EXIT_USAGE, EditionWish, Editions, Foresight, Graph, Programs, Remembered, SceneList, StageError,
    StageSpec, State, StateError, Status, Suspicious, UnitKind, say, settings_or_faults,
};
use settings::DatasetSettings;
use store::{SceneKind, Scope, Store};

use super::progress;
use super::replanning::Replanning;

/// What is told of a store.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Told<'a> {
    /// A table of scenes and stages, of some scenes or of all, and what the next run would do.
    Table(Option<&'a SceneList>),
    /// All of it as JSON.
    Json,
    /// Counts and failures, again and again.
    Watched(Duration),
}

/// Tells how a store stands by a configuration with its place among the editions; without one by the newest
/// that the store was planned by. The exit code is 0 where all is done.
pub(crate) fn status(
    (config, rule): (Option<&Path>, Suspicious),
    (path, wish): (&Path, EditionWish),
    told: Told<'_>,
    (programs, replanning): (&Programs, Option<&Replanning>),
) -> u8 {
    let given = match config.map(|config| settings_or_faults(config, rule)) {
        Some(None) => return EXIT_USAGE,
        Some(Some(settings)) => Some(settings),
        None => None,
    };
    let all = || -> Result<u8, StageError> {
        let (store, editions) = opened(given, path, wish)?;
        let status = || match &editions {
            Some(editions) => Status::new(&store, editions, programs),
            None => Status::of_import(&store, programs),
        };
        match told {
            Told::Json => progress::tell_json(&status()).map(progress::code),
            Told::Watched(every) => progress::watch(status, every),
            Told::Table(only) => table(&status(), editions.as_ref(), only, replanning).map(progress::code),
        }
    };
    all().unwrap_or_else(|e| {
        tracing::error!("{}", e.report());
        e.exit_code()
    })
}

/// Prints the table, and what the next run would do; whether all is done.
fn table(
    status: &Status<'_>,
    editions: Option<&Editions>,
    only: Option<&SceneList>,
    replanning: Option<&Replanning>,
) -> Result<bool, StageError> {
    let (all_done, foresight) = status_table(status, editions, only)?;
    let is_planned = status.state(Graph::get().planner(), Scope::Plan)? == State::Done;
    // What another plan would be, the planner knows; of a store without scenes nothing is made again.
    if let Some(replanning) = replanning.filter(|replanning| replanning.is_wanted(is_planned))
        && store::has_scenes(status.store())?
        && let Some((lines, is_kept)) = replanning.lines()
    {
        lines.iter().for_each(|line| say(line));
        return Ok(all_done && is_kept);
    }
    for (_, line) in foresight.lines() {
        say(&format!("the next run makes again {line}"));
    }
    foresight.changed().iter().for_each(|line| say(line));
    Ok(all_done)
}

/// A store, and its editions with a configuration in its place; without one, the newest that the store was
/// planned by. An import has no editions.
pub(super) fn opened(
    given: Option<DatasetSettings>,
    path: &Path,
    wish: EditionWish,
) -> Result<(Store, Option<Editions>), StageError> {
    let store = if given.is_some() { Store::open(path)? } else { Store::open_made(path)? };
    let settings = match given {
        Some(settings) => settings,
        None if is_imported(&store)? => return Ok((store, None)),
        None => runner::newest_recorded(&store)?,
    };
    let editions = Editions::of_store(&store, &settings, wish)?;
    Ok((store, Some(editions)))
}

/// Whether a store was imported from another layout.
pub(super) fn is_imported(store: &Store) -> Result<bool, store::StoreError> {
    match store.manifest(Scope::Plan, Graph::get().planner().name) {
        // What it was cannot be told; that it is damaged is told elsewhere.
        Err(store::StoreError::Corrupt { .. }) => Ok(false),
        plan => Ok(plan?.is_some_and(|plan| schema::is_imported(&plan.code_version))),
    }
}

/// Prints the table; whether all is done, and what the next run would make again.
fn status_table(
    status: &Status<'_>,
    editions: Option<&Editions>,
    only: Option<&SceneList>,
) -> Result<(bool, Foresight), StateError> {
    let of_unit = |unit| Graph::get().stages.iter().filter(move |stage| stage.unit == unit);
    let mut table = Table { all_done: true, reasons: Vec::new() };
    for stage in of_unit(UnitKind::Plan) {
        let state = status.state(stage, Scope::Plan)?;
        say(&format!("{}: {}", stage.name, table.word("plan", stage, &state)));
    }
    let per_scene: Vec<&StageSpec> = of_unit(UnitKind::Scene).collect();
    let header: Vec<String> = per_scene.iter().map(|s| format!("{:>17}", s.name)).collect();
    let several = |editions: &&Editions| editions.all().len() > 1 || !editions.newest().groups.is_empty();
    let editions = editions.filter(several);
    let kinds = if editions.is_some() { "  edition and group" } else { "" };
    say(&format!("scene {}{kinds}", header.join(" ")));
    let overview = runner::overview(status, &mut Remembered::default(), |scene, states| {
        if only.is_some_and(|list| !list.contains(scene)) {
            return;
        }
        let name = format!("{scene:04} ");
        let mut line = name.clone();
        for (stage, state) in per_scene.iter().zip(states) {
            line.push_str(&format!(" {:>17}", table.word(&name, stage, state)));
        }
        if let Some(editions) = editions {
            let SceneKind { edition, group } = editions.kind_of(scene);
            line.push_str(&format!("  {edition} {group}"));
        }
        say(&line);
    })?;
    for (stage, state) in &overview.stats {
        say(&format!("{}: {}", stage.name, table.word("stats", stage, state)));
    }
    table.reasons.iter().for_each(|reason| say(reason));
    Ok((table.all_done, overview.foresight))
}

/// What the table of states has told so far.
struct Table {
    all_done: bool,
    /// Why stages are stale or failed, told below the table.
    reasons: Vec<String>,
}

impl Table {
    /// The state of a stage of something as the table has it.
    fn word(&mut self, name: &str, stage: &StageSpec, state: &State) -> &'static str {
        self.all_done &= *state == State::Done;
        match state {
            State::Done => "done",
            State::Missing => "missing",
            State::Stale(why) => {
                self.reasons.push(format!("{name} {}: stale: {why}", stage.name));
                "stale"
            }
            State::Failed(why) => {
                self.reasons.push(format!("{name} {}: failed: {why}", stage.name));
                "failed"
            }
        }
    }
}
