//! The planning stage: reads maps, plans scenes, keeps everything a store needs to be complete by itself.

mod error;
mod maps;
mod models;
mod trajectories;
mod trajectory_file;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use catalogue::Catalogue;
use packs::PackModel;
use plan::{Plan, PlanError, PlanMap, PlanSources, Roster, SceneSlot};
use runner::forecast::{self, Machine, Planned};
use runner::{At, Job, Outlook, Place, Stage, StageError};
use schema::table::{Column, Row};
use schema::tables::{
    PlanAgentRow, PlanHazardRow, PlanModelRow, PlanRouteRow, PlanSceneRow, PlanTrajectoryRow, PlanWeatherRow,
};
use settings::stages::PlanSettings;
use settings::{Suspicion, map_name};
use store::{SceneKind, Scope, Store, StoreError, keys};

use crate::error::RosterError;
use crate::maps::MapSource;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<PlanSettings> = Stage {
    run,
    sources: |settings, folder| {
        let mut all = maps::digests(settings, folder);
        all.extend(models::digests(settings, folder));
        all.extend(trajectories::digests(settings, folder));
        all
    },
    // Plans without writing.
    sections: Some(|outlook| {
        let Made { plan, models, .. } = made(outlook)?;
        sections(outlook.store, plan, models)
    }),
    // Plans without writing, and says what that would come to.
    forecast: Some(|outlook| {
        let Made { roster, plan, .. } = made(outlook)?;
        let planned = Planned { scenes: &plan.scenes, agents: &plan.agents };
        Ok(forecast::lines(&outlook.editions.with_scenes(kinds(roster)), &planned, Machine::measured()))
    }),
    suspicions: Some(suspicions),
    open: None,
};
/// Its name.
const NAME: &str = Stage::<PlanSettings>::NAME;

/// A plan and the maps it stands on.
struct Made {
    roster: Roster,
    texts: BTreeMap<String, MapSource>,
    maps: BTreeMap<String, PlanMap>,
    models: Vec<PackModel>,
    plan: Plan,
}

/// The plan that would be made.
fn made<'a>(outlook: &Outlook<'a, PlanSettings>) -> Result<&'a Made, StageError> {
    let Outlook { settings, maps, store, prepared, .. } = *outlook;
    prepared.get_or_make(|| make(settings, maps, store))
}

fn make(as_written: &PlanSettings, folder: Option<&Path>, store: &Store) -> Result<Made, StageError> {
    let mut settings = as_written.clone();
    settings.change_all(&|settings| {
        for wish in &mut settings.scenes {
            wish.map = map_name(&wish.map).to_owned();
        }
        for start in &mut settings.agents.starts {
            start.map = map_name(&start.map).to_owned();
        }
        for rsu in &mut settings.agents.rsus_at {
            rsu.map = map_name(&rsu.map).to_owned();
        }
        for route in &mut settings.agents.routes {
            route.map = map_name(&route.map).to_owned();
        }
    });
    let roster = enrol(store, &settings)?;
    let texts = maps::texts(as_written, &roster.slots, folder, store)?;
    let mut maps = BTreeMap::new();
    for (name, source) in &texts {
        let hash = store::hash_bytes(&source.text);
        maps.insert(name.clone(), PlanMap { map: maps::parse(source)?, hash });
    }
    let models = models::read(&settings, folder)?;
    let rows: Vec<PlanModelRow> = models.iter().map(|model| model.row.clone()).collect();
    let tracks = trajectories::read(&settings, folder)?;
    let sources = PlanSources { catalogue: &Catalogue::with(&rows), tracks: &tracks };
    let plan = plan::plan_slots(&settings, &roster.slots, &maps, &sources).map_err(refused)?;
    Ok(Made { roster, texts, maps, models, plan })
}

/// What a user gave and nobody can follow is a wrong argument.
fn refused(error: PlanError) -> StageError {
    match error {
        PlanError::Trajectory { .. }
        | PlanError::Route { .. }
        | PlanError::NotFirst { .. }
        | PlanError::TwoWays { .. } => StageError::usage(error),
        other => match Err::<(), _>(other).at(Place::default) {
            Err(error) => error,
            Ok(()) => StageError::Stopped,
        },
    }
}

