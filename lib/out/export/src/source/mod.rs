//! What is exported: the finished scenes of a store.

mod scene_source;

use std::collections::{BTreeMap, BTreeSet};

use schema::arrays::{BEV_MASKS, FILLED_VOXEL_GRIDS, VOXEL_GRIDS};
use schema::table::Row;
use schema::tables::{BoxRow, CameraRow, PlanSceneRow, TrackRow};
use store::{Scope, Store, keys};

pub use scene_source::SceneSource;

use crate::{ExportError, Selection};

/// The stages of scenes: an export may read what any of them has made.
const STAGES: [&str; 6] = [
    BoxRow::STAGE,
    CameraRow::STAGE,
    BEV_MASKS.stage,
    VOXEL_GRIDS.stage,
    FILLED_VOXEL_GRIDS.stage,
    TrackRow::STAGE,
];

/// Why what is drawn of a map is left out.
pub(crate) const NO_MAP: &str = "the store has no map of it: it was imported";

schema::columns! {
    /// Which scenes there are.
    Planned of PlanSceneRow { scene: u32, split: String }
}

/// The scenes of a store that are wanted.
#[derive(Clone, Debug)]
pub struct Source {
    /// The store.
    pub store: Store,
    /// What of it is wanted.
    pub selection: Selection,
    /// The wanted scenes that are finished, as far as the layout needs them, by number.
    pub scenes: Vec<SceneSource>,
    /// The wanted scenes that are not, and why.
    pub unfinished: BTreeMap<u32, String>,
}

impl Source {
    /// Opens the wanted scenes of a store that some stages have finished.
    ///
    /// # Errors
    /// It is no store, it cannot be read, or scenes were named that are not in its plan.
    pub fn open(store: &Store, selection: &Selection, needs: &[&'static str]) -> Result<Self, ExportError> {
        let planned = planned(store)?;
        let named = selection.scenes.iter().flatten().flat_map(|(first, last)| [*first, *last]);
        let unknown: BTreeSet<u32> =
            named.filter(|scene| planned.iter().all(|p| p.scene != *scene)).collect();
        if !unknown.is_empty() {
            let (place, unknown) = (store.location(""), in_words(unknown));
            return Err(ExportError::Refused(format!("--scenes: {place}: its plan has no scene {unknown}")));
        }
        let kinds = store::scene_kinds(store)?;
        let no_such = selection.groups.iter().find(|name| kinds.values().all(|kind| kind.group != **name));
        if let Some(name) = no_such {
            let known: BTreeSet<&str> = kinds.values().map(|kind| kind.group.as_str()).collect();
            return Err(ExportError::Refused(format!(
                "no scene of this store is of group `{name}`; its groups: {}",
                known.into_iter().collect::<Vec<_>>().join(", ")
            )));
        }
        let (mut scenes, mut unfinished) = (Vec::new(), BTreeMap::new());
        for Planned { scene, split } in planned {
            let kind = kinds.get(&scene).cloned().unwrap_or_default();
            if !selection.has_scene(scene, &split, &kind) {
                continue;
            }
            match SceneSource::open(store, scene, selection, &STAGES, needs)? {
                Ok(source) => scenes.push(source),
                Err(stage) => {
                    unfinished.insert(scene, format!("{stage} is missing"));
                }
            }
        }
        scenes.sort_by_key(SceneSource::number);
        Ok(Self { store: store.clone(), selection: selection.clone(), scenes, unfinished })
    }

    /// The other finished scenes of the store with wanted agents, one after another: an export may grow by
    /// them.
    ///
    /// # Errors
    /// The store cannot be read; so for each scene.
    pub(crate) fn other_scenes(
        &self,
        needs: &[&'static str],
    ) -> Result<impl Iterator<Item = Result<SceneSource, ExportError>>, ExportError> {
        let mut planned = planned(&self.store)?;
        planned.sort_by_key(|planned| planned.scene);
        planned.retain(|planned| self.scenes.iter().all(|scene| scene.number() != planned.scene));
        Ok(planned.into_iter().filter_map(move |Planned { scene, .. }| {
            match SceneSource::open(&self.store, scene, &self.selection, &STAGES, needs) {
                Ok(Ok(source)) => Some(Ok(source)),
                // It is not finished, or has none of the wanted agents.
                Ok(Err(_)) | Err(ExportError::Refused(_)) => None,
                Err(e) => Some(Err(e)),
            }
        }))
    }

    /// The configuration that the store was made from, as `dataset.json` has it.
    ///
    /// # Errors
    /// It is not there, or no JSON.
    pub fn dataset(&self) -> Result<serde_json::Value, ExportError> {
        dataset(&self.store)
    }
}

/// The scenes of a store's plan.
fn planned(store: &Store) -> Result<Vec<Planned>, ExportError> {
    let plan = store.manifest(Scope::Plan, PlanSceneRow::STAGE)?.ok_or_else(|| {
        let place = store.location("");
        ExportError::Refused(format!(
            "{place}: there is no finished store (no plan): `convoy run --store {place}` makes one"
        ))
    })?;
    Ok(store.read_rows(&plan, keys::PLAN_SCENES)?)
}

/// Numbers in a row.
fn in_words(all: impl IntoIterator<Item = u32>) -> String {
    all.into_iter().map(|one| one.to_string()).collect::<Vec<_>>().join(", ")
}

/// The configuration that a store was made from, as `dataset.json` has it.
pub(crate) fn dataset(store: &Store) -> Result<serde_json::Value, ExportError> {
    let path = store.location(keys::DATASET);
    let bytes = store.read(keys::DATASET)?;
    let bytes = bytes.ok_or_else(|| ExportError::Refused(format!("{path}: is missing")))?;
    serde_json::from_slice(&bytes).map_err(|e| ExportError::Refused(format!("{path}: {e}")))
}
