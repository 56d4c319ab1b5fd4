//! The tables, made of the rows of all units, and the map masks.

use std::collections::{BTreeMap, BTreeSet};
use std::io;

use schema::table::Row as _;
use schema::tables::PlanSceneRow;
use schema::{NUSCENES_ATTRIBUTES, is_imported};
use serde::Serialize;
use serde_json::json;
use store::{Scope, keys};

use super::boxes::{attribute_token, category_token};
use super::infos;
use super::mask::{MapElement, MapMask, merge, paint};
use super::options::NuScenesOptions;
use super::parts::unpack;
use super::rig::sensor_token;
use super::rows::{BOX_STEPS, POSE_STEPS, Row, rounded, token};
use super::unit::{Fragment, ground};
use super::vocabulary::{CATEGORIES, VISIBILITIES};
use crate::source::NO_MAP;
use crate::{ExportError, ExportFile, Source, UnitFiles};

/// A table that is being written, row by row.
struct Table {
    file: ExportFile,
    rows: u64,
}

impl Table {
    fn create(files: &mut UnitFiles<'_>, version: &str, name: &str) -> Result<Self, ExportError> {
        Ok(Self { file: files.create(&format!("{version}/{name}.json"))?, rows: 0 })
    }

    fn push(&mut self, row: &impl Serialize) -> Result<(), ExportError> {
        self.file.write_all(if self.rows == 0 { b"[\n" } else { b",\n" })?;
        // Rows are texts and finite numbers: they can always be written down.
        self.file.write_all(&serde_json::to_vec(row).unwrap_or_default())?;
        self.rows += 1;
        Ok(())
    }

    fn finish(mut self, files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
        self.file.write_all(if self.rows == 0 { b"[]\n" } else { b"\n]\n" })?;
        files.add(self.file)
    }
}

/// Writes all tables and masks.
pub(crate) fn write(
    source: &Source,
    fragments: &[Fragment],
    options: &NuScenesOptions,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let masks = masks(fragments, options)?;
    for (map, mask) in &masks {
        let name = mask_name(map);
        let mut file = files.create(&name)?;
        let elements = if options.map_mask { elements(source, map)? } else { Vec::new() };
        paint(mask, &elements, &mut file).map_err(|e| write_error(&name, io::Error::other(e)))?;
        files.add(file)?;
    }
    let mut versions: BTreeMap<&str, Vec<&Fragment>> = BTreeMap::new();
    for fragment in fragments {
        versions.entry(&fragment.version).or_default().push(fragment);
    }
    for (version, fragments) in versions {
        constants(version, files)?;
        small_tables(version, &fragments, &masks, files)?;
        large_tables(version, &fragments, &masks, files)?;
    }
    infos::write(fragments, &masks, options, files)
}

/// The ground of each map that the scenes use.
fn masks<'a>(
    fragments: &'a [Fragment],
    options: &NuScenesOptions,
) -> Result<BTreeMap<&'a str, MapMask>, ExportError> {
    let mut grounds: BTreeMap<&str, [f64; 4]> = BTreeMap::new();
    for fragment in fragments {
        let ground = ground(fragment);
        grounds.entry(&fragment.map).and_modify(|all| *all = merge(*all, ground)).or_insert(ground);
    }
    let mask = |(map, ground): (&'a str, [f64; 4])| Ok((map, options.mask_of(map, ground)?));
    grounds.into_iter().map(mask).collect()
}

fn mask_name(map: &str) -> String {
    format!("maps/{}.png", super::options::plain(map))
}

/// The vector map of a map of the store.
pub(crate) fn elements(source: &Source, map: &str) -> Result<Vec<MapElement>, ExportError> {
    let key = keys::vector_map(map);
    let plan = source.store.manifest(Scope::Plan, PlanSceneRow::STAGE)?;
    match plan {
        Some(plan) if plan.output(&key).is_some() => Ok(source.store.read_rows(&plan, &key)?),
        Some(plan) if is_imported(&plan.code_version) => Err(ExportError::Refused(format!(
            "{map}: {NO_MAP} (export with --no-map-mask: blank pictures stand for masks then)"
        ))),
        _ => {
            let path = source.store.location(&key);
            Err(ExportError::Refused(format!(
                "{path}: is missing (run spawn-planner with --force, or export with --no-map-mask)"
            )))
        }
    }
}

fn write_error(name: &str, source: io::Error) -> ExportError {
    ExportError::Write { path: name.into(), action: "write", source }
}

fn table(
    files: &mut UnitFiles<'_>,
    version: &str,
    name: &str,
    rows: impl IntoIterator<Item = serde_json::Value>,
) -> Result<(), ExportError> {
    let mut table = Table::create(files, version, name)?;
    for row in rows {
        table.push(&row)?;
    }
    table.finish(files)
}

