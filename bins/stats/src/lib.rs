//! The statistics stage: partial counts of all scenes into tables, figures and a report with a small picture
//! of each scene.

mod cards;

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::process::ExitCode;

use analysis::{
    DatasetFacts, GroupTotals, MadeBy, MeasureTotals, PUBLISHED_PAGE, SceneCard, compute_tables,
    dataset_card, draw_figures, published_html, report_html, to_csv,
};
use rayon::prelude::*;
use runner::{At, Graph, Job, Place, Stage, StageError};
use scene::SceneReader;
use schema::scene_info::{self, SceneInfo};
use schema::tables::PartialRow;
use settings::stages::StatisticsSettings;
use store::{Manifest, Store, keys};

/// So many scenes are read side by side.
const AT_ONCE: usize = 64;

/// The dataset's card, where people and sites that keep datasets look for it.
const CARD: &str = "README.md";

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<StatisticsSettings> = Stage::new(run);

fn run(job: &mut Job<'_, StatisticsSettings>) -> Result<(), StageError> {
    let store = job.store().clone();
    let planned = job.planned_scenes()?;
    let kinds = store::kind_names(&store::scene_kinds(&store)?);
    let progress = job.progress();
    progress.set_total(planned.len() as u64);
    let covered = covered(job.done_stages());
    if covered.len() < planned.len() {
        let (covered, planned) = (covered.len(), planned.len());
        tracing::warn!("statistics of {covered} of {planned} scenes: the others are not finished");
    }
    let mut counts = MeasureTotals::default();
    let mut groups = GroupTotals::default();
    let mut scenes: Vec<SceneInfo> = Vec::new();
    let mut cards: Vec<(SceneCard, Option<Vec<u8>>)> = Vec::new();
    for some in covered.chunks(AT_ONCE) {
        let read = some.par_iter().map(|(scene, manifests)| of_scene(&store, *scene, manifests));
        for ((scene, _), of_scene) in some.iter().zip(read.collect::<Result<Vec<_>, StageError>>()?) {
            counts.merge(&of_scene.counted);
            if let Some((info, picture)) = of_scene.described {
                let kind = kinds.get(scene).map_or("", String::as_str);
                cards.push((cards::card(&info, kind, picture.is_some()), picture));
                groups.add(&info, kind, &of_scene.counted);
                scenes.push(info);
            }
            progress.advance(1)?;
        }
    }

    let settings = job.settings().clone();
    let facts = DatasetFacts {
        name: settings.name.clone(),
        planned_scenes: planned.len() as u64,
        bev_cells: settings.bev.cells,
        bev_cell_m: settings.bev.cell_m,
        kinds,
    };
    let tables = compute_tables(&facts, &scenes, &counts);
    let figures = draw_figures(&tables);
    let Some(mut unit) = job.unit("stats")? else { return Ok(()) };
    for table in &tables.tables {
        let columns = table.columns.iter().map(|c| (c.name.as_str(), c.values.to_column())).collect();
        unit.columns(&format!("stats/{}.parquet", table.name), columns)?;
        unit.bytes(&format!("stats/{}.csv", table.name), to_csv(table).as_bytes(), table.len() as u64)?;
    }
    for figure in &figures {
        unit.bytes(&format!("stats/figures/{}.svg", figure.name), figure.svg.as_bytes(), 1)?;
    }
    for (card, picture) in &cards {
        if let (Some(path), Some(bytes)) = (&card.picture, picture) {
            unit.bytes(&format!("stats/{path}"), bytes, 1)?;
        }
    }
    let cards: Vec<SceneCard> = cards.into_iter().map(|(card, _)| card).collect();
    let report = report_html(&tables, &figures, &cards, groups.groups(&facts));
    unit.bytes("stats/report.html", report.as_bytes(), 1)?;
    if let Some(page) = published_html(&tables, &figures) {
        unit.bytes(&format!("stats/{PUBLISHED_PAGE}"), page.as_bytes(), 1)?;
    }
    unit.bytes(CARD, dataset_card(&settings, &made_by(&covered), &tables).as_bytes(), 1)?;
    unit.finish()?;
    Ok(())
}

