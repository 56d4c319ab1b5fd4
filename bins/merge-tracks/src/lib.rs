//! The merging stage: one list of unique objects per frame, tracks over the scene.

use pipeline::{At, Job, Stage, StageError};
use scene::SceneReader;
use schema::settings::TrackSettings;
use schema::tables::{BoxRow, ValidBoxRow};
use store::keys;

/// The stage.
pub const STAGE: Stage<TrackSettings> = Stage::new(run);

fn run(job: &mut Job<'_, TrackSettings>) -> Result<(), StageError> {
    let (number, place, settings) = (job.scene(), job.place(), job.settings().clone());
    let scene = SceneReader::new(job.store(), number, job.inputs());
    let boxes: Vec<BoxRow> = scene.rows().at(|| place.clone())?;
    let valid: Vec<ValidBoxRow> = scene.rows().at(|| place.clone())?;
    let info = scene.info().at(|| place.clone())?;

    let merged = tracks::merge(&boxes, &valid, info.label_every_n_frames).at(|| place.clone())?;
    let counts = tracks::count(&merged.frames, info.frames, info.label_every_n_frames);
    if let Some(mut unit) = job.unit("tracks")? {
        unit.rows(&keys::scene(number, "tracks.parquet"), &merged.tracks)?;
        unit.rows(&keys::scene(number, "tracks_frames.parquet"), &merged.frames)?;
        unit.rows(&keys::scene(number, "tracks_agents.parquet"), &merged.sightings)?;
        if settings.windows {
            let windows = tracks::windows(&merged.frames, &settings);
            unit.rows(&keys::scene(number, "tracks_windows.parquet"), &windows)?;
        }
        unit.rows(&keys::partial_stats(number, Stage::<TrackSettings>::NAME), &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}
