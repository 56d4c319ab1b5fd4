//! A store that is joined with others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use runner::{Graph, SceneList, StageError};
use serde_json::Value;
use store::{Manifest, SceneKind, Scope, Store, StoreError};

/// Why stores cannot be joined.
pub(super) enum Fault {
    /// What the user can correct.
    Refused(String),
    Store(StoreError),
    /// The store cannot be held.
    Lock(StageError),
    Stopped,
}

impl From<StoreError> for Fault {
    fn from(e: StoreError) -> Self {
        Self::Store(e)
    }
}

impl From<StageError> for Fault {
    fn from(e: StageError) -> Self {
        Self::Lock(e)
    }
}

/// A store that is joined, and its plan.
#[derive(Clone)]
pub(super) struct Member {
    pub(super) store: Store,
    pub(super) name: String,
    pub(super) plan: Manifest,
    /// The configurations that its scenes are made by, by edition.
    pub(super) editions: Vec<Value>,
    pub(super) kinds: BTreeMap<u32, SceneKind>,
    /// The scenes that are meant; all where none are named.
    pub(super) only: Option<SceneList>,
}

impl Member {
    /// A store, of which only some scenes may be meant. None where there is no plan.
    pub(super) fn open(place: &Path, only: Option<&SceneList>) -> Result<Option<Self>, Fault> {
        let store = Store::open(place)?;
        let Some(plan) = store.manifest(Scope::Plan, Graph::get().planner().name)? else { return Ok(None) };
        let editions = runner::recorded_editions(&store)?;
        let kinds = store::scene_kinds(&store)?;
        let (name, only) = (place.display().to_string(), only.cloned());
        Ok(Some(Self { store, name, plan, editions, kinds, only }))
    }

    /// Scenes of which something is done, of those that are meant.
    pub(super) fn scenes(&self) -> Result<BTreeSet<u32>, StoreError> {
        let mut scenes = store::scenes_begun(&self.store)?;
        scenes.retain(|scene| self.only.as_ref().is_none_or(|only| only.contains(*scene)));
        Ok(scenes)
    }

    /// What a scene is made by.
    pub(super) fn rules(&self, scene: u32) -> Value {
        let kind = self.kinds.get(&scene).cloned().unwrap_or_default();
        let edition = self.editions.get(kind.edition as usize);
        let rules = edition.map(runner::rules_of_record).unwrap_or_default();
        runner::record_of_group(&rules, &kind.group)
    }

    /// Digest of a scene's plan, if it is planned.
    pub(super) fn planned(&self, scene: u32) -> Option<&String> {
        self.plan.sections.get(&format!("scene/{scene:04}"))
    }
}
