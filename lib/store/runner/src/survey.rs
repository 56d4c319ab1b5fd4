//! A scope as it was found: listed once, each manifest read once, each stage judged once.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::sync::Arc;

use store::{Failure, Manifest, Scope, StoreError};

use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::record::Record;
use crate::seen::ViewError;
use crate::shards::Part;
use crate::state::{CodeRule, NOT_DONE, NotReady, SOURCE, Staleness, State, StateError, plan_section};
use crate::status::Status;
use crate::views::shards_of;

/// What a stage would read now.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// Digest of each thing, by name: what a manifest remembers.
    pub(crate) digests: BTreeMap<String, String>,
    /// Digests of whole manifests of which a part is read: older manifests remember these.
    pub(crate) whole: BTreeMap<String, String>,
    /// What is read of each stage.
    pub(crate) parts: BTreeMap<&'static str, Part>,
    /// Of statistics, what is read of the stages of scenes that are done.
    pub(crate) scenes: BTreeMap<u32, Vec<Manifest>>,
}

impl Inputs {
    /// What differs from the digests that a manifest remembers, if anything does.
    pub(crate) fn differing(&self, stored: &BTreeMap<String, String>) -> Option<String> {
        let is_same = |(name, digest): &(&String, &String)| {
            let then = stored.get(*name);
            then == Some(*digest) || then.is_some() && then == self.whole.get(*name)
        };
        let changed = self.digests.iter().find(|input| !is_same(input)).map(|(name, _)| name.clone());
        let is_gone = || stored.keys().any(|name| !self.digests.contains_key(name));
        changed.or_else(|| is_gone().then(|| "an input".to_owned()))
    }
}

/// A scope of a store at one moment. All that is asked of it is told from one listing of its folder and from
/// the manifests in that, each read when it is asked for first.
#[derive(Debug)]
pub struct Survey<'a> {
    status: &'a Status<'a>,
    scope: Scope,
    listing: OnceCell<Found>,
    records: RefCell<BTreeMap<&'static str, Arc<Record>>>,
    states: RefCell<BTreeMap<&'static str, State>>,
    /// What statistics would read, where all scenes were looked at already.
    known: RefCell<Option<Inputs>>,
}

/// What a listing found.
#[derive(Debug)]
struct Found {
    /// Sizes of objects, by key.
    objects: BTreeMap<String, u64>,
    has_unfinished: bool,
}

impl<'a> Status<'a> {
    /// A scope as it is now, for all that is to be asked of it.
    #[must_use]
    pub fn survey(&'a self, scope: Scope) -> Survey<'a> {
        Survey::new(self, scope)
    }

    /// State of a stage for a scope.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn state(&self, spec: &StageSpec, scope: Scope) -> Result<State, StateError> {
        Survey::new(self, scope).state(spec)
    }
}

impl<'a> Survey<'a> {
    fn new(status: &'a Status<'a>, scope: Scope) -> Self {
        Self {
            status,
            scope,
            listing: OnceCell::new(),
            records: RefCell::default(),
            states: RefCell::default(),
            known: RefCell::default(),
        }
    }

    /// The same with what statistics would read, where all scenes were looked at already.
    pub(crate) fn knowing(self, inputs: Inputs) -> Self {
        self.known.replace(Some(inputs));
        self
    }

    fn listing(&self) -> Result<&Found, StoreError> {
        if let Some(found) = self.listing.get() {
            return Ok(found);
        }
        let listing = self.status.store().backend().list(&self.scope.folder())?;
        let objects = listing.objects.into_iter().map(|object| (object.key, object.bytes)).collect();
        Ok(self.listing.get_or_init(|| Found { objects, has_unfinished: listing.has_unfinished }))
    }

