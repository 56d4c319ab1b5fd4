//! The merging stage: one list of unique objects per frame, tracks over the scene.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::process::ExitCode;

use runner::{At, Job, Stage, StageError};
use scene::SceneReader;
use schema::tables::{ActorRow, BoxRow, ValidBoxRow};
use schema::{ActorKind, ObjectId};
use settings::TrackSettings;
use store::keys;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<TrackSettings> = Stage::new(run);

fn run(job: &mut Job<'_, TrackSettings>) -> Result<(), StageError> {
    let (number, place, settings) = (job.scene(), job.place(), job.settings().clone());
    let scene = SceneReader::new(job.store(), number, job.inputs());
    let boxes: Vec<BoxRow> = scene.rows().at(|| place.clone())?;
    let valid: Vec<ValidBoxRow> = scene.rows().at(|| place.clone())?;
    let actors: Vec<ActorRow> = scene.rows().at(|| place.clone())?;
    let info = scene.info().at(|| place.clone())?;
    // Boxes of walkers follow their poses.
    let walkers = actors.iter().filter(|actor| actor.kind == ActorKind::Walker);
    let standing_m: BTreeMap<ObjectId, [f64; 3]> =
        walkers.map(|actor| (actor.id, [actor.length_m, actor.width_m, actor.height_m])).collect();

    let mut merged = labels::tracks::merge(&boxes, &valid, info.label_every_n_frames).at(|| place.clone())?;
    let counts = labels::tracks::count(&merged.frames, info.frames, info.label_every_n_frames);
    let mut windows =
        if settings.windows { labels::tracks::windows(&merged.frames, &settings) } else { Vec::new() };
    labels::tracks::stand(&mut merged.tracks, &mut windows, &standing_m);
    if let Some(mut unit) = job.unit("tracks")? {
        unit.put(number, &merged.tracks)?;
        unit.put(number, &merged.frames)?;
        unit.put(number, &merged.sightings)?;
        if settings.windows {
            unit.put(number, &windows)?;
        }
        unit.rows(&keys::partial_stats(number, Stage::<TrackSettings>::NAME), &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}
