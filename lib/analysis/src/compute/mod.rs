//! From counts and scene facts to tables.

mod boxes;
mod grids;
mod histogram;
mod overview;
mod scenes;
mod sensors;
mod weather;

use schema::scene_info::SceneInfo;

use crate::counts::Counts;
use crate::table::Tables;

pub(crate) use boxes::MOTION_TABLES;
pub(crate) use scenes::SCENE_HISTOGRAMS;
pub(crate) use weather::{WEATHER_TABLES, WeatherTable};

/// What is said of a dataset besides counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DatasetFacts {
    /// Name of the dataset.
    pub name: String,
    /// Cells of one channel of a BEV mask: rows times columns.
    pub bev_cells_per_grid: u64,
}

/// Every table of a dataset. Scenes may come in any order.
#[must_use]
pub fn compute_tables(facts: &DatasetFacts, scenes: &[SceneInfo], counts: &Counts) -> Tables {
    let mut scenes = scenes.iter().collect::<Vec<_>>();
    scenes.sort_by_key(|scene| scene.scene);
    let frames = recorded_frames(&scenes, counts);
    let mut tables = vec![overview::overview(&scenes, counts, frames)];
    tables.extend(scenes::tables(&scenes));
    tables.extend(WEATHER_TABLES.iter().map(|table| weather::transitions(table, &scenes)));
    tables.extend(boxes::tables(counts, frames));
    tables.push(grids::bev(counts, facts.bev_cells_per_grid));
    tables.push(grids::occupancy(counts));
    tables.extend(sensors::tables(counts));
    Tables { dataset: facts.name.clone(), tables }
}

/// Frames of all scenes: as counted with the boxes, else as the scenes say.
fn recorded_frames(scenes: &[&SceneInfo], counts: &Counts) -> u64 {
    match counts.total(schema::measures::tracks::FRAMES) {
        0 => scenes.iter().map(|scene| u64::from(scene.frames)).sum(),
        frames => frames,
    }
}

/// A quotient, if there is something to divide by.
fn ratio(numerator: u64, denominator: u64) -> Option<f64> {
    (denominator > 0).then(|| numerator as f64 / denominator as f64)
}

/// 100 times [`ratio`].
fn percent(part: u64, whole: u64) -> Option<f64> {
    ratio(part, whole).map(|share| 100.0 * share)
}

/// The known classes in their order, then the unknown ones that were counted, in alphabetical order.
fn classes_in_order<'a>(counts: &'a Counts, measures: &[&str], known: &[&'a str]) -> Vec<&'a str> {
    let mut unknown: Vec<&str> = measures.iter().flat_map(|measure| counts.classes(measure)).collect();
    unknown.sort_unstable();
    unknown.dedup();
    unknown.retain(|class| !known.contains(class));
    [known, &unknown].concat()
}
