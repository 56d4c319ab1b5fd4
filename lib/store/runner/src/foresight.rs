//! What a run would make again although it is finished, and why. Nothing is replaced by a slip: what a
//! changed configuration or other code makes stale is asked about first.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use indicatif::DecimalBytes;
use schema::AgentId;
use settings::{KeyChange, change_lines};
use store::{Manifest, Output, Scope};

use crate::costs::Costs;
use crate::editions::Editions;
use crate::forecast::{Work, span};
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::record::Record;
use crate::shards::{self, Part};
use crate::state::{CodeRule, Staleness, StateError, plan_section};
use crate::status::Status;
use crate::survey::{Survey, scene_stages};
use crate::views::shards_of;

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
pub(crate) struct Finished {
    stage: &'static str,
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
    /// Scenes that the plan has not yet.
    added: Vec<u32>,
}

/// A core makes about so many bytes a second: for work that the forecast knows nothing of.
const BYTES_PER_CORE_S: f64 = 16e6;

/// Which stages are about to run, and what the plan would be.
pub(crate) struct Intent<'a> {
    /// The stages, with all that are made from what they make.
    pub(crate) stages: Vec<&'static StageSpec>,
    /// Digests of the scenes of the plan that would be made; none: the plan stays.
    pub(crate) sections: Option<BTreeMap<u32, String>>,
    pub(crate) code: CodeRule,
    pub(crate) status: Status<'a>,
}

impl<'a> Intent<'a> {
    /// All stages are about to run as the plan stands.
    pub(crate) fn to_run_all(status: Status<'a>) -> Self {
        Self { stages: Graph::get().stages.iter().collect(), sections: None, code: CodeRule::Same, status }
    }

    /// Why a manifest is not of the code of now.
    fn code_cause(&self, stage: &str, manifest: &Manifest) -> Option<Staleness> {
        match self.code {
            CodeRule::Any => None,
            CodeRule::Same => self.status.is_of_code(stage, manifest).err(),
        }
    }
}

impl Foresight {
    /// Looks at all that is finished.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn of(intent: &Intent<'_>, editions: &Editions) -> Result<Self, StateError> {
        Foreseer::new(intent, editions)?.map_or_else(|| Ok(Self::default()), Foreseer::all)
    }

    /// The keys that have other values than those that the store was made with, for people.
    #[must_use]
    pub fn changed(&self) -> Vec<String> {
        change_lines(&self.changes)
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

/// Looks at finished scenes, one by one and side by side.
pub(crate) struct Foreseer<'a> {
    intent: &'a Intent<'a>,
    editions: &'a Editions,
    /// The scenes that the plan has, with their digests; none where it was lost.
    planned: BTreeMap<u32, Option<String>>,
    changes: Vec<KeyChange>,
    /// Whether there are such keys, or nobody knows what the store was made with.
    differs: bool,
}