/// What statistics read of a scene.
struct OfScene {
    counted: MeasureTotals,
    /// Its description, and a small picture; none where it was not simulated.
    described: Option<(SceneInfo, Option<Vec<u8>>)>,
}

fn of_scene(store: &Store, scene: u32, manifests: &[Manifest]) -> Result<OfScene, StageError> {
    let folder = keys::scene(scene, "stats/");
    let mut counted = MeasureTotals::default();
    for manifest in manifests {
        for output in manifest.outputs.iter().filter(|o| o.key.starts_with(&folder)) {
            counted.add(&store.read_rows::<PartialRow>(manifest, &output.key)?);
        }
    }
    let mut described = None;
    if manifests.iter().any(|manifest| manifest.stage == scene_info::LOG_STAGE) {
        let reader = SceneReader::new(store, scene, manifests.iter().cloned());
        let info = reader.info().at(|| Place::scene(scene))?;
        let picture = cards::picture(&reader, &info).at(|| Place::scene(scene))?;
        described = Some((info, picture));
    }
    Ok(OfScene { counted, described })
}

/// The code that made the scenes.
fn made_by(covered: &[(u32, &[Manifest])]) -> MadeBy {
    let manifests = || covered.iter().flat_map(|(_, manifests)| manifests.iter());
    let stages = Graph::get().stages.iter().map(|stage| {
        let of_stage = manifests().filter(|manifest| manifest.stage == stage.name);
        (stage.name.to_owned(), of_stage.map(|manifest| manifest.code_version.clone()).collect())
    });
    MadeBy {
        convoy: env!("CARGO_PKG_VERSION").to_owned(),
        format: schema::FORMAT_VERSION,
        stages: stages.filter(|(_, codes): &(String, BTreeSet<String>)| !codes.is_empty()).collect(),
    }
}

/// The scenes that every stage has done that has done any: tables of different stages speak of the same
/// scenes. A dataset that was only simulated so far has statistics, too; a scene that failed half-way is in
/// none.
fn covered(done: &BTreeMap<u32, Vec<Manifest>>) -> Vec<(u32, &[Manifest])> {
    let stages: BTreeSet<&str> = done.values().flatten().map(|m| m.stage.as_str()).collect();
    let whole = done.iter().filter(|(_, manifests)| !manifests.is_empty() && manifests.len() == stages.len());
    whole.map(|(scene, manifests)| (*scene, manifests.as_slice())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIMULATE: &str = scene_info::LOG_STAGE;

    fn done(scenes: &[(u32, &[&str])]) -> Vec<u32> {
        let manifest = |stage: &&str| Manifest {
            format_version: 1,
            stage: (*stage).to_owned(),
            code_version: String::new(),
            config_hash: String::new(),
            generation: 0,
            inputs: BTreeMap::new(),
            outputs: Vec::new(),
            sections: BTreeMap::new(),
            accepted_by: Vec::new(),
            made_by: None,
        };
        let scenes = scenes.iter().map(|(scene, stages)| (*scene, stages.iter().map(manifest).collect()));
        covered(&scenes.collect()).iter().map(|(scene, _)| *scene).collect()
    }

    #[test]
    fn all_tables_speak_of_the_same_scenes() {
        assert_eq!(done(&[(0, &[SIMULATE, "bev-gt"]), (1, &[SIMULATE]), (2, &[SIMULATE, "bev-gt"])]), [0, 2]);
        assert_eq!(done(&[(0, &[SIMULATE]), (1, &[SIMULATE]), (2, &[])]), [0, 1]);
        assert_eq!(done(&[(0, &[]), (1, &[])]), [0; 0]);
    }
}
