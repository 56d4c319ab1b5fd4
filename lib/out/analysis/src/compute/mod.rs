//! From counts and scene facts to tables.

mod beside;
mod boxes;
mod grids;
mod heat;
mod histogram;
mod overview;
mod scenes;
mod sensors;
mod share;
mod sightings;
mod weather;

use std::collections::BTreeMap;

use schema::scene_info::SceneInfo;

use crate::table::Tables;
use crate::totals::MeasureTotals;

pub(crate) use beside::{FRAMES_TABLE, PUBLISHED, SIZE_TABLE, by_size_table, weather_table};
pub(crate) use boxes::MOTION_TABLES;
pub(crate) use scenes::SCENE_HISTOGRAMS;
pub(crate) use sightings::{PLACE_TABLES, POINT_TABLES, SPREAD_TABLES};
pub(crate) use weather::{WEATHER_TABLES, WeatherTable};

/// What is said of a dataset besides counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DatasetFacts {
    /// Name of the dataset.
    pub name: String,
    /// Scenes of the plan: those that the statistics are given may be fewer.
    pub planned_scenes: u64,
    /// Rows and columns of a BEV mask.
    pub bev_cells: u32,
    /// Side of a cell, m.
    pub bev_cell_m: f64,
    /// Names of kinds of scenes (`night`, `edition 1`), by scene; none where all are of one kind.
    pub kinds: BTreeMap<u32, String>,
}

/// Every table of a dataset. Scenes may come in any order.
///
/// ```
/// use analysis::{DatasetFacts, MeasureTotals, compute_tables, draw_figures, report_html, to_csv};
/// use schema::scene_info::SceneInfo;
///
/// let facts = DatasetFacts { name: "demo".into(), planned_scenes: 1, ..DatasetFacts::default() };
/// let scene = SceneInfo { map: "Town01".into(), frames: 40, ..SceneInfo::default() };
/// let tables = compute_tables(&facts, &[scene], &MeasureTotals::default());
/// let overview = tables.get("overview").map(to_csv);
/// assert_eq!(overview.as_deref(), Some("quantity,value\nscenes,1\nmaps,1\nframes,40\nrecorded_time_s,2\n"));
/// assert!(report_html(&tables, &draw_figures(&tables), &[], []).contains("<h1>demo</h1>"));
/// ```
#[must_use]
pub fn compute_tables(facts: &DatasetFacts, scenes: &[SceneInfo], counts: &MeasureTotals) -> Tables {
    let mut scenes = scenes.iter().collect::<Vec<_>>();
    scenes.sort_by_key(|scene| scene.scene);
    let frames = annotated_frames(&scenes, counts);
    let mut tables = vec![overview::overview(&scenes, facts.planned_scenes, counts)];
    tables.extend(scenes::tables(&scenes, &facts.kinds));
    tables.extend(WEATHER_TABLES.iter().map(|table| weather::transitions(table, &scenes)));
    tables.extend(boxes::tables(counts, frames));
    tables.extend(sightings::tables(counts));
    tables.push(grids::bev_rules(counts));
    tables.push(grids::bev(counts, u64::from(facts.bev_cells).pow(2)));
    tables.push(heat::bev_heat(counts, facts.bev_cells as usize, facts.bev_cell_m));
    tables.push(grids::occupancy(counts));
    tables.extend(sensors::tables(counts));
    let (covered, planned) = (scenes.len() as u64, facts.planned_scenes);
    let partial = (covered < planned).then_some([covered, planned]);
    let mut tables = Tables { dataset: facts.name.clone(), partial, tables };
    let beside = beside::tables(&tables, &scenes);
    tables.tables.extend(beside);
    tables
}

/// Frames with boxes of all scenes: as counted with the boxes, else as the scenes say.
fn annotated_frames(scenes: &[&SceneInfo], counts: &MeasureTotals) -> u64 {
    match counts.total(schema::measures::tracks::FRAMES) {
        0 => scenes.iter().map(|s| u64::from(schema::rate::count(s.frames, s.label_every_n_frames))).sum(),
        frames => frames,
    }
}
