//! Every shard of a store hashed again.

use std::collections::BTreeSet;
use std::path::Path;

use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, Graph, SceneList, StageError, StageSpec, UnitKind, planned_scenes, say,
};
use schema::table::Row;
use schema::tables::ValidBoxRow;
use store::{Finding, Problem, Scope, Store};

use super::status::is_imported;
use crate::words::quoted;

/// Every stage of every scene of the plan.
fn all_stages(store: &Store) -> Result<Vec<(Scope, &'static StageSpec)>, store::StoreError> {
    let scenes = planned_scenes(store)?.unwrap_or_default();
    let scopes = |unit| match unit {
        UnitKind::Plan => vec![Scope::Plan],
        UnitKind::Stats => vec![Scope::Stats],
        UnitKind::Scene => scenes.iter().copied().map(Scope::Scene).collect(),
    };
    let of_stage =
        |stage: &'static StageSpec| scopes(stage.unit).into_iter().map(move |scope| (scope, stage));
    Ok(Graph::get().stages.iter().flat_map(of_stage).collect())
}

/// Whether a stage is made of an import later, if at all. Files of it without a manifest are found all the
/// same.
fn may_follow_an_import(stage: &StageSpec) -> bool {
    !stage.needs_log || stage.name == ValidBoxRow::STAGE
}

/// Commands that make again what manifests name and what is missing or damaged, in the stages' order.
fn cures(place: &Path, stages: &[(Scope, &str)], findings: &[Finding]) -> Vec<String> {
    let is_of_shard =
        |problem: &Problem| matches!(problem, Problem::Missing | Problem::Size { .. } | Problem::Changed);
    let of_shards = findings.iter().filter(|finding| is_of_shard(&finding.problem));
    let manifests: BTreeSet<&str> = of_shards.filter_map(|finding| finding.manifest.as_deref()).collect();
    let is_faulty = |scope: &Scope, stage: &str| manifests.contains(&*scope.manifest(stage));
    let place = quoted(place);
    let of_stage = |stage: &StageSpec| {
        let of_it = stages.iter().filter(|(scope, name)| *name == stage.name && is_faulty(scope, name));
        let scopes: Vec<Scope> = of_it.map(|(scope, _)| *scope).collect();
        let scenes: Vec<u32> = scopes
            .iter()
            .filter_map(|scope| if let Scope::Scene(scene) = scope { Some(*scene) } else { None })
            .collect();
        let which = match stage.unit {
            UnitKind::Scene => format!(" --scenes {}", SceneList::of(&scenes)),
            UnitKind::Plan => " --config FILE".to_owned(),
            UnitKind::Stats => String::new(),
        };
        let name = stage.name;
        (!scopes.is_empty()).then(|| format!("convoy run --stages {name}{which} --force --store {place}"))
    };
    Graph::get().stages.iter().filter_map(of_stage).collect()
}

/// Names every missing, truncated or changed shard; the exit code is 0 where there is none.
pub(crate) fn verify(place: &Path) -> u8 {
    let verified = Store::open_made(place).and_then(|store| {
        let is_import = is_imported(&store)?;
        let (later, expected): (Vec<_>, Vec<_>) =
            all_stages(&store)?.into_iter().partition(|(_, stage)| is_import && may_follow_an_import(stage));
        let expected: Vec<(Scope, &str)> =
            expected.into_iter().map(|(scope, stage)| (scope, stage.name)).collect();
        let mut unmade = Vec::new();
        for (scope, stage) in later {
            if store.read(&scope.manifest(stage.name))?.is_none() {
                unmade.push((scope, stage.name));
            }
        }
        let result = store::verify(&store, &expected, |_| {})?;
        let cures = cures(place, &expected, &result.findings);
        Ok((result, cures, unmade, store.backend().lists_unfinished()))
    });
    let (result, cures, unmade, lists_unfinished) = match verified.map_err(StageError::from) {
        Ok(result) => result,
        Err(e) => {
            tracing::error!("{}", e.report());
            return e.exit_code();
        }
    };
    for finding in &result.findings {
        say(&finding.to_string());
    }
    for cure in cures {
        say(&format!("to make it again: {cure}"));
    }
    let in_hand = result.in_hand.iter().map(|key| format!("{key}: of a run that is going on or was stopped"));
    let unfinished = result.unfinished.iter().map(|file| {
        let whose = if file.abandoned { "left by a run that was killed" } else { "being written" };
        format!("{}: {whose} ({})", file.location, file.owner)
    });
    for note in in_hand.chain(unfinished) {
        say(&format!("note: {note}"));
    }
    if !lists_unfinished {
        say("note: what killed runs began to upload cannot be listed here; let a rule of the bucket end it");
    }
    for (scope, stage) in unmade {
        let key = scope.manifest(stage);
        say(&format!("note: {key}: {stage} has not been made of this import"));
    }
    let megabytes = result.bytes as f64 / 1e6;
    let (manifests, shards, faulty) = (result.manifests, result.shards, result.findings.len());
    say(&format!("{manifests} manifests, {shards} shards, {megabytes:.1} MB: {faulty} faulty"));
    if result.findings.is_empty() { EXIT_DONE } else { EXIT_SOME_FAILED }
}