/// Tables that are the same everywhere.
fn constants(version: &str, files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
    let categories = CATEGORIES.iter().enumerate().map(|(index, (name, description))| {
        json!({ "token": category_token(name), "name": name, "description": description, "index": index })
    });
    table(files, version, "category", categories)?;
    let attributes = NUSCENES_ATTRIBUTES.iter().map(|(name, description)| {
        json!({ "token": attribute_token(name), "name": name, "description": description })
    });
    table(files, version, "attribute", attributes)?;
    let levels = VISIBILITIES.iter().map(
        |(token, level, description)| json!({ "token": token, "level": level, "description": description }),
    );
    table(files, version, "visibility", levels)
}

/// Sensors, maps, splits, and which samples go together.
fn small_tables(
    version: &str,
    fragments: &[&Fragment],
    masks: &BTreeMap<&str, MapMask>,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let channels: BTreeSet<&(String, String)> = fragments.iter().flat_map(|f| &f.channels).collect();
    let sensors = channels.into_iter().map(|(channel, modality)| {
        json!({ "token": sensor_token(channel), "channel": channel, "modality": modality })
    });
    table(files, version, "sensor", sensors)?;
    let mut logs: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut splits: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for fragment in fragments {
        logs.entry(&fragment.map).or_default().push(&fragment.log_token);
        splits.entry(format!("convoy_{}", fragment.split)).or_default().push(&fragment.scene_name);
    }
    let maps = logs.into_iter().map(|(map, logs)| {
        let shift = masks.get(map).map(MapMask::global_from_world).unwrap_or_default();
        json!({
            "token": token(&format!("map {map}")),
            "category": "semantic_prior",
            "filename": mask_name(map),
            "log_tokens": logs,
            "location": map,
            "global_from_world_m": shift,
        })
    });
    table(files, version, "map", maps)?;
    let splits = serde_json::to_vec_pretty(&splits).unwrap_or_default();
    files.put(&format!("{version}/splits.json"), &splits)?;
    table(files, version, "cooperation", cooperation(fragments))
}

/// Which samples of the agents of a scene are of the same moment.
fn cooperation(fragments: &[&Fragment]) -> Vec<serde_json::Value> {
    let mut moments: BTreeMap<(&str, u32, u64), BTreeMap<&str, &str>> = BTreeMap::new();
    for fragment in fragments {
        // NNNN-AGENT
        let Some((scene, agent)) = fragment.scene_name.split_once('-') else { continue };
        for (frame, time_us, sample) in &fragment.samples {
            moments.entry((scene, *frame, *time_us)).or_default().insert(agent, sample);
        }
    }
    let rows = moments.into_iter().map(|((scene, frame, time_us), samples)| {
        json!({ "scene": scene, "frame": frame, "timestamp": time_us, "samples": samples })
    });
    rows.collect()
}

/// Tables whose rows the units have written down, in the order of units. One row is in memory at a time.
fn large_tables(
    version: &str,
    fragments: &[&Fragment],
    masks: &BTreeMap<&str, MapMask>,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let names = [
        "log",
        "scene",
        "calibrated_sensor",
        "ego_pose",
        "sample",
        "sample_data",
        "instance",
        "sample_annotation",
    ];
    let mut tables =
        names.into_iter().map(|name| Table::create(files, version, name)).collect::<Result<Vec<_>, _>>()?;
    let mut labels: Option<Table> = None;
    for fragment in fragments {
        let shift = masks.get(fragment.map.as_str()).map(MapMask::global_from_world).unwrap_or_default();
        let moved = |at: [f64; 3], steps| rounded([0, 1, 2].map(|axis| at[axis] + shift[axis]), steps);
        let broken =
            |source| ExportError::Read { path: fragment.rows.clone().into(), action: "read", source };
        for row in unpack(files.open(&fragment.rows)?).map_err(broken)? {
            match row.map_err(broken)? {
                Row::Log(row) => tables[0].push(&row)?,
                Row::Scene(row) => tables[1].push(&row)?,
                Row::CalibratedSensor(row) => tables[2].push(&row)?,
                Row::EgoPose(mut row) => {
                    row.translation = moved(row.translation, POSE_STEPS);
                    tables[3].push(&row)?;
                }
                Row::Sample(row) => tables[4].push(&row)?,
                Row::SampleData(row) => tables[5].push(&row)?,
                Row::Instance(row) => tables[6].push(&row)?,
                Row::Annotation(mut row) => {
                    row.translation = moved(row.translation, BOX_STEPS);
                    tables[7].push(&row)?;
                }
                Row::LidarSeg(row) => {
                    if labels.is_none() {
                        labels = Some(Table::create(files, version, "lidarseg")?);
                    }
                    if let Some(table) = &mut labels {
                        table.push(&row)?;
                    }
                }
            }
        }
    }
    for table in tables.into_iter().chain(labels) {
        table.finish(files)?;
    }
    Ok(())
}
