//! What a run would make again although it is finished, and why. Nothing is replaced by a slip: what a
//! changed configuration or other code makes stale is asked about first.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use indicatif::DecimalBytes;
use schema::AgentId;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use settings::{DatasetSettings, KeyChange};
use store::{Manifest, Output, Scope, Store, StoreError, keys};

use crate::editions::Editions;
use crate::forecast::{Work, span, work_by_stage, work_of_sensors};
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::programs::Programs;
use crate::shards;
use crate::status::{CodeRule, Staleness, StateError, Status, manifest_or_stale, plan_section};
use crate::views::{config_hash, shards_of};

/// Why finished work would be made again.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Cause {
    /// Its scene is planned otherwise.
    Plan,
    /// The stage sees other settings.
    Configuration,
    /// The stage's version or program is another.
    Code(String),
    /// What it was made from would be made again.
    Input(&'static str),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plan => f.write_str("planned otherwise"),
            Self::Configuration => f.write_str("the configuration changed"),
            Self::Code(why) => f.write_str(why),
            Self::Input(stage) => write!(f, "made from {stage}"),
        }
    }
}

/// What is to blame that finished work would be made again; later ones count for more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Blame {
    /// Nothing to ask about: it was asked about before.
    Nothing,
    /// The version or the program of a stage.
    Code,
    /// The configuration, or the maps.
    Configuration,
}

/// Finished work of a stage that would be made again for one reason.
#[derive(Clone, Debug, Default, PartialEq)]
struct Redo {
    scenes: Vec<u32>,
    work: Work,
}

/// A finished stage of a scene that would be made again.
struct Finished {
    cause: Cause,
    blame: Blame,
    /// Bytes as stored.
    bytes: f64,
    /// Of a changed configuration, the shards that it concerns, where the stage keeps the others.
    changed: Option<BTreeSet<String>>,
}

/// What a run would make again although it is finished.
#[derive(Debug, Default)]
pub struct Foresight {
    /// By the stage's place in the graph, reason and blame.
    redone: BTreeMap<(usize, Cause, Blame), Redo>,
    /// The keys that have other values than in the configuration that the store was made with.
    changes: Vec<KeyChange>,
    /// Whether there are such keys, or nobody knows what the store was made with.
    differs: bool,
    /// Scenes that the plan has not yet.
    added: Vec<u32>,
}

/// A core makes about so many bytes a second: for work that the forecast knows nothing of.
const BYTES_PER_CORE_S: f64 = 16e6;

/// Which stages are about to run, and what the plan would be.
pub(crate) struct Intent<'a> {
    /// The stages, with all that are made from what they make.
    pub(crate) stages: Vec<&'static StageSpec>,
    /// None: all scenes.
    pub(crate) scenes: Option<BTreeSet<u32>>,
    /// Digests of the scenes of the plan that would be made; none: the plan stays.
    pub(crate) sections: Option<BTreeMap<u32, String>>,
    pub(crate) code: CodeRule,
    pub(crate) status: Status<'a>,
}

