//! The merging stage: one list of unique objects per frame, tracks over the scene.

use pipeline::{At, Job, Stage, StageError, TrackSettings};
use replay::SIMULATE;
use schema::scene_info::SceneInfo;
use schema::tables::{BoxRow, ValidBoxRow};
use store::{StoreError, keys};

/// The stage.
pub const STAGE: Stage<TrackSettings> = Stage::new(run);

fn run(job: &mut Job<'_, TrackSettings>) -> Result<(), StageError> {
    let (scene, store) = (job.scene(), job.store().clone());
    let key = |name: &str| keys::scene(scene, name);
    let boxes: Vec<BoxRow> = store.read_rows(job.input(SIMULATE)?, &key("boxes.parquet"))?;
    let valid: Vec<ValidBoxRow> =
        store.read_rows(job.input("postprocess-valid")?, &key("boxes_valid.parquet"))?;
    let info_key = key("log/scene.json");
    let info: SceneInfo =
        store.read_json(&info_key)?.ok_or_else(|| StoreError::Missing { path: store.location(&info_key) })?;

    let (frames, tracks) = tracks::merge(&boxes, &valid).at(|| job.place())?;
    let counts = tracks::count(&frames, info.frames);
    if let Some(mut unit) = job.unit("tracks")? {
        unit.rows(&key("tracks.parquet"), &tracks)?;
        unit.rows(&key("tracks_frames.parquet"), &frames)?;
        unit.rows(&keys::partial_stats(scene, Stage::<TrackSettings>::NAME), &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}