/// What the plan cannot give as it is wished for, and what is odd in it.
fn suspicions(outlook: &Outlook<'_, PlanSettings>) -> Result<Vec<Suspicion>, StageError> {
    let Made { roster, maps, plan, .. } = made(outlook)?;
    let editions = outlook.editions.with_scenes(kinds(roster));
    let said = |key: &str, message: String| Suspicion { key: key.to_owned(), message };
    let of_scenes = roster.warnings.iter().map(|warning| said("scenes", warning.clone()));
    let unlit = plan::suspicions::without_lights(&outlook.settings.agents, maps);
    let scenario_of = |scene| &editions.of(Scope::Scene(scene)).scenario;
    let unfelt = plan::suspicions::unfelt_weather(&scenario_of, plan);
    let of_agents = plan.warnings.iter().map(|warning| said("agents", warning.clone()));
    Ok(of_scenes.chain(unlit).chain(of_agents).chain(unfelt).collect())
}

/// The kind of each scene of a roster.
fn kinds(roster: &Roster) -> BTreeMap<u32, SceneKind> {
    let kind = |slot: &SceneSlot| SceneKind { edition: slot.edition, group: slot.group.clone() };
    roster.slots.iter().map(|slot| (slot.scene, kind(slot))).collect()
}

fn run(job: &mut Job<'_, PlanSettings>) -> Result<(), StageError> {
    let make = || make(job.settings(), job.maps_folder(), job.store());
    let Made { roster, texts, maps, models, plan } = job.prepared().get_or_make(make)?;
    let rows: Vec<PlanModelRow> = models.iter().map(|model| model.row.clone()).collect();
    for (scene, digest) in sections(job.store(), plan, models)? {
        job.plan_scene(scene, digest);
    }
    let store = job.store().clone();
    if let Some(mut unit) = job.unit("plan")? {
        store::probe(&store)?;
        for (name, source) in texts {
            let key = keys::map(name);
            let packed = replay::maps::pack(&source.text)
                .map_err(|e| StoreError::write(store.location(&key), "compress", e))?;
            unit.bytes(&key, &packed, 1)?;
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
        if !plan.weather.is_empty() {
            unit.rows(keys::PLAN_WEATHER, &plan.weather)?;
        }
        if !plan.routes.is_empty() {
            unit.rows(keys::PLAN_ROUTES, &plan.routes)?;
        }
        if !plan.trajectories.is_empty() {
            unit.rows(keys::PLAN_TRAJECTORIES, &plan.trajectories)?;
        }
        if !models.is_empty() {
            unit.rows(keys::PLAN_MODELS, &rows)?;
            models::put(models, &mut unit)?;
        }
        unit.finish()?;
    }
    Ok(())
}

/// Digests of all scenes of a plan. A scene whose rows are those of the plan before keeps its digest,
/// whatever the release that gave it: what was made of it is not stale.
fn sections(store: &Store, plan: &Plan, models: &[PackModel]) -> Result<BTreeMap<u32, String>, StageError> {
    let rows: Vec<PlanModelRow> = models.iter().map(|model| model.row.clone()).collect();
    let before = before(store);
    let digest = |scene: &PlanSceneRow| {
        let digest = scene_digest(scene, plan, &rows)?;
        let kept = before.get(&scene.scene).filter(|(rows, _)| *rows == digest);
        Ok((scene.scene, kept.map_or(digest.clone(), |(_, kept)| kept.clone())))
    };
    plan.scenes.iter().map(digest).collect()
}

/// Of each scene of the plan before the digest of its rows, and the digest that the store has; nothing where
/// there is no such plan, or it cannot be read.
fn before(store: &Store) -> BTreeMap<u32, (String, String)> {
    let read = || -> Result<BTreeMap<u32, (String, String)>, StageError> {
        let Some(manifest) = store.manifest(Scope::Plan, NAME)? else { return Ok(BTreeMap::new()) };
        let plan = Plan {
            scenes: store.read_rows(&manifest, keys::PLAN_SCENES)?,
            agents: store.read_rows(&manifest, keys::PLAN_AGENTS)?,
            hazards: store.read_rows(&manifest, keys::PLAN_HAZARDS)?,
            weather: store.read_optional_rows(&manifest, keys::PLAN_WEATHER)?,
            routes: store.read_optional_rows(&manifest, keys::PLAN_ROUTES)?,
            trajectories: store.read_optional_rows(&manifest, keys::PLAN_TRAJECTORIES)?,
            ..Plan::default()
        };
        let models: Vec<PlanModelRow> = store.read_optional_rows(&manifest, keys::PLAN_MODELS)?;
        let mut found = BTreeMap::new();
        for scene in &plan.scenes {
            let Some(kept) = manifest.sections.get(&format!("scene/{:04}", scene.scene)) else { continue };
            found.insert(scene.scene, (scene_digest(scene, &plan, &models)?, kept.clone()));
        }
        Ok(found)
    };
    read().unwrap_or_default()
}

/// Numbers for the scenes of the settings: those of an earlier plan of this store stand.
fn enrol(store: &Store, settings: &PlanSettings) -> Result<Roster, StageError> {
    let existing: Vec<SceneSlot> = store.read_json(keys::ROSTER)?.unwrap_or_default();
    let unreadable = RefCell::new(None);
    let is_made = |scene| match store.backend().keys(&Scope::Scene(scene).folder()) {
        // The record of a failure is nothing to keep.
        Ok(files) => files.iter().any(|key| !key.ends_with(".failed.json")),
        Err(error) => {
            unreadable.replace(Some(error));
            true
        }
    };
    let roster = plan::enrol(settings, &existing, &is_made).at(Place::default)?;
    if let Some(error) = unreadable.into_inner() {
        return Err(error.into());
    }
    let newest = settings.edition();
    if newest > 0 && roster.slots.iter().all(|slot| slot.edition != newest) {
        return Err(StageError::usage(RosterError::NothingToGrow { scenes: roster.slots.len() }));
    }
    Ok(roster)
}

/// Weather counts as numbers in a row, as plans of format 1 have it: their scenes are still the same.
fn flatten_weather(column: &mut Column) {
    let Column::Struct(fields) = column else { return };
    let numbers: Vec<&Vec<f64>> = fields
        .iter()
        .filter_map(|(_, field)| if let Column::F64(numbers) = field { Some(numbers) } else { None })
        .collect();
    let rows = numbers.first().map_or(0, |first| first.len());
    let flat = (0..rows).flat_map(|row| numbers.iter().map(move |field| field[row])).collect();
    *column = Column::FixedF64(numbers.len(), flat);
}

/// Digest of everything the plan says about one scene: the simulation of a scene depends on nothing else of
/// it.
fn scene_digest(scene: &PlanSceneRow, plan: &Plan, models: &[PlanModelRow]) -> Result<String, StageError> {
    let number = scene.scene;
    let agents: Vec<PlanAgentRow> = plan.agents.iter().filter(|a| a.scene == number).cloned().collect();
    let hazards: Vec<PlanHazardRow> = plan.hazards.iter().filter(|h| h.scene == number).cloned().collect();
    let weather: Vec<PlanWeatherRow> = plan.weather.iter().filter(|w| w.scene == number).cloned().collect();
    let mut all = vec![
        PlanSceneRow::to_columns(std::slice::from_ref(scene)),
        PlanAgentRow::to_columns(&agents),
        PlanHazardRow::to_columns(&hazards),
        // Any of them may drive or stand in any scene.
        PlanModelRow::to_columns(models),
    ];
    if !weather.is_empty() {
        all.push(PlanWeatherRow::to_columns(&weather));
    }
    let routes: Vec<PlanRouteRow> = plan.routes.iter().filter(|r| r.scene == number).cloned().collect();
    if !routes.is_empty() {
        all.push(PlanRouteRow::to_columns(&routes));
    }
    // They may be many, and come by scene.
    let first = plan.trajectories.partition_point(|row| row.scene < number);
    let end = plan.trajectories.partition_point(|row| row.scene <= number);
    if first < end {
        all.push(PlanTrajectoryRow::to_columns(&plan.trajectories[first..end]));
    }
    all.iter_mut().flatten().for_each(flatten_weather);
    // Numbers are the shortest text that reads back the same.
    Ok(store::hash_bytes(&serde_json::to_vec(&all).at(Place::default)?))
}
