//! The statistics stage: partial counts of all scenes into tables, figures and a report.

use analysis::{DatasetFacts, MeasureTotals, compute_tables, draw_figures, report_html, to_csv};
use pipeline::{Job, Stage, StageError};
use replay::SIMULATE;
use schema::scene_info::SceneInfo;
use schema::settings::stages::StatisticsSettings;
use schema::tables::PartialRow;
use store::keys;

/// The stage.
pub const STAGE: Stage<StatisticsSettings> = Stage::new(run);

/// Stages that leave partial counts.
const COUNTING: [&str; 6] =
    [SIMULATE, "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];

fn run(job: &mut Job<'_, StatisticsSettings>) -> Result<(), StageError> {
    let store = job.store().clone();
    let planned = job.planned_scenes()?;
    let mut counts = MeasureTotals::default();
    let mut scenes: Vec<SceneInfo> = Vec::new();
    let mut unfinished = 0;
    let progress = job.progress();
    progress.set_total(planned.len() as u64);
    for &scene in &planned {
        let mut whole = true;
        for stage in COUNTING {
            let Some(manifest) = job.manifest_if_done(stage, scene)? else {
                whole = false;
                continue;
            };
            let folder = keys::scene(scene, "stats/");
            for output in manifest.outputs.iter().filter(|o| o.key.starts_with(&folder)) {
                counts.add(&store.read_rows::<PartialRow>(&manifest, &output.key)?);
            }
            if stage == SIMULATE {
                scenes.extend(store.read_json::<SceneInfo>(&keys::scene(scene, "log/scene.json"))?);
            }
        }
        unfinished += u32::from(!whole);
        progress.advance(1)?;
    }
    if unfinished > 0 {
        tracing::warn!("{unfinished} of {} scenes are not finished: their counts are partial", planned.len());
    }

    let settings = job.settings();
    let facts = DatasetFacts { name: settings.name.clone(), bev_cells_per_grid: settings.bev_cells_per_grid };
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
    unit.bytes("stats/report.html", report_html(&tables, &figures).as_bytes(), 1)?;
    unit.finish()?;
    Ok(())
}