impl<'a> Foreseer<'a> {
    /// None of an import, which cannot be made again.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn new(intent: &'a Intent<'a>, editions: &'a Editions) -> Result<Option<Self>, StateError> {
        let plan = intent.status.plan()?;
        if plan.sound().is_some_and(is_imported) {
            return Ok(None);
        }
        let (changes, differs) = editions.changes();
        let planned = match plan.sound() {
            Some(plan) => sections_of(plan).map(|(scene, digest)| (scene, Some(digest))).collect(),
            // It was lost: whatever was made of scenes is there.
            None => {
                store::scenes_begun(intent.status.store())?.into_iter().map(|scene| (scene, None)).collect()
            }
        };
        Ok(Some(Self { intent, editions, planned, changes, differs }))
    }

    /// Looks at all scenes.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn all(self) -> Result<Foresight, StateError> {
        let scenes: Vec<u32> = self.planned.keys().copied().collect();
        let looked = self.intent.status.side_by_side(&scenes, |&scene| {
            let survey = self.intent.status.survey(Scope::Scene(scene));
            Ok::<_, StateError>((scene, self.look(&survey, scene)?))
        })?;
        self.sum(looked)
    }

    /// Digests of a scene's plan: as the plan stands, and as it would be made. What is not planned any more
    /// stays as it is.
    fn digests(&self, scene: u32) -> Option<(&Option<String>, &String)> {
        let planned = self.planned.get(&scene)?;
        let now = match &self.intent.sections {
            Some(sections) => sections.get(&scene),
            None => planned.as_ref(),
        };
        Some((planned, now?))
    }

    /// The finished stages of a scene that would be made again, out of all.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn look(&self, survey: &Survey<'_>, scene: u32) -> Result<Vec<Finished>, StateError> {
        let Some((planned, now)) = self.digests(scene) else { return Ok(Vec::new()) };
        let (intent, planner, scope) = (self.intent, Graph::get().planner().name, Scope::Scene(scene));
        let settings = self.editions.of(scope);
        let mut redone: BTreeMap<&'static str, (Blame, Option<BTreeSet<String>>)> = BTreeMap::new();
        let mut found = Vec::new();
        for stage in scene_stages() {
            let record = survey.record(stage.name)?;
            let Some(manifest) = made_here(&record) else { continue };
            let shards = shards_of(stage)?;
            let mut parts: BTreeMap<&'static str, Part> = BTreeMap::new();
            for input in stage.inputs().filter(|input| input.unit == UnitKind::Scene) {
                let record = survey.record(input.name)?;
                if made_here(&record).is_some() {
                    parts.insert(input.name, (shards.part)(settings, scope, &record));
                }
            }
            let made_of = manifest.inputs.get(planner);
            let input = stage.inputs().find_map(|input| {
                let (blame, changed) = redone.get(input.name)?;
                let is_read = |changed: &BTreeSet<String>| {
                    parts.get(input.name).is_none_or(|part| changed.iter().any(|key| part.has(key)))
                };
                changed.as_ref().is_none_or(is_read).then_some((input.name, *blame))
            });
            // Made again already, by whoever was asked then.
            let renewed = stage.inputs().map(|input| input.name).find(|input| {
                let then = manifest.inputs.get(*input);
                parts.get(input).is_some_and(|part| !then.is_some_and(|then| part.is(then)))
            });
            let cause = if made_of.is_some_and(|digest| digest != now) {
                // Where the plan was made anew already, whoever did that was asked.
                let is_asked = planned.is_some() && made_of != planned.as_ref();
                Some((Cause::Plan, if is_asked { Blame::Nothing } else { Blame::Configuration }))
            } else if intent
                .status
                .config_hash(stage, scope)?
                .is_some_and(|hash| manifest.config_hash != hash)
            {
                let blame = if self.differs { Blame::Configuration } else { Blame::Nothing };
                Some((Cause::Configuration, blame))
            } else if let Some((name, blame)) = input {
                Some((Cause::Input(name), blame))
            } else if let Some(input) = renewed {
                Some((Cause::Input(input), Blame::Nothing))
            } else {
                intent.code_cause(stage.name, manifest).map(|why| (Cause::Code(why.to_string()), Blame::Code))
            };
            let Some((cause, blame)) = cause else { continue };
            let is_by_settings = cause == Cause::Configuration && input.is_none() && renewed.is_none();
            let changed = if is_by_settings && intent.code_cause(stage.name, manifest).is_none() {
                let made_from = |scene, agents: &[AgentId]| (shards.made_from)(settings, scene, agents);
                shards::changed(made_from, scene, manifest)?
            } else {
                None
            };
            redone.insert(stage.name, (blame, changed.clone()));
            if intent.stages.iter().any(|wanted| wanted.name == stage.name) {
                let is_redone =
                    |output: &&Output| changed.as_ref().is_none_or(|changed| changed.contains(&output.key));
                let bytes = manifest.outputs.iter().filter(is_redone).map(|output| output.bytes as f64).sum();
                found.push(Finished { stage: stage.name, cause, blame, bytes, changed });
            }
        }
        Ok(found)
    }

    /// All that was found in scenes, in their order.
    ///
    /// # Errors
    /// The store cannot be read.
    pub(crate) fn sum(self, found: Vec<(u32, Vec<Finished>)>) -> Result<Foresight, StateError> {
        let Self { intent, editions, planned, changes, .. } = self;
        let mut foresight = Foresight { changes, ..Foresight::default() };
        let wanted = intent.sections.iter().flat_map(BTreeMap::keys);
        foresight.added = wanted.filter(|scene| !planned.contains_key(scene)).copied().collect();
        let (store, plan) = (intent.status.store(), intent.status.plan()?);
        let mut costs = Costs::default();
        for (scene, found) in found {
            for Finished { stage, cause, blame, bytes, changed } in found {
                let settings = editions.of(Scope::Scene(scene));
                let mut work = match &changed {
                    None => Work { bytes: 0.0, ..costs.of(store, plan.sound(), editions, (scene, stage)) },
                    Some(changed) => costs.of_tables(store, plan.sound(), settings, (scene, changed)),
                };
                work.bytes = work.bytes.max(bytes);
                work.core_s = work.core_s.max(bytes / BYTES_PER_CORE_S);
                let position = Graph::get().stages.iter().position(|s| s.name == stage).unwrap_or_default();
                let all = foresight.redone.entry((position, cause, blame)).or_default();
                all.scenes.push(scene);
                all.work += work;
            }
        }
        Ok(foresight)
    }
}

/// A manifest of what was made here, not imported.
fn made_here(record: &Record) -> Option<&Manifest> {
    record.sound().filter(|manifest| !is_imported(manifest))
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