impl Foresight {
    /// What a run of all stages would make again as the plan stands.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn of_plan(store: &Store, editions: &Editions, programs: &Programs) -> Result<Self, StateError> {
        let intent = Intent {
            stages: Graph::get().stages.iter().collect(),
            scenes: None,
            sections: None,
            code: CodeRule::Same,
            status: Status::new(store, editions, programs),
        };
        Self::of(store, editions, &intent)
    }

    /// Looks at all that is finished.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn of(store: &Store, editions: &Editions, intent: &Intent<'_>) -> Result<Self, StateError> {
        let planner = Graph::get().planner();
        let plan = manifest_or_stale(store, Scope::Plan, planner.name)?.unwrap_or_default();
        if plan.as_ref().is_some_and(is_imported) {
            return Ok(Self::default());
        }
        let (changes, differs) = editions.changes();
        let mut foresight = Self { changes, differs, ..Self::default() };
        let planned: BTreeMap<u32, Option<String>> = match &plan {
            Some(plan) => sections_of(plan).map(|(scene, digest)| (scene, Some(digest))).collect(),
            // It was lost: whatever was made of scenes is there.
            None => store::scenes_begun(store)?.into_iter().map(|scene| (scene, None)).collect(),
        };
        let wanted = intent.sections.iter().flat_map(BTreeMap::keys);
        foresight.added = wanted.filter(|scene| !planned.contains_key(scene)).copied().collect();
        let stages = Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene);
        let stages: Vec<&'static StageSpec> = stages.collect();
        let mut costs = Costs::default();
        for (scene, planned) in &planned {
            if intent.scenes.as_ref().is_some_and(|scenes| !scenes.contains(scene)) {
                continue;
            }
            let now = match &intent.sections {
                Some(sections) => sections.get(scene),
                None => planned.as_ref(),
            };
            // What is not planned any more stays as it is.
            let Some(now) = now else { continue };
            let settings = editions.of(Scope::Scene(*scene));
            for (stage, redo) in
                foresight.of_scene(store, (&stages, editions), intent, (*scene, planned, now))?
            {
                let mut work = match &redo.changed {
                    None => Work { bytes: 0.0, ..costs.of(store, plan.as_ref(), editions, (*scene, stage)) },
                    Some(changed) => costs.of_tables(store, plan.as_ref(), settings, (*scene, changed)),
                };
                work.bytes = work.bytes.max(redo.bytes);
                work.core_s = work.core_s.max(redo.bytes / BYTES_PER_CORE_S);
                let position = Graph::get().stages.iter().position(|s| s.name == stage).unwrap_or_default();
                let all = foresight.redone.entry((position, redo.cause, redo.blame)).or_default();
                all.scenes.push(*scene);
                all.work += work;
            }
        }
        Ok(foresight)
    }

    /// The finished stages of a scene that would be made again, out of all.
    fn of_scene(
        &self,
        store: &Store,
        (stages, editions): (&[&'static StageSpec], &Editions),
        intent: &Intent<'_>,
        (scene, planned, now): (u32, &Option<String>, &String),
    ) -> Result<Vec<(&'static str, Finished)>, StateError> {
        let (planner, scope) = (Graph::get().planner().name, Scope::Scene(scene));
        let settings = editions.of(scope);
        let mut redone: BTreeMap<&'static str, (Blame, Option<BTreeSet<String>>)> = BTreeMap::new();
        let mut manifests: BTreeMap<&'static str, Manifest> = BTreeMap::new();
        let mut found = Vec::new();
        for &stage in stages {
            let manifest = manifest_or_stale(store, scope, stage.name)?.unwrap_or_default();
            let Some(manifest) = manifest.filter(|manifest| !is_imported(manifest)) else { continue };
            let shards = shards_of(stage)?;
            let part = |input: &StageSpec| {
                let read = manifests.get(input.name)?.clone();
                Some((shards.part)(settings, scope, read))
            };
            let made_of = manifest.inputs.get(planner);
            let input = stage.inputs().find_map(|input| {
                let (blame, changed) = redone.get(input.name)?;
                let is_read = |changed: &BTreeSet<String>| {
                    part(input).is_none_or(|part| changed.iter().any(|key| part.has(key)))
                };
                changed.as_ref().is_none_or(is_read).then_some((input.name, *blame))
            });
            // Made again already, by whoever was asked then.
            let renewed = stage.inputs().find(|input| {
                let then = manifest.inputs.get(input.name);
                part(input).is_some_and(|part| !then.is_some_and(|then| part.is(then)))
            });
            let cause = if made_of.is_some_and(|digest| digest != now) {
                // Where the plan was made anew already, whoever did that was asked.
                let is_asked = planned.is_some() && made_of != planned.as_ref();
                Some((Cause::Plan, if is_asked { Blame::Nothing } else { Blame::Configuration }))
            } else if manifest.config_hash != config_hash(stage, editions, scope)? {
                let blame = if self.differs { Blame::Configuration } else { Blame::Nothing };
                Some((Cause::Configuration, blame))
            } else if let Some((name, blame)) = input {
                Some((Cause::Input(name), blame))
            } else if let Some(input) = renewed {
                Some((Cause::Input(input.name), Blame::Nothing))
            } else {
                code_cause(intent, stage.name, &manifest)
                    .map(|why| (Cause::Code(why.to_string()), Blame::Code))
            };
            if let Some((cause, blame)) = cause {
                let is_by_settings = cause == Cause::Configuration && input.is_none() && renewed.is_none();
                let changed = if is_by_settings && code_cause(intent, stage.name, &manifest).is_none() {
                    let made_from = |scene, agents: &[AgentId]| (shards.made_from)(settings, scene, agents);
                    shards::changed(made_from, scene, &manifest)?
                } else {
                    None
                };
                redone.insert(stage.name, (blame, changed.clone()));
                if intent.stages.iter().any(|wanted| wanted.name == stage.name) {
                    let is_redone = |output: &&Output| {
                        changed.as_ref().is_none_or(|changed| changed.contains(&output.key))
                    };
                    let redone = manifest.outputs.iter().filter(is_redone);
                    let bytes = redone.map(|output| output.bytes as f64).sum();
                    found.push((stage.name, Finished { cause, blame, bytes, changed }));
                }
            }
            manifests.insert(stage.name, manifest);
        }
        Ok(found)
    }

    /// The keys that have other values than those that the store was made with, for people.
    pub fn changed(&self) -> impl Iterator<Item = String> {
        self.changes.iter().map(|change| format!("changed: {change}"))
    }

    /// The scenes that the plan has not yet, for people.
    #[must_use]
    pub fn added(&self) -> Option<String> {
        let count = if self.added.len() == 1 { "scene" } else { "scenes" };
        (!self.added.is_empty()).then(|| format!("{count} {}", ranges(&self.added)))
    }

    /// Estimated work that would be made again by some blame at least, seconds of one core; none where there
    /// is no such work.
    pub(crate) fn blamed_s(&self, least: Blame) -> Option<f64> {
        let blamed = self.redone.iter().filter(|((_, _, blame), _)| *blame >= least);
        blamed.map(|(_, redo)| redo.work.core_s).reduce(|a, b| a + b)
    }

    /// Whether anything would be made again by just this blame.
    pub(crate) fn blames(&self, what: Blame) -> bool {
        self.redone.keys().any(|(_, _, blame)| *blame == what)
    }

    /// What would be made again, for people: a line for each stage and reason, with the stage.
    #[must_use]
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = Vec::new();
        for ((stage, cause, _), Redo { scenes, work }) in &self.redone {
            let stage = Graph::get().stages.get(*stage).map_or("", |stage| stage.name);
            let count = if scenes.len() == 1 { "scene" } else { "scenes" };
            let line = format!(
                "{stage}: {count} {} ({cause}), about {} of one core, {}",
                ranges(scenes),
                duration(work.core_s),
                DecimalBytes(work.bytes.round() as u64)
            );
            lines.push((stage, line));
        }
        lines
    }
}

