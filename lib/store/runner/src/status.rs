//! Is a stage done for a scope, and if not, why?

use std::collections::BTreeMap;
use std::fmt;

use store::{Manifest, Scope, Store, StoreError};

use crate::editions::Editions;
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::programs::Programs;
use crate::seen::ViewError;
use crate::views::{config_hash, shards_of};

/// State of a stage for a scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Its manifest stands, everything it was made from is unchanged, its outputs are there.
    Done,
    /// It was never done, or a run was killed half-way.
    Missing,
    /// It was done from something else.
    Stale(Staleness),
    /// The last try failed.
    Failed(String),
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Done => f.write_str("done"),
            Self::Missing => f.write_str("missing"),
            Self::Stale(why) => write!(f, "stale: {why}"),
            Self::Failed(why) => write!(f, "failed: {why}"),
        }
    }
}

/// Why what was made no longer holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Staleness {
    /// Its manifest is damaged: where and how.
    Damaged(String),
    /// The stage sees other settings now.
    Configuration,
    /// The version of the stage's code is another.
    Code,
    /// The version is the same, but the stage's program is another, and one of the two has uncommitted
    /// changes.
    Program,
    /// What it was made from cannot be read yet, or no longer.
    NotReady(NotReady),
    /// An input (a stage, or a stage of a scene) was redone.
    Redone(String),
    /// Something outside the store changed.
    Source(String),
    /// An output is missing or has another size.
    Output,
}

impl fmt::Display for Staleness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged(what) => f.write_str(what),
            Self::Configuration => f.write_str("the configuration changed"),
            Self::Code => f.write_str("the code changed"),
            Self::Program => f.write_str("the program changed (a build with uncommitted changes)"),
            Self::NotReady(why) => write!(f, "{why}"),
            Self::Redone(input) => write!(f, "{input} was redone"),
            Self::Source(name) => write!(f, "{name} changed"),
            Self::Output => f.write_str("an output is missing or truncated"),
        }
    }
}

/// Why a stage cannot run for a scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotReady {
    /// A stage that it reads is not done.
    Stage {
        /// The stage.
        name: &'static str,
        /// Its state.
        state: Box<State>,
    },
    /// The plan has no such scene.
    Unplanned {
        /// The scene.
        scene: u32,
    },
}

impl fmt::Display for NotReady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The first stage that is not done is the one to run, however long the way to it.
            Self::Stage { name, state } => match &**state {
                State::Stale(Staleness::NotReady(why @ Self::Stage { .. })) => write!(f, "{why}"),
                State::Missing => write!(f, "{name} is missing"),
                State::Failed(why) => write!(f, "{name} failed ({why})"),
                state => write!(f, "{name} is {state}"),
            },
            Self::Unplanned { scene } => write!(f, "scene {scene} is not in the plan"),
        }
    }
}

/// Which code a manifest must be of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CodeRule {
    /// This program's, or one that this program's was accepted for.
    Same,
    /// Any.
    Any,
}

/// Begins the names of inputs that are not in the store (map files).
pub(crate) const SOURCE: &str = "source/";

/// Stands for the digest of what is not done.
pub(crate) const NOT_DONE: &str = "not done";

/// Name of a scene's digest in the plan's manifest.
pub(crate) fn plan_section(scene: u32) -> String {
    format!("scene/{scene:04}")
}

/// What a stage would read now.
pub(crate) struct Inputs {
    /// Digest of each thing, by name: what a manifest remembers.
    pub(crate) digests: BTreeMap<String, String>,
    /// Digests of whole manifests of which a part is read: older manifests remember these.
    whole: BTreeMap<String, String>,
    /// The manifests of the stages it reads, by stage.
    pub(crate) manifests: BTreeMap<String, Manifest>,
}

impl Inputs {
    /// What differs from the digests that a manifest remembers, if anything does.
    fn differing(&self, stored: &BTreeMap<String, String>) -> Option<String> {
        let is_same = |(name, digest): &(&String, &String)| {
            let then = stored.get(*name);
            then == Some(*digest) || then.is_some() && then == self.whole.get(*name)
        };
        let changed = self.digests.iter().find(|input| !is_same(input)).map(|(name, _)| name.clone());
        let is_gone = || stored.keys().any(|name| !self.digests.contains_key(name));
        changed.or_else(|| is_gone().then(|| "an input".to_owned()))
    }
}

/// A stage's manifest, or `Stale` when it is damaged: the stage can be run again as if something had changed.
pub(crate) fn manifest_or_stale(
    store: &Store,
    scope: Scope,
    stage: &str,
) -> Result<Result<Option<Manifest>, State>, StoreError> {
    match store.manifest(scope, stage) {
        Err(StoreError::Corrupt { path, problem }) => {
            Ok(Err(State::Stale(Staleness::Damaged(format!("{path} is damaged ({problem})")))))
        }
        other => other.map(Ok),
    }
}

/// Scenes of the plan, or `None` when there is no plan (or its manifest is damaged).
///
/// # Errors
/// The store cannot be read.
pub fn planned_scenes(store: &Store) -> Result<Option<Vec<u32>>, StoreError> {
    let planner = Graph::get().planner();
    let manifest = manifest_or_stale(store, Scope::Plan, planner.name)?.unwrap_or_default();
    Ok(manifest.map(|m| {
        m.sections
            .keys()
            .filter_map(|name| name.strip_prefix("scene/").and_then(|n| n.parse().ok()))
            .collect()
    }))
}

/// The state of a stage cannot be told.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The configuration cannot be handed to the stage.
    #[error(transparent)]
    View(#[from] ViewError),
}

