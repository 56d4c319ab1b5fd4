//! The planning stage: reads maps, plans scenes, keeps everything a store needs to be complete by itself.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use opendrive::Map;
use pipeline::{Job, Stage, StageError};
use plan::{Plan, PlanMap};
use schema::settings::DatasetSettings;
use schema::table::Row;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use serde::Serialize;
use store::keys;

/// The stage.
pub const STAGE: Stage = Stage { name: "spawn-planner", run };

/// `dataset.json`.
#[derive(Serialize)]
struct DatasetRecord<'a> {
    format_version: u32,
    code_version: &'a str,
    config: &'a DatasetSettings,
}

fn run(job: &mut Job<'_>) -> Result<(), StageError> {
    let settings = job.settings().clone();
    let texts = map_texts(&settings, job.maps_folder())?;
    let mut maps = BTreeMap::new();
    for (name, source) in &texts {
        let hash = store::hash_bytes(&source.text);
        maps.insert(name.clone(), PlanMap { map: parse_map(source)?, hash });
    }
    let plan = plan::plan(&settings, &maps).map_err(|e| StageError::failed(&e))?;
    for warning in &plan.warnings {
        tracing::warn!("{warning}");
    }
    for scene in &plan.scenes {
        job.plan_scene(scene.scene, scene_digest(scene, &plan));
    }
    if let Some(mut unit) = job.unit("plan")? {
        let record = DatasetRecord {
            format_version: schema::FORMAT_VERSION,
            code_version: pipeline::code_version(STAGE.name),
            config: &settings,
        };
        let json = serde_json::to_vec_pretty(&record).map_err(|e| StageError::failed(&e))?;
        unit.bytes(keys::DATASET, &json, 1)?;
        for (name, source) in &texts {
            unit.bytes(&keys::map(name), &replay::compress_map(&source.text)?, 1)?;
            if let Some(own) = maps.get(name) {
                unit.rows(&keys::vector_map(name), &vectormap::rows(&own.map))?;
            }
        }
        unit.rows(keys::PLAN_SCENES, &plan.scenes)?;
        unit.rows(keys::PLAN_AGENTS, &plan.agents)?;
        unit.finish()?;
    }
    Ok(())
}

/// A map's OpenDRIVE text and where it comes from, for messages.
struct MapSource {
    text: Vec<u8>,
    origin: String,
}

/// The OpenDRIVE text of every map the settings name: our own towns are generated, others read from the folder.
fn map_texts(
    settings: &DatasetSettings,
    folder: Option<&Path>,
) -> Result<BTreeMap<String, MapSource>, StageError> {
    let mut texts = BTreeMap::new();
    for name in settings.scenes.iter().filter(|s| s.count > 0).map(|s| &s.map) {
        if texts.contains_key(name) {
            continue;
        }
        let source = match town::named(name) {
            Some(parameters) => {
                let network = town::generate(&parameters).map_err(|e| StageError::failed(&e))?;
                MapSource { text: opendrive::write(&network).into_bytes(), origin: name.clone() }
            }
            None => read_map_file(name, folder)?,
        };
        texts.insert(name.clone(), source);
    }
    Ok(texts)
}

fn read_map_file(name: &str, folder: Option<&Path>) -> Result<MapSource, StageError> {
    let own = town::names().join(", ");
    let Some(folder) = folder else {
        return Err(StageError::Usage(format!(
            "map `{name}` is none of our own towns ({own}): say where its .xodr file is with --maps FOLDER"
        )));
    };
    for ending in ["xodr", "xodr.gz"] {
        let path = folder.join(format!("{name}.{ending}"));
        match std::fs::read(&path) {
            Ok(bytes) => {
                let text = unpack(bytes, &path)?;
                return Ok(MapSource { text, origin: path.display().to_string() });
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(e) => return Err(StageError::Usage(format!("{}: cannot read the map: {e}", path.display()))),
        }
    }
    let folder = folder.display();
    Err(StageError::Usage(format!("no {name}.xodr or {name}.xodr.gz in {folder}; our own towns are {own}")))
}

/// The text of a map file that may be gzipped: the store keeps the text, so its hash does not depend on packing.
fn unpack(bytes: Vec<u8>, path: &Path) -> Result<Vec<u8>, StageError> {
    const LARGEST: u64 = 1 << 30;
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    flate2::read::GzDecoder::new(bytes.as_slice())
        .take(LARGEST)
        .read_to_end(&mut text)
        .map_err(|e| StageError::Failed(format!("{}: broken gzip file: {e}", path.display())))?;
    Ok(text)
}

fn parse_map(source: &MapSource) -> Result<Map, StageError> {
    let origin = &source.origin;
    let network =
        opendrive::read_bytes(&source.text).map_err(|e| StageError::Failed(format!("{origin}: {e}")))?;
    if !network.warnings.is_empty() {
        let count = network.warnings.len();
        tracing::info!("{origin}: {count} peculiarities in the file (CONVOY_LOG=debug lists them)");
        for warning in &network.warnings {
            tracing::debug!("{origin}: {warning}");
        }
    }
    Ok(Map::new(network))
}

/// Digest of everything the plan says about one scene: the simulation of a scene depends on nothing else of it.
fn scene_digest(scene: &PlanSceneRow, plan: &Plan) -> String {
    let agents: Vec<PlanAgentRow> = plan.agents.iter().filter(|a| a.scene == scene.scene).cloned().collect();
    let scene = PlanSceneRow::to_columns(std::slice::from_ref(scene));
    // Debug prints every bit of every number that matters: shortest text that reads back the same.
    store::hash_bytes(format!("{scene:?}\n{:?}", PlanAgentRow::to_columns(&agents)).as_bytes())
}
