//! A scene into a store: stage by stage, as the stages themselves would commit it.

use std::collections::BTreeMap;

use schema::arrays::{BEV_MASKS, FILLED_VOXEL_GRIDS, VOXEL_GRIDS};
use schema::measures::counts::PartialCounts;
use schema::scene_info::LOG_STAGE;
use schema::table::Row;
use schema::tables::{CameraRow, ValidBoxRow};
use schema::{AgentId, IMPORTED, is_imported};
use settings::{BevRule, BevSettings, OccupancySettings};
use store::{Attempt, Identity, Scope, Store, StoreError, Unit, keys};

use crate::arrays::{self, Arrays};
use crate::cast::SceneObjects;
use crate::error::ImportError;
use crate::folder::Folder;
use crate::infos::Scene;
use crate::names::{FILLED_VOXELS, MASKS, VOXELS};
use crate::work::{Order, Work};
use crate::{labels, sensors};

/// The stages of a scene that an import does.
pub(crate) fn stages(is_processed: bool) -> Vec<&'static str> {
    let mut stages = vec![LOG_STAGE, CameraRow::STAGE, BEV_MASKS.stage, VOXEL_GRIDS.stage];
    stages.extend(is_processed.then_some(ValidBoxRow::STAGE));
    stages
}

/// Whether a stage of a scene has been imported from the same infos, and all of it is there.
pub(crate) fn is_done(store: &Store, scene: u32, stage: &str, digest: &str) -> Result<bool, ImportError> {
    let manifest = match store.manifest(Scope::Scene(scene), stage) {
        // A damaged record counts as none.
        Err(StoreError::Corrupt { .. }) | Ok(None) => return Ok(false),
        Ok(Some(manifest)) => manifest,
        Err(e) => return Err(e.into()),
    };
    let is_same = is_imported(&manifest.code_version) && manifest.config_hash == digest;
    Ok(is_same && store.outputs_present(&manifest)?)
}

/// Imports a scene.
///
/// # Errors
/// As what is wrong with it, or with the store.
pub(crate) fn import(order: &Order<'_>, scene: &Scene) -> Result<(), ImportError> {
    let cast = SceneObjects::read(order.folder, scene, order.is_processed)?;
    let work = Work { order, scene, cast: &cast };
    stage(order, LOG_STAGE, |attempt| {
        unit(attempt, "log", |unit| labels::write_log(&work, unit))?;
        Ok(())
    })?;
    stage(order, CameraRow::STAGE, |attempt| {
        by_agent(attempt, &work, CameraRow::STAGE, |position, unit| {
            sensors::write(&work, position, unit).map(Some)
        })
    })?;
    for (name, kinds) in [
        (BEV_MASKS.stage, [(MASKS, &BEV_MASKS)]),
        (VOXEL_GRIDS.stage, [(VOXELS, &VOXEL_GRIDS)]),
        (ValidBoxRow::STAGE, [(FILLED_VOXELS, &FILLED_VOXEL_GRIDS)]),
    ] {
        if name == ValidBoxRow::STAGE && !order.is_processed {
            continue;
        }
        stage(order, name, |attempt| {
            if name == ValidBoxRow::STAGE {
                unit(attempt, "boxes", |unit| labels::write_valid(&work, unit))?;
            }
            by_agent(attempt, &work, name, |position, unit| {
                let mut counts = None;
                for (key, kind) in kinds {
                    if let Some(arrays) = arrays_of(&work, position, key, kind)? {
                        counts = Some(arrays::write(&work, position, &arrays, unit)?);
                    }
                }
                Ok(counts)
            })
        })?;
    }
    Ok(())
}

