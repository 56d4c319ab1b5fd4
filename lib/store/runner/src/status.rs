//! What states of stages are told from: a store, the configurations and programs of now, and what of these is
//! the same for all scenes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use store::{Manifest, SceneKind, Scope, Store, StoreError, side_by_side};

use crate::editions::Editions;
use crate::graph::{Graph, StageSpec};
use crate::programs::Programs;
use crate::record::Record;
use crate::seen::ViewError;
use crate::state::{CodeRule, Staleness};
use crate::views::config_hash;

/// So many scenes are looked at for each request that a service may well answer at once.
const LOOKS: usize = 4;

/// Scenes of the plan, or `None` when there is no plan (or its manifest is damaged).
///
/// # Errors
/// The store cannot be read.
pub fn planned_scenes(store: &Store) -> Result<Option<Vec<u32>>, StoreError> {
    let plan = Record::read(store, Scope::Plan, Graph::get().planner().name)?;
    Ok(plan.sound().map(scenes_of))
}

/// The scenes of a plan's manifest.
fn scenes_of(plan: &Manifest) -> Vec<u32> {
    plan.sections.keys().filter_map(|name| name.strip_prefix("scene/").and_then(|n| n.parse().ok())).collect()
}

/// What states of stages are told from. Clones share what they have learnt: the plan's manifest is read once.
#[derive(Clone, Debug)]
pub struct Status<'a> {
    store: &'a Store,
    /// None where nothing is held against them.
    editions: Option<&'a Editions>,
    programs: &'a Programs,
    code: CodeRule,
    known: Arc<Known>,
}

/// What is the same for all scenes.
#[derive(Debug, Default)]
pub(crate) struct Known {
    plan: Mutex<Option<Arc<Record>>>,
    /// Digests of the settings that stages see, by stage and kind of scene.
    hashes: Mutex<BTreeMap<(&'static str, Option<SceneKind>), String>>,
}

impl<'a> Status<'a> {
    /// States of stages in a store, by the configurations and the programs of now.
    #[must_use]
    pub fn new(store: &'a Store, editions: &'a Editions, programs: &'a Programs) -> Self {
        Self { store, editions: Some(editions), programs, code: CodeRule::Same, known: Arc::default() }
    }

    /// The same of a store that was imported: it has no configuration, and nothing is stale by one.
    #[must_use]
    pub fn of_import(store: &'a Store, programs: &'a Programs) -> Self {
        Self { store, editions: None, programs, code: CodeRule::Same, known: Arc::default() }
    }

    /// The same by a rule for the code that made them.
    pub(crate) fn by_code(self, code: CodeRule) -> Self {
        Self { code, ..self }
    }

    /// The same with what others have learnt from this store and these configurations.
    pub(crate) fn knowing(self, known: &Arc<Known>) -> Self {
        Self { known: known.clone(), ..self }
    }

    /// The store.
    #[must_use]
    pub fn store(&self) -> &'a Store {
        self.store
    }

    /// Looks at scenes side by side. A service is asked for much more at once than a disk: each answer is
    /// small, and takes its time.
    pub(crate) fn side_by_side<I: Sync, T: Send, E: Send>(
        &self,
        scenes: &[I],
        look: impl Fn(&I) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let at_once = match self.store.backend().at_once() {
            0 | 1 => rayon::current_num_threads(),
            requests => LOOKS * requests,
        };
        side_by_side(scenes, at_once, look)
    }

    pub(crate) fn editions(&self) -> Option<&'a Editions> {
        self.editions
    }

    pub(crate) fn code(&self) -> CodeRule {
        self.code
    }

    /// The plan's manifest.
    pub(crate) fn plan(&self) -> Result<Arc<Record>, StoreError> {
        let mut plan = self.known.plan.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = plan.as_ref() {
            return Ok(plan.clone());
        }
        let read = Record::read(self.store, Scope::Plan, Graph::get().planner().name)?;
        Ok(plan.insert(read).clone())
    }

    /// Scenes of the plan, or `None` when there is no plan (or its manifest is damaged).
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn planned_scenes(&self) -> Result<Option<Vec<u32>>, StoreError> {
        Ok(self.plan()?.sound().map(scenes_of))
    }

    /// Digest of what a stage sees of the configuration for a scope; none of an import.
    pub(crate) fn config_hash(&self, spec: &StageSpec, scope: Scope) -> Result<Option<String>, ViewError> {
        let Some(editions) = self.editions else { return Ok(None) };
        let kind = if let Scope::Scene(scene) = scope { Some(editions.kind_of(scene)) } else { None };
        let key = (spec.name, kind);
        let hashes = || self.known.hashes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(hash) = hashes().get(&key) {
            return Ok(Some(hash.clone()));
        }
        let hash = config_hash(spec, editions, scope)?;
        hashes().insert(key, hash.clone());
        Ok(Some(hash))
    }

    /// Whether the code of now made it, or was told to keep it; why not, otherwise.
    pub(crate) fn is_of_code(&self, stage: &str, manifest: &Manifest) -> Result<(), Staleness> {
        let accepts = |what: &str| manifest.accepted_by.iter().any(|accepted| accepted == what);
        let version = crate::code_version(stage);
        if manifest.code_version != version && !accepts(version) {
            return Err(Staleness::Code);
        }
        match &manifest.made_by {
            Some(made_by)
                if !self.programs.makes_the_same(stage, made_by)
                    && !self.programs.digest(stage).is_some_and(|program| accepts(&program)) =>
            {
                Err(Staleness::Program)
            }
            _ => Ok(()),
        }
    }
}
