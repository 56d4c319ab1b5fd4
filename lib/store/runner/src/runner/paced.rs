//! How far the scenes of a stage, and the stages of its run, have to go yet: for the time that is left.

use store::Scope;

use super::{Looked, Run};
use crate::ProgressMode;
use crate::costs::{Costs, PlannedWork};
use crate::error::StageError;
use crate::forecast::Machine;
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::pace::{InRun, Pace};
use crate::seen::StageSettings;
use crate::state::State;

/// So little work of later stages is not told, and no time is spent on how fast the machine is, core seconds.
const LITTLE_S: f64 = 60.0;

impl<S: StageSettings> Run<'_, S> {
    /// At the first of the scopes that are about to be made.
    pub(super) fn pace(&self, looked: &[Looked]) -> Result<Pace, StageError> {
        let made: Vec<Scope> =
            looked.iter().filter(|of_scope| self.is_made(of_scope)).map(|of_scope| of_scope.scope).collect();
        if self.spec.unit != UnitKind::Scene || self.progress == ProgressMode::None || made.is_empty() {
            return Ok(Pace::of(made.len()));
        }
        // An estimate is worth no error.
        let plan = self.status().plan()?;
        let planned = plan.sound().and_then(|plan| Costs::read(&self.store, plan, &self.editions).ok());
        let planned = planned.unwrap_or_default();
        let of_scope = |scope: &Scope| work_s(&planned, *scope, S::STAGE);
        Ok(Pace::over(made.iter().map(of_scope).collect(), self.in_run(&planned, looked)?))
    }

    /// Which stage of its run it is, and what the later ones have to do for its scenes.
    fn in_run(&self, planned: &PlannedWork, looked: &[Looked]) -> Result<Option<InRun>, StageError> {
        let Some(at) = self.in_run.iter().position(|name| name == S::STAGE) else { return Ok(None) };
        let later: Vec<&StageSpec> =
            self.in_run[at + 1..].iter().filter_map(|name| Graph::get().stage(name)).collect();
        let followers = self.spec.with_followers();
        let is_follower = |stage: &StageSpec| followers.iter().any(|follower| follower.name == stage.name);
        let status = self.status().by_code(self.code());
        let ahead = status.side_by_side(looked, |of_scope| {
            let survey = status.survey(of_scope.scope);
            let mut core_s = 0.0;
            for stage in later.iter().filter(|stage| stage.unit == UnitKind::Scene) {
                // What is made of this stage's work is made, or made again.
                let is_redone = self.is_made(of_scope) && is_follower(stage);
                if is_redone || survey.state(stage)? != State::Done {
                    core_s += work_s(planned, of_scope.scope, stage.name);
                }
            }
            Ok::<_, StageError>(core_s)
        })?;
        let ahead_s: f64 = ahead.iter().sum();
        let ahead_s = if ahead_s > LITTLE_S {
            let Machine { times, .. } = Machine::measured();
            ahead_s * times / rayon::current_num_threads().max(1) as f64
        } else {
            0.0
        };
        Ok(Some(InRun { stage: at + 1, stages: self.in_run.len(), ahead_s }))
    }
}

/// Seconds of one core for a stage of a scene, by the forecast.
fn work_s(planned: &PlannedWork, scope: Scope, stage: &str) -> f64 {
    let Scope::Scene(scene) = scope else { return 0.0 };
    planned.get(&scene).and_then(|stages| stages.get(stage)).map_or(0.0, |work| work.core_s)
}
