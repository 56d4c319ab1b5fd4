//! Makes an export: what is missing of it, unit by unit, then what is common to all.

use store::hash_bytes;

use crate::layout::Cost;
use crate::unit::{ProgressWatch, UnitName};
use crate::work::{self, Job};
use crate::{Destination, ExportError, Layout, Omission, SceneSource, Source, UnitFiles};

/// What an export will come to.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The units that are to be made, in order.
    units: Vec<(UnitName, String)>,
    /// What they come to together.
    pub cost: Cost,
    /// How many units are there already.
    pub done: usize,
    /// What is left out of the store's content, and why.
    pub omissions: Vec<Omission>,
    options: String,
    /// Whether an export with other options gives way.
    replaces: bool,
}

impl Plan {
    /// How many units are to be made.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.units.len()
    }
}

/// What an export came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Units made.
    pub made: usize,
    /// Units in the destination, those of earlier runs among them.
    pub units: usize,
}

/// Looks what of an export is missing. Writes nothing. With `force` everything is made again.
///
/// # Errors
/// The layout refuses, the destination holds something else, or something cannot be read.
pub fn plan(
    layout: &dyn Layout,
    source: &Source,
    place: &Destination,
    code_version: &str,
    force: bool,
) -> Result<Plan, ExportError> {
    if source.scenes.is_empty() {
        let why: Vec<String> =
            source.unfinished.iter().map(|(scene, why)| format!("scene {scene}: {why}")).collect();
        let why = if why.is_empty() { "none is wanted".to_owned() } else { why.join(", ") };
        return Err(ExportError::Refused(format!("there is no finished scene to export ({why})")));
    }
    let mut omissions = layout.preflight(source)?;
    omissions.extend(never_had(source));
    let options = format!("{}; {}; {}", layout.name(), layout.options(), source.selection.identity());
    let replaces = place.claim(&options, force)?;
    let (mut units, mut cost, mut done) = (Vec::new(), Cost::default(), 0);
    for scene in &source.scenes {
        for unit in layout.units(scene) {
            let identity = hash_bytes(format!("{options}\n{code_version}\n{}", scene.digest()).as_bytes());
            if !force && place.is_done(unit, &identity)? {
                done += 1;
                continue;
            }
            cost += layout.cost(scene, unit)?;
            units.push((unit, identity));
        }
    }
    Ok(Plan { units, cost, done, omissions, options, replaces })
}

/// What imported scenes have only zeros of.
fn never_had(source: &Source) -> Option<Omission> {
    let what = "rings, intensities and times of points, ids and tags of those of lidars and radars (semantic lidars have theirs), cross-sections";
    let why = "scenes that were imported never had them: they are 0 where the layout has a place for them";
    source.scenes.iter().any(SceneSource::is_imported).then(|| Omission::new(what, why))
}

/// Makes what a plan says, on the threads of the pool that it is called in. The files do not depend on their
/// number.
///
/// # Errors
/// The first error in the order of units; what is finished is kept.
pub fn export(
    layout: &dyn Layout,
    source: &Source,
    place: &Destination,
    plan: &Plan,
    watch: &dyn ProgressWatch,
) -> Result<Outcome, ExportError> {
    if plan.replaces {
        place.forget_all()?;
    }
    place.declare(&plan.options)?;
    place.tidy()?;
    let scene_of = |unit: &UnitName| source.scenes.iter().find(|scene| scene.number() == unit.scene);
    let job = |(unit, identity): &(UnitName, String)| {
        let pieces = scene_of(unit).map_or(1, |scene| layout.pieces(scene, *unit).max(1));
        Job { unit: *unit, identity: identity.clone(), pieces }
    };
    let jobs: Vec<Job> = plan.units.iter().map(job).collect();
    let write = |job: &Job, piece: u32, files: &mut UnitFiles<'_>| match scene_of(&job.unit) {
        Some(scene) => layout.write_piece(scene, job.unit, piece, files),
        None => Ok(Vec::new()),
    };
    work::make(&jobs, layout.is_parallel_inside(), (place, watch), &write)?;
    let mut fragments = Vec::new();
    for unit in place.finished()? {
        if let Some(fragment) = place.fragment(unit)? {
            fragments.push((unit, fragment));
        }
    }
    let mut files = place.files(watch);
    layout.finish(source, &fragments, &mut files)?;
    place.sync()?;
    Ok(Outcome { made: plan.units.len(), units: fragments.len() })
}
