//! Is a stage done for a scope, and if not, why?

use std::collections::BTreeMap;
use std::fmt;

use schema::settings::DatasetSettings;
use store::{Manifest, Scope, Store, StoreError};

use crate::graph::{Graph, StageSpec, UnitKind, config_hash};

/// State of a stage for a scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Its manifest stands, everything it was made from is unchanged, its outputs are there.
    Done,
    /// It was never done, or a run was killed half-way.
    Missing,
    /// It was done from something else.
    Stale(String),
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

/// Begins the names of inputs that are not in the store (map files).
pub(crate) const SOURCE: &str = "source/";

/// Name of a scene's digest in the plan's manifest.
pub(crate) fn plan_section(scene: u32) -> String {
    format!("scene/{scene:04}")
}

/// What a stage would read now.
pub(crate) struct Inputs {
    /// Digest of each thing, by name: what a manifest remembers.
    pub(crate) digests: BTreeMap<String, String>,
    /// The manifests of the stages it reads, by stage.
    pub(crate) manifests: BTreeMap<String, Manifest>,
}

/// A stage's manifest, or `Stale` when it is damaged: the stage can be run again as if something had changed.
fn manifest_or_stale(
    store: &Store,
    scope: Scope,
    stage: &str,
) -> Result<Result<Option<Manifest>, State>, StoreError> {
    match store.manifest(scope, stage) {
        Err(StoreError::Corrupt { path, problem }) => {
            Ok(Err(State::Stale(format!("{path} is damaged ({problem})"))))
        }
        other => other.map(Ok),
    }
}

/// Scenes of the plan, or `None` when there is no plan (or its manifest is damaged).
pub(crate) fn planned_scenes(store: &Store) -> Result<Option<Vec<u32>>, StoreError> {
    let Some(planner) = Graph::get().stages.first() else { return Ok(None) };
    let manifest = manifest_or_stale(store, Scope::Plan, &planner.name)?.unwrap_or_default();
    Ok(manifest.map(|m| {
        m.sections
            .keys()
            .filter_map(|name| name.strip_prefix("scene/").and_then(|n| n.parse().ok()))
            .collect()
    }))
}

/// What a stage would read for a scope, or why it cannot run yet.
pub(crate) fn inputs(
    store: &Store,
    settings: &DatasetSettings,
    spec: &StageSpec,
    scope: Scope,
) -> Result<Result<Inputs, String>, StoreError> {
    let mut inputs = Inputs { digests: BTreeMap::new(), manifests: BTreeMap::new() };
    for name in &spec.reads {
        let Some(read) = Graph::get().stage(name) else { continue };
        match (spec.unit, read.unit) {
            (UnitKind::Scene, UnitKind::Plan) => {
                let plan = match manifest_or_stale(store, Scope::Plan, name)? {
                    Ok(Some(plan)) => plan,
                    Ok(None) => return Ok(Err(format!("{name} is missing"))),
                    Err(state) => return Ok(Err(format!("{name} is {state}"))),
                };
                let Scope::Scene(scene) = scope else { continue };
                let Some(digest) = plan.sections.get(&plan_section(scene)) else {
                    return Ok(Err(format!("scene {scene} is not in the plan")));
                };
                inputs.digests.insert(name.clone(), digest.clone());
                inputs.manifests.insert(name.clone(), plan);
            }
            (UnitKind::Stats, _) => {
                for scene in planned_scenes(store)?.unwrap_or_default() {
                    let scene_scope = Scope::Scene(scene);
                    if state_of(store, settings, read, scene_scope)? == State::Done
                        && let Some(manifest) = store.manifest(scene_scope, name)?
                    {
                        inputs.digests.insert(format!("{}/{name}", plan_section(scene)), manifest.digest());
                    }
                }
            }
            _ => {
                let state = state_of(store, settings, read, scope)?;
                if state != State::Done {
                    return Ok(Err(format!("{name} is {state}")));
                }
                if let Some(manifest) = store.manifest(scope, name)? {
                    inputs.digests.insert(name.clone(), manifest.digest());
                    inputs.manifests.insert(name.clone(), manifest);
                }
            }
        }
    }
    Ok(Ok(inputs))
}

/// State of a stage for a scope.
///
/// # Errors
/// The store cannot be read.
pub fn state_of(
    store: &Store,
    settings: &DatasetSettings,
    spec: &StageSpec,
    scope: Scope,
) -> Result<State, StoreError> {
    let manifest = match manifest_or_stale(store, scope, &spec.name)? {
        Ok(Some(manifest)) => manifest,
        Ok(None) => {
            let failure: Option<store::Failure> = match store.read_json(&scope.failure(&spec.name)) {
                Err(StoreError::Corrupt { .. }) => None,
                other => other?,
            };
            return Ok(failure.map_or(State::Missing, |f| State::Failed(f.reason)));
        }
        Err(stale) => return Ok(stale),
    };
    if manifest.config_hash != config_hash(spec, settings) {
        return Ok(State::Stale("the configuration changed".into()));
    }
    if manifest.code_version != crate::code_version(&spec.name) {
        return Ok(State::Stale("the code changed".into()));
    }
    // Whether sources outside the store changed is for the stage itself to see: it knows where they are.
    let stored = manifest.inputs.iter().filter(|(name, _)| !name.starts_with(SOURCE));
    let stored: BTreeMap<String, String> = stored.map(|(n, d)| (n.clone(), d.clone())).collect();
    match inputs(store, settings, spec, scope)? {
        Err(why) => return Ok(State::Stale(why)),
        Ok(now) if now.digests != stored => {
            let changed = now
                .digests
                .iter()
                .find(|(name, digest)| stored.get(*name) != Some(digest))
                .map_or("an input", |(name, _)| name.as_str());
            return Ok(State::Stale(format!("{changed} was redone")));
        }
        Ok(_) => {}
    }
    if !store.outputs_present(&manifest)? {
        return Ok(State::Stale("an output is missing or truncated".into()));
    }
    Ok(State::Done)
}
