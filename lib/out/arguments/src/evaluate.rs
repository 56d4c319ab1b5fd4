//! The command line of `evaluate`.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use runner::SceneList;

/// Scores predicted boxes and BEV masks against a finished store by SimBEV2X's, nuScenes' and OPV2V's
/// metrics.
#[derive(Debug, Parser)]
#[command(
    name = "evaluate",
    version,
    after_help = "Exit codes: 0 done, 1 the store is damaged, 2 bad arguments, no such store, or predictions that cannot be, 75 the \
                  result cannot be written."
)]
pub struct Evaluate {
    /// Predicted boxes: one Parquet file (docs/schema.md says which columns), or nuScenes' results as .json.
    #[arg(long, value_name = "FILE", required_unless_present = "bev_masks")]
    pub predictions: Option<PathBuf>,
    /// The export to nuScenes that the results in .json are of: its folder.
    #[arg(long, value_name = "DIR")]
    pub nuscenes: Option<PathBuf>,
    /// Predicted BEV masks: a folder of SCENE/AGENT.npz (docs/evaluation.md).
    #[arg(long, value_name = "DIR")]
    pub bev_masks: Option<PathBuf>,
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// Only these scenes, such as 0,3,5-9 (default: all that are finished).
    #[arg(long, value_name = "LIST")]
    pub scenes: Option<SceneList>,
    /// Only scenes of these splits, such as test.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub split: Vec<String>,
    /// Only scenes of these editions of the configuration, by number.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub edition: Vec<u32>,
    /// Only scenes of these groups, by name.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub group: Vec<String>,
    /// Egos, such as vehicle_0,rsu_* (default: vehicle_*; of nuScenes' results all that they name).
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub agents: Vec<String>,
    /// Frames 0, n, 2 n, ... of every ego are evaluated (default: those that the predictions name; of masks
    /// all that the store has).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub every: Option<u32>,
    /// The metrics of boxes (default: all but simbev2x-iou).
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    pub metrics: Vec<Metrics>,
    /// By whom a box of the store must be seen to count (default: partners; of nuScenes' results ego, and
    /// nuScenes' metrics hold them against the export's own annotations).
    #[arg(long, value_enum)]
    pub seen: Option<SeenBy>,
    /// How far away a partner may be, m.
    #[arg(long, value_name = "M", default_value_t = 80.0)]
    pub comm_range_m: f64,
    /// How much higher or lower a partner may be, m.
    #[arg(long, value_name = "M", default_value_t = 4.8)]
    pub elevation_m: f64,
    /// Only boxes with their middle in this part of the ego's frame count, m: the least x (ahead) and y (to
    /// the left), then the greatest, such as -51.2,-51.2,51.2,51.2.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = four_numbers, allow_hyphen_values = true)]
    pub range_m: Option<[f64; 4]>,
    /// Let nuScenes' attributes follow from the predicted speed where none is said.
    #[arg(long)]
    pub attributes_by_speed: bool,
    /// Say how sure scores are: intervals of 95 % over so many draws of the scenes, such as 1000; of modes of
    /// cooperation also what they gain, by the same draws.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub bootstrap: u32,
    /// Besides the scores of all scenes those of a part of them.
    #[arg(long, value_enum)]
    pub by: Option<Part>,
    /// A file for all numbers, one a row: .parquet or .json.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// A file for a page with curves, what was found at which distance, and the worst frames: .html, best in
    /// the store's folder.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Worker threads (default: all cores). The numbers do not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

/// Four numbers with commas between them.
fn four_numbers(text: &str) -> Result<[f64; 4], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        "expected four numbers: the least x and y, then the greatest, such as -51.2,-51.2,51.2,51.2".into()
    })
}

/// What scenes are put together by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// By their map
    Map,
}

/// Families of metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Metrics {
    /// mAP by difficulty, distance and who saw, ATE, AOE, ASE, AVE, SDS
    Simbev2x,
    /// The same, found by the overlap of volumes
    Simbev2xIou,
    /// mAP, ATE, ASE, AOE, AVE, AAE, NDS
    Nuscenes,
    /// AP of vehicles by overlap from above, with and without global sorting
    Opv2v,
}

/// By whom a box must be seen to count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SeenBy {
    /// By the ego or any vehicle or RSU in reach
    Partners,
    /// By the ego
    Ego,
    /// By nobody: all boxes of the ego's list
    Nobody,
}
