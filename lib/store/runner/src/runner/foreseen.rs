//! What a stage looks at before it makes anything: how its scopes are, and what of finished work it would
//! make again.

use std::path::Path;

use settings::Fault;
use store::Scope;

use super::{Looked, Run, say};
use crate::EXIT_DONE;
use crate::agreement::{Terms, agree};
use crate::editions;
use crate::error::StageError;
use crate::foresight::{Blame, Foreseer, Foresight, Intent};
use crate::graph::UnitKind;
use crate::imported::{self, is_imported};
use crate::seen::StageSettings;
use crate::state::State;

impl<S: StageSettings> Run<'_, S> {
    /// How each scope is, and what of it is finished and would be made again: by this stage, or, as all
    /// follows from the plan, by all stages. What `--force` asks for is no slip.
    pub(super) fn look(&self, scopes: &[Scope]) -> Result<(Vec<Looked>, Foresight), StageError> {
        let (sources, status) = (self.sources(), self.status().by_code(self.code()));
        let is_plan = self.spec.unit == UnitKind::Plan;
        let is_foreseen = self.spec.unit == UnitKind::Scene && !self.force;
        let intent = Intent { stages: self.spec.with_followers(), ..self.intent() };
        let foreseer = Foreseer::new(&intent, &self.editions)?.filter(|_| is_foreseen);
        let of_scope = |&scope: &Scope| {
            let survey = status.survey(scope);
            let state = self.state_of(&survey, &sources)?;
            let is_untidy = state == State::Done && survey.is_untidy(S::STAGE)?;
            let is_kept = state == State::Done && !self.force;
            let is_imported = match imported::origin(self.spec) {
                Some(origin) => !is_kept && survey.record(origin)?.sound().is_some_and(is_imported),
                None => false,
            };
            let found = match (&foreseer, scope) {
                (Some(foreseer), Scope::Scene(scene)) => Some((scene, foreseer.look(&survey, scene)?)),
                _ => None,
            };
            Ok::<_, StageError>((Looked { scope, state, is_untidy }, is_imported, found))
        };
        let all = status.side_by_side(scopes, of_scope)?;
        let (mut looked, mut refused, mut found) = (Vec::new(), Vec::new(), Vec::new());
        for (of_scope, is_imported, of_scene) in all {
            refused.extend(is_imported.then_some(of_scope.scope));
            looked.push(of_scope);
            found.extend(of_scene);
        }
        if let Some(why) = imported::refusal(self.spec, &refused) {
            return Err(StageError::usage(why));
        }
        if !self.force {
            self.check_name()?;
        }
        let foresight = match foreseer {
            Some(foreseer) => foreseer.sum(found)?,
            None if is_plan => self.foresee_all(&looked)?,
            None => Foresight::default(),
        };
        Ok((looked, foresight))
    }

    fn intent(&self) -> Intent<'_> {
        Intent { code: self.code(), ..Intent::to_run_all(self.status()) }
    }

    /// What all stages would make again if the plan were made now.
    fn foresee_all(&self, looked: &[Looked]) -> Result<Foresight, StageError> {
        let is_kept = looked.iter().all(|plan| plan.state == State::Done) && !self.force;
        let sections = match self.stage.sections {
            Some(sections) if !is_kept => {
                // Of a fresh store there is nothing to ask.
                if !store::has_scenes(&self.store)? {
                    return Ok(Foresight::default());
                }
                Some(sections(&self.outlook())?)
            }
            _ => None,
        };
        Ok(Foresight::of(&Intent { sections, ..self.intent() }, &self.editions)?)
    }

    /// Refuses a configuration of another dataset.
    fn check_name(&self) -> Result<(), StageError> {
        let is_import = self.status().plan()?.sound().is_some_and(is_imported);
        let recorded = if is_import { Vec::new() } else { editions::recorded(&self.store)? };
        let name = &self.editions.given().name;
        match recorded.last().and_then(|config| config["name"].as_str()) {
            Some(recorded) if recorded != name => Err(StageError::usage(format!(
                "{} holds the dataset `{recorded}`, and this configuration is of `{name}`: give another --store, or --force if \
                 this one is to become that",
                self.store.location("")
            ))),
            _ => Ok(()),
        }
    }

    /// Whether a stage's work is made again by this run, or by those that follow from the plan.
    fn makes(&self, stage: &str) -> bool {
        self.spec.unit == UnitKind::Plan || stage == self.spec.name
    }

    /// Says what is made again, and asks where that is much and the configuration or the code is to blame.
    pub(super) fn agree(&self, foresight: &Foresight) -> Result<(), StageError> {
        let is_told = agree(
            foresight,
            &Terms {
                makes: &|stage| self.makes(stage),
                ask_beyond_s: self.editions.given().store.ask_beyond_s,
                shares: self.shard.map_or(1, |shard| shard.count),
                least: if self.redo_older { Blame::Configuration } else { Blame::Code },
                redo: self.redo,
                may_ask: self.shard.is_none(),
            },
        )?;
        // What was agreed is not asked again, by whoever goes on with it.
        if is_told && foresight.blames(Blame::Configuration) && self.spec.unit == UnitKind::Scene {
            self.renew_record()?;
        }
        Ok(())
    }

    /// What is suspicious in what the stage would make; in what is made already only if that is asked for.
    pub(super) fn suspicions(&self, config: &Path, also_made: bool) -> Result<Vec<Fault>, StageError> {
        let Some(look) = self.stage.suspicions else { return Ok(Vec::new()) };
        if !also_made && !self.force && self.state(Scope::Plan, &self.sources())? == State::Done {
            return Ok(Vec::new());
        }
        let found = look(&self.outlook())?;
        Ok(settings::suspicions_in(config, &found))
    }

    /// Says what would be done.
    pub(super) fn tell(&self, looked: &[Looked], foresight: &Foresight) -> Result<u8, StageError> {
        for (stage, line) in foresight.lines() {
            let verb = if self.makes(stage) { "make again" } else { "make stale" };
            say(&format!("would {verb} {line}"));
        }
        if let Some(added) = foresight.added() {
            say(&format!("would add {added}"));
        }
        foresight.changed().iter().for_each(|line| say(line));
        for Looked { scope, state, .. } in looked {
            let verb = if *state == State::Done && !self.force { "would keep" } else { "would run" };
            say(&format!("{verb} {} ({state})", self.label(*scope)));
        }
        if let Some(forecast) = self.stage.forecast {
            for line in forecast(&self.outlook())? {
                say(&line);
            }
        }
        Ok(EXIT_DONE)
    }
}
