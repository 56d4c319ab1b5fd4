//! A dataset into a store.

use std::collections::BTreeSet;

use rayon::prelude::*;
use schema::scene_info::LOG_STAGE;
use schema::table::Row;
use schema::tables::PlanSceneRow;
use schema::{IMPORTED, is_imported};
use store::{Failure, MadeBy, Manifest, Scope, Store};

use crate::error::ImportError;
use crate::plan;
use crate::scene_unit;
use crate::survey::{SceneSurvey, Source, Surveyed};
use crate::work::{Order, ProgressWatch};

/// What is to be imported.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Ranges of scene numbers, first and last; all scenes where there is none.
    pub scenes: Option<Vec<(u32, u32)>>,
    /// Import again what has been imported.
    pub force: bool,
    /// The build at work, a remark in the manifests.
    pub made_by: Option<MadeBy>,
}

impl Selection {
    fn has(&self, scene: u32) -> bool {
        self.scenes.as_ref().is_none_or(|ranges| ranges.iter().any(|&(a, b)| (a..=b).contains(&scene)))
    }
}

/// What an import would do.
#[derive(Debug)]
pub struct Prospect {
    /// The wanted scenes.
    pub scenes: Vec<SceneSurvey>,
    /// Those of them that are imported already.
    pub done: BTreeSet<u32>,
    /// Scenes whose infos are broken.
    pub failed: Vec<(u32, ImportError)>,
    /// Scenes of the store that are not wanted this time.
    others: Vec<SceneSurvey>,
    plan: Option<Manifest>,
}

impl Prospect {
    /// Agent-frames of what is to be done: one for an agent's sensors, and one for each archive of its
    /// arrays.
    #[must_use]
    pub fn agent_frames(&self) -> u64 {
        let of = |scene: &SceneSurvey| {
            let archives = |keys: &BTreeSet<String>| {
                let arrays = [crate::names::MASKS, crate::names::VOXELS, crate::names::FILLED_VOXELS];
                1 + arrays.iter().filter(|key| keys.contains(**key)).count() as u64
            };
            let parts: u64 = scene.agents.iter().map(|(_, keys)| archives(keys)).sum();
            parts * u64::from(scene.frames)
        };
        self.scenes.iter().filter(|scene| !self.done.contains(&scene.number)).map(of).sum()
    }
}

/// Finds out what an import would do.
///
/// # Errors
/// [`ImportError::Refused`]: the store holds something else, or scenes were named that the dataset has not.
pub fn prospect(source: &Source, store: &Store, selection: &Selection) -> Result<Prospect, ImportError> {
    check_selection(source, selection)?;
    let plan = store.manifest(Scope::Plan, PlanSceneRow::STAGE)?;
    let place = store.location("");
    if let Some(plan) = &plan {
        if !is_imported(&plan.code_version) {
            return Err(ImportError::Refused(format!(
                "{place}: holds a dataset that was made here, and what is imported cannot stand beside it: choose another folder"
            )));
        }
        if plan.config_hash != source.digest() {
            return Err(ImportError::Refused(format!(
                "{place}: holds the import of a dataset with other sensors: choose another folder"
            )));
        }
    }
    let known: BTreeSet<u32> = plan.as_ref().map(plan::scenes_of).unwrap_or_default().into_iter().collect();
    let surveyed: Vec<Surveyed> = source.survey(|scene| selection.has(scene) || known.contains(&scene));
    let mut found = Prospect { scenes: vec![], done: BTreeSet::new(), failed: vec![], others: vec![], plan };
    for (number, survey) in surveyed {
        match survey {
            Ok(survey) if selection.has(number) => {
                if is_done(store, &survey, selection)? {
                    found.done.insert(number);
                }
                found.scenes.push(survey);
            }
            Ok(survey) => found.others.push(survey),
            Err(error) => found.failed.push((number, error)),
        }
    }
    Ok(found)
}

