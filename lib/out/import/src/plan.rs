//! The plan of an imported store, written last: before, no reader takes the folder for a store.

use std::collections::BTreeMap;

use schema::table::Row;
use schema::tables::{PlanAgentRow, PlanHazardRow, PlanSceneRow};
use schema::{FORMAT_VERSION, IMPORTED};
use store::{Attempt, Identity, MadeBy, Manifest, Scope, Store, keys};

use crate::error::ImportError;
use crate::settings::settings;
use crate::survey::{SceneSurvey, Source};

/// Begins the names of scenes among the digests of a plan.
const SECTION: &str = "scene/";

/// Numbers of the scenes of a plan.
pub(crate) fn scenes_of(plan: &Manifest) -> Vec<u32> {
    plan.sections.keys().filter_map(|name| name.strip_prefix(SECTION)?.parse().ok()).collect()
}

/// Writes the plan of some scenes where another one stands, or none.
pub(crate) fn write(
    store: &Store,
    (source, name, made_by): (&Source, &str, Option<&MadeBy>),
    surveys: &[&SceneSurvey],
    old: Option<&Manifest>,
) -> Result<(), ImportError> {
    let digest = source.digest();
    let sections: BTreeMap<String, String> =
        surveys.iter().map(|s| (format!("{SECTION}{:04}", s.number), s.digest.clone())).collect();
    if let Some(old) = old
        && old.sections == sections
        && old.config_hash == digest
        && store.outputs_present(old)?
    {
        Attempt::tidy(store, Scope::Plan, PlanSceneRow::STAGE)?;
        return Ok(());
    }
    let identity = Identity {
        stage: PlanSceneRow::STAGE.to_owned(),
        scope: Scope::Plan,
        code_version: IMPORTED.to_owned(),
        config_hash: digest,
        inputs: BTreeMap::new(),
        made_by: made_by.cloned(),
    };
    let mut attempt = Attempt::start(store, identity, false)?;
    for (section, digest) in sections {
        attempt.section(&section, digest);
    }
    if let Some(mut unit) = attempt.unit("plan")? {
        let scenes: Vec<PlanSceneRow> = surveys.iter().map(|survey| survey.plan.clone()).collect();
        let agents: Vec<PlanAgentRow> =
            surveys.iter().flat_map(|survey| survey.plan_agents.clone()).collect();
        unit.rows(keys::PLAN_SCENES, &scenes)?;
        unit.rows(keys::PLAN_AGENTS, &agents)?;
        unit.rows::<PlanHazardRow>(keys::PLAN_HAZARDS, &[])?;
        let record = serde_json::json!({
            "format_version": FORMAT_VERSION,
            "code_version": IMPORTED,
            "config": settings(name, &source.rigs, surveys),
        });
        let text = serde_json::to_vec_pretty(&record).unwrap_or_default();
        unit.bytes(keys::DATASET, &text, 1)?;
        unit.finish()?;
    }
    attempt.commit()?;
    Ok(())
}