/// Seconds in words of a fitting unit, one at least.
fn duration(seconds: f64) -> String {
    let (amount, unit) = span(seconds.max(1.0));
    format!("{amount} {unit}")
}

/// Ascending numbers as `0-3, 7`.
fn ranges(numbers: &[u32]) -> String {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let run = |(a, b): &(u32, u32)| if a == b { a.to_string() } else { format!("{a}-{b}") };
    runs.iter().map(run).collect::<Vec<_>>().join(", ")
}

/// Scenes of a plan with their digests.
fn sections_of(plan: &Manifest) -> impl Iterator<Item = (u32, String)> {
    plan.sections.iter().filter_map(|(name, digest)| {
        let scene = name.strip_prefix("scene/")?.parse().ok()?;
        (plan_section(scene) == *name).then(|| (scene, digest.clone()))
    })
}

/// Why a manifest is not of the code of now.
fn code_cause(intent: &Intent<'_>, stage: &str, manifest: &Manifest) -> Option<Staleness> {
    match intent.code {
        CodeRule::Any => None,
        CodeRule::Same => intent.status.is_of_code(stage, manifest).err(),
    }
}

/// Work by scene and stage; the plan is read when it is asked for first.
#[derive(Default)]
struct Costs {
    scenes: Option<BTreeMap<u32, BTreeMap<&'static str, Work>>>,
    /// Agents of each scene, with its frames.
    agents: Option<BTreeMap<u32, Vec<(AgentId, u32)>>>,
}

