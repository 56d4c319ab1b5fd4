//! A whole store, each scene looked at once.

use std::collections::BTreeMap;

use store::{Scope, StoreError};

use crate::costs::PlannedWork;
use crate::error::StageError;

use crate::foresight::{Foreseer, Foresight, Intent};
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::state::{State, StateError};
use crate::status::Status;
use crate::survey::{Inputs, scene_stages};

/// So many scenes are looked at side by side before they are told.
const AT_ONCE: usize = 256;

/// How a store stands.
#[derive(Debug)]
pub struct Overview {
    /// Of the statistics.
    pub stats: Vec<(&'static StageSpec, State)>,
    /// What a run of all stages would make again as the plan stands; nothing of an import.
    pub foresight: Foresight,
}

/// What one look at a store leaves for the next: its plan, and what scenes that are done hold. It is
/// forgotten when there is another plan.
#[derive(Debug, Default)]
pub struct Remembered {
    /// Digest of the plan's manifest.
    plan: String,
    work: Option<PlannedWork>,
    /// Digests that each of the statistics reads of a scene all of whose stages are done.
    done: BTreeMap<u32, Vec<BTreeMap<String, String>>>,
}

impl Remembered {
    fn by_plan(&mut self, status: &Status<'_>) -> Result<(), StoreError> {
        let plan = status.plan()?;
        if self.plan != plan.digest() {
            *self = Self { plan: plan.digest().to_owned(), ..Self::default() };
        }
        Ok(())
    }

    /// The work of each scene of the plan, as [`planned_work`](crate::planned_work) tells it.
    ///
    /// # Errors
    /// The plan's tables cannot be read.
    pub fn work(&mut self, status: &Status<'_>) -> Result<&PlannedWork, StageError> {
        self.by_plan(status)?;
        let work = match self.work.take() {
            Some(work) => work,
            None => crate::planned_work(status)?,
        };
        Ok(self.work.insert(work))
    }
}

/// Looks at all scenes of the plan and tells the states of each one's stages, in running order, scene by
/// scene. Scenes that are remembered as done are not looked at.
///
/// # Errors
/// The store cannot be read.
pub fn overview(
    status: &Status<'_>,
    remembered: &mut Remembered,
    mut tell: impl FnMut(u32, &[State]),
) -> Result<Overview, StateError> {
    remembered.by_plan(status)?;
    let scenes = status.planned_scenes()?;
    let intent = Intent::to_run_all(status.clone());
    let foreseer = status.editions().map(|editions| Foreseer::new(&intent, editions)).transpose()?.flatten();
    let statistics = || Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Stats);
    let mut inputs: Vec<Inputs> = statistics().map(|_| Inputs::default()).collect();
    let mut found = Vec::new();
    for some in scenes.as_deref().unwrap_or_default().chunks(AT_ONCE) {
        let looked = status.side_by_side(some, |&scene| {
            if let Some(digests) = remembered.done.get(&scene) {
                let states = scene_stages().map(|_| State::Done).collect();
                return Ok((scene, states, digests.clone(), Vec::new()));
            }
            let survey = status.survey(Scope::Scene(scene));
            let states = scene_stages().map(|stage| survey.state(stage)).collect::<Result<Vec<_>, _>>()?;
            let digests = statistics().map(|stage| survey.digests_for(stage, scene));
            let digests = digests.collect::<Result<Vec<_>, _>>()?;
            let found = foreseer.as_ref().map(|foreseer| foreseer.look(&survey, scene)).transpose()?;
            Ok::<_, StateError>((scene, states, digests, found.unwrap_or_default()))
        })?;
        for (scene, states, digests, of_scene) in looked {
            tell(scene, &states);
            if states.iter().all(|state| *state == State::Done) {
                remembered.done.entry(scene).or_insert_with(|| digests.clone());
            }
            inputs.iter_mut().zip(digests).for_each(|(inputs, digests)| inputs.digests.extend(digests));
            found.push((scene, of_scene));
        }
    }
    let stats = statistics().zip(inputs).map(|(stage, inputs)| {
        let state = status.survey(Scope::Stats).knowing(inputs).state(stage)?;
        Ok((stage, state))
    });
    let stats = stats.collect::<Result<_, StateError>>()?;
    let foresight = match foreseer {
        // Of a plan that was lost no scenes are known, but what was made of them is there.
        Some(foreseer) if scenes.is_none() => foreseer.all()?,
        Some(foreseer) => foreseer.sum(found)?,
        None => Foresight::default(),
    };
    Ok(Overview { stats, foresight })
}