fn check_selection(source: &Source, selection: &Selection) -> Result<(), ImportError> {
    let there: BTreeSet<u32> = source.scenes().collect();
    let named = selection.scenes.iter().flatten().flat_map(|(first, last)| [*first, *last]);
    let unknown: BTreeSet<u32> = named.filter(|scene| !there.contains(scene)).collect();
    if unknown.is_empty() {
        return Ok(());
    }
    let (root, unknown) = (source.root().display(), unknown.iter().map(u32::to_string).collect::<Vec<_>>());
    Err(ImportError::Refused(format!("--scenes: {root}: its infos have no scene {}", unknown.join(", "))))
}

/// Whether a scene is imported; an error where the store has another one of this number.
fn is_done(store: &Store, survey: &SceneSurvey, selection: &Selection) -> Result<bool, ImportError> {
    let number = survey.number;
    if let Ok(Some(manifest)) = store.manifest(Scope::Scene(number), LOG_STAGE) {
        let place = store.location("");
        if !is_imported(&manifest.code_version) || manifest.config_hash != survey.digest {
            return Err(ImportError::Refused(format!(
                "{place}: has another scene {number} already: choose another folder"
            )));
        }
    }
    if selection.force {
        return Ok(false);
    }
    for stage in scene_unit::stages(survey.is_processed) {
        if !scene_unit::is_done(store, number, stage, &survey.digest)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// What an import did.
#[derive(Debug)]
pub struct Outcome {
    /// Scenes that were imported.
    pub made: usize,
    /// Scenes that were there already.
    pub kept: usize,
    /// Scenes that could not be, and why.
    pub failed: Vec<(u32, ImportError)>,
}

/// Imports what a prospect has found, then writes the plan. Scenes are worked on in parallel; the files do
/// not depend on how many threads there are. A scene that cannot be imported does not end the others.
///
/// # Errors
/// The store cannot be read or written, or the import was stopped: what is finished is kept, and there is no
/// plan yet.
pub fn import(
    source: &Source,
    store: &Store,
    prospect: Prospect,
    selection: &Selection,
    name: &str,
    watch: &dyn ProgressWatch,
) -> Result<Outcome, ImportError> {
    let Prospect { scenes, done, mut failed, others, plan } = prospect;
    let todo: Vec<&SceneSurvey> = scenes.iter().filter(|scene| !done.contains(&scene.number)).collect();
    let results: Vec<(u32, Result<(), ImportError>)> = todo
        .par_iter()
        .map(|survey| (survey.number, import_scene(source, store, survey, selection, watch)))
        .collect();
    let mut made = 0;
    for (number, result) in results {
        match result {
            Ok(()) => made += 1,
            Err(error @ ImportError::Source { .. }) => {
                let failure = Failure { code_version: IMPORTED.to_owned(), reason: error.to_string() };
                store.write_json(&Scope::Scene(number).failure(LOG_STAGE), LOG_STAGE, &failure)?;
                failed.push((number, error));
            }
            Err(error) => return Err(error),
        }
    }
    failed.sort_by_key(|(number, _)| *number);
    let mut all: Vec<&SceneSurvey> = scenes.iter().chain(&others).collect();
    all.sort_by_key(|survey| survey.number);
    if made + done.len() + others.len() > 0 {
        plan::write(store, (source, name, selection.made_by.as_ref()), &all, plan.as_ref())?;
    }
    Ok(Outcome { made, kept: done.len(), failed })
}

fn import_scene(
    source: &Source,
    store: &Store,
    survey: &SceneSurvey,
    selection: &Selection,
    watch: &dyn ProgressWatch,
) -> Result<(), ImportError> {
    let number = survey.number;
    let Some(entry) = source.entry(number) else { return Ok(()) };
    let scene = entry.read(&entry.text()?)?;
    let order = Order {
        folder: &source.folder,
        store,
        rigs: &source.rigs,
        entry,
        digest: &survey.digest,
        bev_cell_m: survey.bev_cell_m,
        is_processed: survey.is_processed,
        force: selection.force,
        made_by: selection.made_by.as_ref(),
        watch,
    };
    scene_unit::import(&order, &scene).map_err(|e| e.within(format!("scene {number}")))
}