/// Does a stage of a scene where it is not done.
fn stage(
    order: &Order<'_>,
    name: &str,
    make: impl FnOnce(&Attempt) -> Result<(), ImportError>,
) -> Result<(), ImportError> {
    let scene = order.entry.number;
    if !order.force && is_done(order.store, scene, name, order.digest)? {
        Attempt::tidy(order.store, Scope::Scene(scene), name)?;
        return Ok(());
    }
    let identity = Identity {
        stage: name.to_owned(),
        scope: Scope::Scene(scene),
        code_version: IMPORTED.to_owned(),
        config_hash: order.digest.to_owned(),
        inputs: BTreeMap::new(),
        made_by: order.made_by.cloned(),
    };
    let attempt = Attempt::start(order.store, identity, order.force)?;
    make(&attempt)?;
    attempt.commit()?;
    Ok(())
}

/// Makes a unit that a killed run has not finished.
fn unit(
    attempt: &Attempt,
    name: &str,
    make: impl FnOnce(&mut Unit<'_>) -> Result<(), ImportError>,
) -> Result<(), ImportError> {
    if let Some(mut unit) = attempt.unit(name)? {
        make(&mut unit)?;
        unit.finish()?;
    }
    Ok(())
}

/// A unit for each agent, with its counts; no unit where nothing is made.
fn by_agent(
    attempt: &Attempt,
    work: &Work<'_>,
    stage: &str,
    mut make: impl FnMut(usize, &mut Unit<'_>) -> Result<Option<PartialCounts>, ImportError>,
) -> Result<(), ImportError> {
    for (position, (agent, _)) in work.scene.agents.iter().enumerate() {
        unit(attempt, &agent.to_string(), |unit| {
            if let Some(counts) = make(position, unit)? {
                let key = keys::partial_stats(work.order.entry.number, &format!("{stage}.{agent}"));
                unit.rows(&key, &counts.rows())?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// The arrays of an agent that a key names, if it has such.
fn arrays_of<'k>(
    work: &Work<'_>,
    position: usize,
    key: &'static str,
    kind: &'k schema::arrays::ArrayKind,
) -> Result<Option<Arrays<'k>>, ImportError> {
    let (agent, records) = &work.scene.agents[position];
    let Some(said) = records[0].files.get(key) else { return Ok(None) };
    if key == FILLED_VOXELS && !has_filled(work.order.folder, records, agent)? {
        return Ok(None);
    }
    let place = |e: ImportError| e.within(format!("{agent} frame 0 {key}"));
    let (shape, comment) = if key == MASKS {
        let path = work.order.folder.find(said).map_err(place)?;
        let shape =
            arrays::mask_shape(&path).map_err(|problem| place(ImportError::source(&path, problem)))?;
        let comment = bev_settings(shape[1] as u32, work.order.bev_cell_m).describe();
        (shape, comment)
    } else {
        let grid: &OccupancySettings = &work.order.rigs.rig(agent.kind).occupancy;
        (grid.shape().to_vec(), grid.describe())
    };
    // Settings of ours always can be written.
    Ok(Some(Arrays { key, kind, comment: comment.unwrap_or_default(), shape }))
}

/// The masks of an imported dataset.
pub(crate) fn bev_settings(cells: u32, cell_m: f64) -> BevSettings {
    BevSettings { cells, cell_m, rule: BevRule::Simbev2x, ..BevSettings::default() }
}

/// Infos name filled grids before they are there, too: there are all, or none.
fn has_filled(
    folder: &Folder,
    records: &[crate::infos::Record],
    agent: &AgentId,
) -> Result<bool, ImportError> {
    let there = |record: &crate::infos::Record| {
        record.files.get(FILLED_VOXELS).is_some_and(|said| folder.find(said).is_ok())
    };
    let found = records.iter().filter(|record| there(record)).count();
    if found == 0 || found == records.len() {
        return Ok(found > 0);
    }
    let missing = records.iter().position(|record| !there(record)).unwrap_or(0);
    let said = records[missing].files.get(FILLED_VOXELS).cloned().unwrap_or_default();
    let problem = "is not there, but other frames have theirs";
    Err(ImportError::source(std::path::Path::new(&said), problem).within(format!("{agent} frame {missing}")))
}