impl Costs {
    /// By the forecast's rates; nothing where the plan's tables cannot be read.
    fn of(
        &mut self,
        store: &Store,
        plan: Option<&Manifest>,
        editions: &Editions,
        (scene, stage): (u32, &str),
    ) -> Work {
        let read = || plan.and_then(|plan| Self::read(store, plan, editions).ok()).unwrap_or_default();
        let scenes = self.scenes.get_or_insert_with(read);
        scenes.get(&scene).and_then(|stages| stages.get(stage).copied()).unwrap_or_default()
    }

    /// The same of some tables of sensors, by their keys.
    fn of_tables(
        &mut self,
        store: &Store,
        plan: Option<&Manifest>,
        settings: &DatasetSettings,
        (scene, tables): (u32, &BTreeSet<String>),
    ) -> Work {
        let read = || plan.and_then(|plan| Self::agents(store, plan).ok()).unwrap_or_default();
        let (rigs, mut all) = (settings.scenario.rigs(), Work::default());
        for &(agent, frames) in self.agents.get_or_insert_with(read).get(&scene).into_iter().flatten() {
            let is_wanted = |name: &str| tables.contains(&keys::sensor(scene, agent, name));
            all += work_of_sensors(&rigs.of(agent).of_tables(is_wanted), frames);
        }
        all
    }

    fn agents(store: &Store, plan: &Manifest) -> Result<BTreeMap<u32, Vec<(AgentId, u32)>>, StoreError> {
        let scenes: Vec<PlanSceneRow> = store.read_rows(plan, keys::PLAN_SCENES)?;
        let agents: Vec<PlanAgentRow> = store.read_rows(plan, keys::PLAN_AGENTS)?;
        let frames: BTreeMap<u32, u32> = scenes.iter().map(|row| (row.scene, row.frames)).collect();
        let mut found: BTreeMap<u32, Vec<(AgentId, u32)>> = BTreeMap::new();
        for agent in &agents {
            if let Some(frames) = frames.get(&agent.scene) {
                found.entry(agent.scene).or_default().push((agent.agent, *frames));
            }
        }
        Ok(found)
    }

    fn read(
        store: &Store,
        plan: &Manifest,
        editions: &Editions,
    ) -> Result<BTreeMap<u32, BTreeMap<&'static str, Work>>, StoreError> {
        let mut costs: BTreeMap<u32, BTreeMap<&'static str, Work>> = BTreeMap::new();
        for (scene, agents) in Self::agents(store, plan)? {
            let (of_scene, settings) = (costs.entry(scene).or_default(), editions.of(Scope::Scene(scene)));
            for (agent, frames) in agents {
                for (stage, work) in work_by_stage(settings, agent, frames) {
                    *of_scene.entry(stage).or_default() += work;
                }
            }
        }
        Ok(costs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_times_are_for_people() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2, 5, 7-8");
        assert_eq!(ranges(&[]), "");
        assert_eq!([0.2, 12.4, 600.0, 7200.0].map(duration), ["1 s", "12 s", "10 minutes", "2.0 hours"]);
    }
}
