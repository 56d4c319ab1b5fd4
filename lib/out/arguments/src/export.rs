//! What all layouts of `export` take. Options of one layout, and so the program's command line, are with the
//! layouts.

use std::path::PathBuf;

use clap::Args;
use runner::SceneList;

use crate::stage::Progress;

/// What all layouts take.
#[derive(Clone, Debug, Args)]
pub struct CommonArgs {
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// The folder to write: a fresh one, or one with the same export, which is gone on with.
    #[arg(long, value_name = "DIR")]
    pub dest: PathBuf,
    /// Only these scenes, such as 0,3,5-9 (default: all that are finished).
    #[arg(long, value_name = "LIST")]
    pub scenes: Option<SceneList>,
    /// Only these splits, such as train,val.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub split: Vec<String>,
    /// Only scenes of these editions of the configuration, by number.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub edition: Vec<u32>,
    /// Only scenes of these groups, by name.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub group: Vec<String>,
    /// Only these agents; * stands for any text: vehicle_0,rsu_*.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub agents: Vec<String>,
    /// Only these sensors; * stands for any text: LIDAR,RGB-*.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub sensors: Vec<String>,
    /// Only frames 0, n, 2 n, ... (20 a second; default: all that the layout takes).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub every: Option<u32>,
    /// Make everything again, also in a folder with an export of other options.
    #[arg(long)]
    pub force: bool,
    /// Worker threads (default: all cores). The files do not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Only say what would be written, what it would come to and what would be left out.
    #[arg(long)]
    pub dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: Progress,
}
