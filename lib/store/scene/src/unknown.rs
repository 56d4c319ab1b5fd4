//! What nobody knows of an imported sensor.

use std::collections::BTreeSet;

use schema::table::Row;
use schema::tables::CameraRow;
use schema::{AgentId, ZERO_COLUMNS};
use store::keys;

use crate::{SceneError, SceneReader};

/// Columns of a sensor's table that are no readings: they hold zeros, because the dataset that was imported
/// did not say them. Of what was made here there are none.
///
/// # Errors
/// The sensors' stage has not made the table, it cannot be read, or what it says of its columns is no list of
/// names.
pub fn unknown_columns(
    scene: &SceneReader,
    agent: AgentId,
    name: &str,
) -> Result<BTreeSet<String>, SceneError> {
    let key = keys::sensor(scene.scene(), agent, name);
    let said = scene.store().table_metadata(scene.manifest(CameraRow::STAGE)?, &key, ZERO_COLUMNS)?;
    let parse = |text: String| {
        let wrong = |source| SceneError::Calibration { path: scene.store().location(&key), source };
        serde_json::from_str(&text).map_err(wrong)
    };
    said.map_or_else(|| Ok(BTreeSet::new()), parse)
}