    /// Size of an object, if it is there. Of what lies elsewhere (a plan's maps) the store is asked.
    pub(crate) fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        let is_in = key.strip_prefix(&self.scope.folder()).is_some_and(|rest| rest.starts_with('/'));
        if is_in {
            return Ok(self.listing()?.objects.get(key).copied());
        }
        self.status.store().backend().size(key)
    }

    /// Whether every output of a manifest is there in its size.
    fn has_outputs(&self, manifest: &Manifest) -> Result<bool, StoreError> {
        for output in &manifest.outputs {
            if self.size(&output.key)? != Some(output.bytes) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a killed run left something of a stage that is done: records of its units, or, of any stage,
    /// what is unfinished.
    pub(crate) fn is_untidy(&self, stage: &str) -> Result<bool, StoreError> {
        let Found { objects, has_unfinished } = self.listing()?;
        let parts = format!("{}/", self.scope.parts(stage));
        let has_part = objects.range(parts.clone()..).next().is_some_and(|(key, _)| key.starts_with(&parts));
        let has = |key: String| objects.contains_key(&key);
        Ok(*has_unfinished || has_part || has(self.scope.redo(stage)) || has(self.scope.failure(stage)))
    }

    /// A stage's manifest.
    pub(crate) fn record(&self, stage: &'static str) -> Result<Arc<Record>, StoreError> {
        if let Some(record) = self.records.borrow().get(stage) {
            return Ok(record.clone());
        }
        let record = match self.scope {
            Scope::Plan => self.status.plan()?,
            _ if self.size(&self.scope.manifest(stage))?.is_none() => Record::none(),
            scope => Record::read(self.status.store(), scope, stage)?,
        };
        self.records.borrow_mut().insert(stage, record.clone());
        Ok(record)
    }

    /// State of a stage.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn state(&self, spec: &StageSpec) -> Result<State, StateError> {
        if let Some(state) = self.states.borrow().get(spec.name) {
            return Ok(state.clone());
        }
        let state = self.judge(spec)?;
        self.states.borrow_mut().insert(spec.name, state.clone());
        Ok(state)
    }

    fn judge(&self, spec: &StageSpec) -> Result<State, StateError> {
        let (status, scope) = (self.status, self.scope);
        let record = self.record(spec.name)?;
        let manifest = match record.manifest() {
            Ok(Some(manifest)) => manifest,
            Ok(None) => {
                let failure = self.failure(spec.name)?;
                return Ok(failure.map_or(State::Missing, |failure| State::Failed(failure.reason)));
            }
            Err(stale) => return Ok(stale.clone()),
        };
        if is_imported(manifest) {
            let is_there = self.has_outputs(manifest)?;
            return Ok(if is_there { State::Done } else { State::Stale(Staleness::Output) });
        }
        if let Some(hash) = status.config_hash(spec, scope)?
            && manifest.config_hash != hash
        {
            return Ok(State::Stale(Staleness::Configuration));
        }
        if status.code() == CodeRule::Same
            && let Err(why) = status.is_of_code(spec.name, manifest)
        {
            return Ok(State::Stale(why));
        }
        // Whether sources outside the store changed is for the stage itself to see: it knows where they are.
        let stored = manifest.inputs.iter().filter(|(name, _)| !name.starts_with(SOURCE));
        let stored: BTreeMap<String, String> = stored.map(|(n, d)| (n.clone(), d.clone())).collect();
        match self.inputs(spec)? {
            Err(why) => return Ok(State::Stale(Staleness::NotReady(why))),
            // Which part of an input is read is for the configuration to say.
            Ok(now) if status.editions().is_some() => {
                if let Some(changed) = now.differing(&stored) {
                    return Ok(State::Stale(Staleness::Redone(changed)));
                }
            }
            Ok(_) => {}
        }
        if !self.has_outputs(manifest)? {
            return Ok(State::Stale(Staleness::Output));
        }
        Ok(State::Done)
    }

    /// The record that a stage failed; a damaged one says nothing.
    fn failure(&self, stage: &str) -> Result<Option<Failure>, StoreError> {
        let key = self.scope.failure(stage);
        if self.size(&key)?.is_none() {
            return Ok(None);
        }
        match self.status.store().read_json(&key) {
            Err(StoreError::Corrupt { .. }) => Ok(None),
            other => other,
        }
    }

    /// What a stage would read, or why it cannot run yet.
    pub(crate) fn inputs(&self, spec: &StageSpec) -> Result<Result<Inputs, NotReady>, StateError> {
        if let Some(known) = self.known.borrow_mut().take() {
            return Ok(Ok(known));
        }
        if spec.unit == UnitKind::Stats {
            return Ok(Ok(self.of_all_scenes(spec)?));
        }
        let mut inputs = Inputs::default();
        for read in spec.inputs() {
            let name = read.name;
            if (spec.unit, read.unit) == (UnitKind::Scene, UnitKind::Plan) {
                let plan = self.status.plan()?;
                let sections = match plan.manifest() {
                    Ok(Some(manifest)) => &manifest.sections,
                    Ok(None) => return Ok(Err(NotReady::Stage { name, state: Box::new(State::Missing) })),
                    Err(state) => return Ok(Err(NotReady::Stage { name, state: Box::new(state.clone()) })),
                };
                let Scope::Scene(scene) = self.scope else { continue };
                let Some(digest) = sections.get(&plan_section(scene)) else {
                    return Ok(Err(NotReady::Unplanned { scene }));
                };
                inputs.digests.insert(name.to_owned(), digest.clone());
                inputs.parts.insert(name, Part::whole(plan.clone()));
                continue;
            }
            let state = self.state(read)?;
            if state != State::Done {
                return Ok(Err(NotReady::Stage { name, state: Box::new(state) }));
            }
            if let Some(editions) = self.status.editions() {
                let part = (shards_of(spec)?.part)(editions.of(self.scope), self.scope, &self.record(name)?);
                inputs.digests.insert(name.to_owned(), part.digest().to_owned());
                inputs.whole.insert(name.to_owned(), part.whole_digest().to_owned());
                inputs.parts.insert(name, part);
            }
        }
        Ok(Ok(inputs))
    }

    /// What statistics remember of a scene: the stages that are done. What is not done is remembered as well:
    /// statistics say how much they leave out.
    pub(crate) fn digests_for(
        &self,
        spec: &StageSpec,
        scene: u32,
    ) -> Result<BTreeMap<String, String>, StateError> {
        let digest = |read: &'static StageSpec| {
            let digest = match self.state(read)? {
                State::Done => self.record(read.name)?.digest().to_owned(),
                _ => NOT_DONE.to_owned(),
            };
            Ok((format!("{}/{}", plan_section(scene), read.name), digest))
        };
        spec.inputs().map(digest).collect()
    }

    /// What statistics would read of all scenes.
    fn of_all_scenes(&self, spec: &StageSpec) -> Result<Inputs, StateError> {
        let scenes = self.status.planned_scenes()?.unwrap_or_default();
        let is_read =
            self.status.editions().map(|editions| Ok::<_, ViewError>((shards_of(spec)?.reads)(editions)));
        let is_read = is_read.transpose()?;
        // Thousands of manifests are held at once: with what is read of them alone.
        let kept = |scene: u32, manifest: &Manifest| {
            let mut manifest = manifest.clone();
            if let Some(is_read) = &is_read {
                let folder = format!("{}/", Scope::Scene(scene).folder());
                let Manifest { stage, outputs, .. } = &mut manifest;
                outputs.retain(|o| o.key.strip_prefix(&folder).is_some_and(|path| is_read(stage, path)));
            }
            manifest
        };
        let looked = self.status.side_by_side(&scenes, |&scene| -> Result<Inputs, StateError> {
            let survey = self.status.survey(Scope::Scene(scene));
            let mut inputs = Inputs { digests: survey.digests_for(spec, scene)?, ..Inputs::default() };
            let done = inputs.scenes.entry(scene).or_default();
            for read in spec.inputs() {
                if survey.state(read)? == State::Done {
                    done.extend(survey.record(read.name)?.sound().map(|manifest| kept(scene, manifest)));
                }
            }
            Ok(inputs)
        })?;
        let mut all = Inputs::default();
        for one in looked {
            all.digests.extend(one.digests);
            all.scenes.extend(one.scenes);
        }
        Ok(all)
    }
}

/// The stages of scenes, in running order.
pub fn scene_stages() -> impl Iterator<Item = &'static StageSpec> {
    Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene)
}
