//! Why a stage of a scene is in the state that it is in.

use std::path::Path;

use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_USAGE, EditionWish, Graph, Programs, StageError, State, Status,
    Suspicious, UnitKind, planned_scenes, say, settings_or_faults,
};
use store::{Scope, Store};

use super::status::opened;

/// Prints the chain of a stage of a scene; the exit code is 0 where it is done. Without a configuration it is
/// told by the newest that the store was planned by.
pub(crate) fn why(
    config: Option<&Path>,
    (store, wish): (&Path, EditionWish),
    asked: (&str, &str),
    programs: &Programs,
) -> u8 {
    let settings = match config.map(|config| settings_or_faults(config, Suspicious::Unsaid)) {
        Some(None) => return EXIT_USAGE,
        Some(settings) => settings,
        None => None,
    };
    let told = move || -> Result<bool, StageError> {
        let (store, editions) = opened(settings, store, wish)?;
        let editions = editions.as_ref();
        let (stage, scene) = (stage_of(asked.1)?, scene_of(&store, asked.0)?);
        let scope = match stage.unit {
            UnitKind::Plan => Scope::Plan,
            UnitKind::Scene => Scope::Scene(scene),
            UnitKind::Stats => Scope::Stats,
        };
        if stage.unit == UnitKind::Scene {
            say(&format!("scene {scene:04}"));
        }
        runner::why(&store, editions, programs, (stage, scope))?.iter().for_each(|line| say(line));
        let status = match editions {
            Some(editions) => Status::new(&store, editions, programs),
            None => Status::of_import(&store, programs),
        };
        Ok(status.state(stage, scope)? == State::Done)
    };
    match told() {
        Ok(true) => EXIT_DONE,
        Ok(false) => EXIT_SOME_FAILED,
        Err(e) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
    }
}

fn stage_of(name: &str) -> Result<&'static runner::StageSpec, StageError> {
    Graph::get().stage(name).ok_or_else(|| {
        let names: Vec<&str> = Graph::get().stages.iter().map(|stage| stage.name).collect();
        StageError::usage(format!("--why: there is no stage `{name}`; there are {}", names.join(", ")))
    })
}

fn scene_of(store: &Store, text: &str) -> Result<u32, StageError> {
    let scene = text.parse();
    let scene = scene.map_err(|_| StageError::usage(format!("--why: `{text}` is no number of a scene")))?;
    let planned = planned_scenes(store)?;
    match planned.as_ref().map(|planned| (planned.contains(&scene), planned.last())) {
        Some((false, last)) => {
            let last = last.copied().unwrap_or(0);
            Err(StageError::usage(format!("--why: no scene {scene} in the plan (it has 0 to {last})")))
        }
        // Without a plan the chain ends at that.
        _ => Ok(scene),
    }
}
