//! The planning stage: reads maps, plans scenes, keeps everything a store needs to be complete by itself.

mod error;
mod maps;
mod models;

use std::collections::BTreeMap;
use std::path::Path;

use catalogue::Catalogue;
use packs::PackModel;
use plan::{Plan, PlanMap, Roster, SceneSlot};
use runner::{At, Job, Place, Stage, StageError, StageSettings};
use schema::table::Row;
use schema::tables::{PlanAgentRow, PlanHazardRow, PlanModelRow, PlanSceneRow};
use settings::stages::PlanSettings;
use store::{Scope, Store, keys};

use crate::maps::MapSource;

/// The stage.
pub const STAGE: Stage<PlanSettings> = Stage {
    run,
    sources: |settings, folder| {
        let mut all = maps::digests(settings, folder);
        all.extend(models::digests(settings, folder));
        all
    },
    // Plans without writing, and says what that would come to.
    forecast: Some(|all, folder, store| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Ok(plan::forecast::lines(all, &make(&PlanSettings::of(all), folder, store)?.plan, cores))
    }),
};
/// Its name.
const NAME: &str = Stage::<PlanSettings>::NAME;

/// A plan and the maps it stands on.
struct Planned {
    roster: Roster,
    texts: BTreeMap<String, MapSource>,
    maps: BTreeMap<String, PlanMap>,
    models: Vec<PackModel>,
    plan: Plan,
}

fn make(as_written: &PlanSettings, folder: Option<&Path>, store: &Store) -> Result<Planned, StageError> {
    let mut settings = as_written.clone();
    for wish in &mut settings.scenes {
        wish.map = maps::name_in_store(&wish.map).to_owned();
    }
    for start in &mut settings.agents.starts {
        start.map = maps::name_in_store(&start.map).to_owned();
    }
    let roster = enrol(store, &settings)?;
    let texts = maps::texts(as_written, &roster.slots, folder, store)?;
    let mut maps = BTreeMap::new();
    for (name, source) in &texts {
        let hash = store::hash_bytes(&source.text);
        maps.insert(name.clone(), PlanMap { map: maps::parse(source)?, hash });
    }
    let models = models::read(&settings, folder)?;
    let rows: Vec<PlanModelRow> = models.iter().map(|model| model.row.clone()).collect();
    let plan =
        plan::plan_slots(&settings, &roster.slots, &maps, &Catalogue::with(&rows)).at(Place::default)?;
    for warning in roster.warnings.iter().chain(&plan.warnings) {
        tracing::warn!("{warning}");
    }
    Ok(Planned { roster, texts, maps, models, plan })
}

fn run(job: &mut Job<'_, PlanSettings>) -> Result<(), StageError> {
    let as_written = job.settings().clone();
    let Planned { roster, texts, maps, models, plan } = make(&as_written, job.maps_folder(), job.store())?;
    let rows: Vec<PlanModelRow> = models.iter().map(|model| model.row.clone()).collect();
    for scene in &plan.scenes {
        job.plan_scene(scene.scene, scene_digest(scene, &plan, &rows));
    }
    let store = job.store().clone();
    if let Some(mut unit) = job.unit("plan")? {
        // Before the old plan is touched, so that a run that is killed here gives the same numbers next time.
        store.write_json(keys::ROSTER, NAME, &roster.slots)?;
        for (name, source) in &texts {
            unit.bytes(&keys::map(name), &replay::maps::pack(&source.text).at(Place::default)?, 1)?;
            if let Some(own) = maps.get(name) {
                unit.rows(&keys::vector_map(name), &labels::vector_map::rows(&own.map))?;
            }
        }
        let mut json = serde_json::to_vec_pretty(&roster.slots).at(Place::default)?;
        json.push(b'\n');
        unit.bytes(keys::ROSTER, &json, roster.slots.len() as u64)?;
        unit.rows(keys::PLAN_SCENES, &plan.scenes)?;
        unit.rows(keys::PLAN_AGENTS, &plan.agents)?;
        unit.rows(keys::PLAN_HAZARDS, &plan.hazards)?;
        if !models.is_empty() {
            unit.rows(keys::PLAN_MODELS, &rows)?;
            models::put(&models, &mut unit)?;
        }
        unit.finish()?;
    }
    Ok(())
}

/// Numbers for the scenes of the settings: those of an earlier plan of this store stand.
fn enrol(store: &Store, settings: &PlanSettings) -> Result<Roster, StageError> {
    let existing: Vec<SceneSlot> = store.read_json(keys::ROSTER)?.unwrap_or_default();
    let mut made = Vec::new();
    for slot in &existing {
        // The record of a failure is nothing to keep.
        let files = store.backend().list(&Scope::Scene(slot.scene).folder())?;
        if files.iter().any(|key| !key.ends_with(".failed.json")) {
            made.push(slot.scene);
        }
    }
    plan::enrol(settings, &existing, &|scene| made.contains(&scene)).at(Place::default)
}

/// Digest of everything the plan says about one scene: the simulation of a scene depends on nothing else of
/// it.
fn scene_digest(scene: &PlanSceneRow, plan: &Plan, models: &[PlanModelRow]) -> String {
    let number = scene.scene;
    let agents: Vec<PlanAgentRow> = plan.agents.iter().filter(|a| a.scene == number).cloned().collect();
    let hazards: Vec<PlanHazardRow> = plan.hazards.iter().filter(|h| h.scene == number).cloned().collect();
    let scene = PlanSceneRow::to_columns(std::slice::from_ref(scene));
    // Debug prints every bit of every number that matters: shortest text that reads back the same.
    let (agents, hazards) = (PlanAgentRow::to_columns(&agents), PlanHazardRow::to_columns(&hazards));
    let mut all = format!("{scene:?}\n{agents:?}\n{hazards:?}");
    if !models.is_empty() {
        // Any of them may drive or stand in any scene.
        all.push_str(&format!("\n{:?}", PlanModelRow::to_columns(models)));
    }
    store::hash_bytes(all.as_bytes())
}
