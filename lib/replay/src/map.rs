//! Maps and plans in the store.

use std::io::Read;

use opendrive::Map;
use pipeline::{At, Job, Place, StageError, StageSettings};
use schema::tables::{PlanAgentRow, PlanHazardRow, PlanSceneRow};
use store::{Store, keys};

use crate::ReplayError;

/// The stage that writes plan and maps.
pub const PLANNER: &str = "spawn-planner";

/// Largest map text that is believed, bytes.
const MAX_MAP_BYTES: u64 = 1 << 30;

/// A map's text as the store keeps it.
///
/// # Errors
/// The compressor fails.
pub fn compress_map(text: &[u8]) -> Result<Vec<u8>, StageError> {
    zstd::bulk::compress(text, 9).map_err(ReplayError::Pack).at(Place::default)
}

/// The OpenDRIVE text of a map of the store, by its name; `None` when the store has no such map.
///
/// # Errors
/// It cannot be read or unpacked.
pub fn read_map_text(store: &Store, name: &str) -> Result<Option<Vec<u8>>, StageError> {
    let key = keys::map(name);
    let Some(packed) = store.read(&key)? else { return Ok(None) };
    let mut text = Vec::new();
    zstd::Decoder::new(packed.as_slice())
        .and_then(|decoder| decoder.take(MAX_MAP_BYTES).read_to_end(&mut text))
        .map_err(ReplayError::Unpack)
        .at(|| Place::file(store.location(&key)))?;
    Ok(Some(text))
}

/// Reads a map of the store by its name.
///
/// # Errors
/// It is missing, changed, or no OpenDRIVE file.
pub fn read_map(store: &Store, name: &str, hash: &str) -> Result<Map, StageError> {
    let place = || Place::file(store.location(&keys::map(name)));
    let text = read_map_text(store, name)?.ok_or(ReplayError::NoMap).at(place)?;
    if store::hash_bytes(&text) != hash {
        return Err(ReplayError::OtherMap).at(place);
    }
    let network = opendrive::read_bytes(&text).at(place)?;
    Ok(Map::new(network))
}

/// The plan of a job's scene.
///
/// # Errors
/// The plan is missing or broken.
pub fn read_plan<S: StageSettings>(
    job: &Job<'_, S>,
) -> Result<(PlanSceneRow, Vec<PlanAgentRow>), StageError> {
    let (store, manifest, scene) = (job.store(), job.input(PLANNER)?, job.scene());
    let rows: Vec<PlanSceneRow> = store.read_rows(manifest, keys::PLAN_SCENES)?;
    let row = rows.into_iter().find(|r| r.scene == scene).ok_or(ReplayError::NoScene);
    let row = row.at(|| job.place().in_file(store.location(keys::PLAN_SCENES)))?;
    let mut agents: Vec<PlanAgentRow> = store.read_rows(manifest, keys::PLAN_AGENTS)?;
    agents.retain(|a| a.scene == scene);
    Ok((row, agents))
}

/// The planned hazards of a job's scene.
///
/// # Errors
/// The plan is missing or broken.
pub fn read_hazards<S: StageSettings>(job: &Job<'_, S>) -> Result<Vec<PlanHazardRow>, StageError> {
    let mut hazards: Vec<PlanHazardRow> = job.store().read_rows(job.input(PLANNER)?, keys::PLAN_HAZARDS)?;
    hazards.retain(|h| h.scene == job.scene());
    Ok(hazards)
}