/// What states of stages are told from.
#[derive(Clone, Copy, Debug)]
pub struct Status<'a> {
    store: &'a Store,
    /// None where nothing is held against them.
    editions: Option<&'a Editions>,
    programs: &'a Programs,
    code: CodeRule,
}

impl<'a> Status<'a> {
    /// States of stages in a store, by the configurations and the programs of now.
    #[must_use]
    pub fn new(store: &'a Store, editions: &'a Editions, programs: &'a Programs) -> Self {
        Self { store, editions: Some(editions), programs, code: CodeRule::Same }
    }

    /// The same of a store that was imported: it has no configuration, and nothing is stale by one.
    #[must_use]
    pub fn of_import(store: &'a Store, programs: &'a Programs) -> Self {
        Self { store, editions: None, programs, code: CodeRule::Same }
    }

    /// The same by a rule for the code that made them.
    pub(crate) fn by_code(self, code: CodeRule) -> Self {
        Self { code, ..self }
    }

    /// State of a stage for a scope.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn state(&self, spec: &StageSpec, scope: Scope) -> Result<State, StateError> {
        let store = self.store;
        let manifest = match manifest_or_stale(store, scope, spec.name)? {
            Ok(Some(manifest)) => manifest,
            Ok(None) => {
                let failure: Option<store::Failure> = match store.read_json(&scope.failure(spec.name)) {
                    Err(StoreError::Corrupt { .. }) => None,
                    other => other?,
                };
                return Ok(failure.map_or(State::Missing, |f| State::Failed(f.reason)));
            }
            Err(stale) => return Ok(stale),
        };
        if is_imported(&manifest) {
            let is_there = store.outputs_present(&manifest)?;
            return Ok(if is_there { State::Done } else { State::Stale(Staleness::Output) });
        }
        if let Some(editions) = self.editions
            && manifest.config_hash != config_hash(spec, editions, scope)?
        {
            return Ok(State::Stale(Staleness::Configuration));
        }
        if self.code == CodeRule::Same
            && let Err(why) = self.is_of_code(spec.name, &manifest)
        {
            return Ok(State::Stale(why));
        }
        // Whether sources outside the store changed is for the stage itself to see: it knows where they are.
        let stored = manifest.inputs.iter().filter(|(name, _)| !name.starts_with(SOURCE));
        let stored: BTreeMap<String, String> = stored.map(|(n, d)| (n.clone(), d.clone())).collect();
        match self.inputs(spec, scope)? {
            Err(why) => return Ok(State::Stale(Staleness::NotReady(why))),
            // Which part of an input is read is for the configuration to say.
            Ok(now) if self.editions.is_some() => {
                if let Some(changed) = now.differing(&stored) {
                    return Ok(State::Stale(Staleness::Redone(changed)));
                }
            }
            Ok(_) => {}
        }
        if !store.outputs_present(&manifest)? {
            return Ok(State::Stale(Staleness::Output));
        }
        Ok(State::Done)
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

    /// What a stage would read for a scope, or why it cannot run yet.
    pub(crate) fn inputs(
        &self,
        spec: &StageSpec,
        scope: Scope,
    ) -> Result<Result<Inputs, NotReady>, StateError> {
        let store = self.store;
        let mut inputs =
            Inputs { digests: BTreeMap::new(), whole: BTreeMap::new(), manifests: BTreeMap::new() };
        for read in spec.inputs() {
            let name = read.name;
            match (spec.unit, read.unit) {
                (UnitKind::Scene, UnitKind::Plan) => {
                    let plan = match manifest_or_stale(store, Scope::Plan, name)? {
                        Ok(Some(plan)) => plan,
                        Ok(None) => {
                            return Ok(Err(NotReady::Stage { name, state: Box::new(State::Missing) }));
                        }
                        Err(state) => return Ok(Err(NotReady::Stage { name, state: Box::new(state) })),
                    };
                    let Scope::Scene(scene) = scope else { continue };
                    let Some(digest) = plan.sections.get(&plan_section(scene)) else {
                        return Ok(Err(NotReady::Unplanned { scene }));
                    };
                    inputs.digests.insert(name.to_owned(), digest.clone());
                    inputs.manifests.insert(name.to_owned(), plan);
                }
                (UnitKind::Stats, _) => {
                    for scene in planned_scenes(store)?.unwrap_or_default() {
                        let scene_scope = Scope::Scene(scene);
                        let manifest = match self.state(read, scene_scope)? {
                            State::Done => store.manifest(scene_scope, name)?,
                            _ => None,
                        };
                        // What is planned and not done is remembered as well: statistics say how much they
                        // leave out.
                        let digest = manifest.map_or_else(|| NOT_DONE.to_owned(), |m| m.digest());
                        inputs.digests.insert(format!("{}/{name}", plan_section(scene)), digest);
                    }
                }
                _ => {
                    let state = self.state(read, scope)?;
                    if state != State::Done {
                        return Ok(Err(NotReady::Stage { name, state: Box::new(state) }));
                    }
                    if let Some(manifest) = store.manifest(scope, name)? {
                        let Some(editions) = self.editions else { continue };
                        let part = (shards_of(spec)?.part)(editions.of(scope), scope, manifest);
                        inputs.digests.insert(name.to_owned(), part.digest);
                        inputs.whole.insert(name.to_owned(), part.whole);
                        inputs.manifests.insert(name.to_owned(), part.manifest);
                    }
                }
            }
        }
        Ok(Ok(inputs))
    }
}
