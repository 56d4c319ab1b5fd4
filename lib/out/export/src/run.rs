//! Makes an export: what is missing of it, unit by unit, then what is common to all.

use std::sync::atomic::{AtomicU64, Ordering};

use store::hash_bytes;

use crate::asked::Asked;
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
    asked: Asked,
    /// Whether an export with other options gives way.
    force: bool,
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
    /// Frames of agents made: as many as the plan's cost says.
    pub agent_frames: u64,
}

/// Counts what is told to a watch.
struct Counted<'a> {
    watch: &'a dyn ProgressWatch,
    done: AtomicU64,
}

impl ProgressWatch for Counted<'_> {
    fn advance(&self, agent_frames: u64) -> bool {
        self.done.fetch_add(agent_frames, Ordering::Relaxed);
        self.watch.advance(agent_frames)
    }
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
    let asked = Asked::of(layout, &source.selection);
    place.claim(&asked, force)?;
    let (mut units, mut cost, mut done) = (Vec::new(), Cost::default(), 0);
    for scene in &source.scenes {
        for unit in layout.units(scene) {
            let others = layout.of_others(scene, unit)?.map_or(String::new(), |words| format!("\n{words}"));
            let own = format!("{}\n{code_version}\n{}{others}", asked.identity, scene.digest());
            let identity = hash_bytes(own.as_bytes());
            if !force && place.is_done(unit, &identity)? {
                done += 1;
                continue;
            }
            cost += layout.cost(scene, unit)?;
            units.push((unit, identity));
        }
    }
    Ok(Plan { units, cost, done, omissions, asked, force })
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
/// Another export is at work there, or the first error in the order of units; what is finished is kept.
pub fn export(
    layout: &dyn Layout,
    source: &Source,
    place: &Destination,
    plan: &Plan,
    watch: &dyn ProgressWatch,
) -> Result<Outcome, ExportError> {
    let _lock = place.lock()?;
    // Another export may have been at work there since the plan was made.
    if place.claim(&plan.asked, plan.force)? {
        place.forget_all()?;
    }
    place.declare(&plan.asked)?;
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
    let counted = Counted { watch, done: AtomicU64::new(0) };
    work::make(&jobs, layout.is_parallel_inside(), (place, &counted), &write)?;
    let mut fragments = Vec::new();
    for unit in place.finished()? {
        if let Some(fragment) = place.fragment(unit)? {
            fragments.push((unit, fragment));
        }
    }
    let mut files = place.begin_common(&counted)?;
    layout.finish(source, &fragments, &mut files)?;
    place.end_common(files)?;
    let agent_frames = counted.done.load(Ordering::Relaxed);
    Ok(Outcome { made: plan.units.len(), units: fragments.len(), agent_frames })
}
