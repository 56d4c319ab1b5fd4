//! Arguments that all layouts take.

use std::path::PathBuf;

use clap::Args;
use export_core::Selection;
use pipeline::{ProgressMode, SceneList};

/// What all layouts take.
#[derive(Clone, Debug, Args)]
pub(crate) struct CommonArgs {
    /// The store: a folder, by its path or as file:///FOLDER.
    #[arg(long, value_name = "DIR")]
    pub(crate) store: PathBuf,
    /// The folder to write: a fresh one, or one with the same export, which is gone on with.
    #[arg(long, value_name = "DIR")]
    pub(crate) dest: PathBuf,
    /// Only these scenes, such as 0,3,5-9 (default: all that are finished).
    #[arg(long, value_name = "LIST")]
    scenes: Option<SceneList>,
    /// Only these splits, such as train,val.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    split: Vec<String>,
    /// Only these agents; * stands for any text: vehicle_0,rsu_*.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    agents: Vec<String>,
    /// Only these sensors; * stands for any text: LIDAR,RGB-*.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    sensors: Vec<String>,
    /// Only frames 0, n, 2 n, ... (20 a second; default: all that the layout takes).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    every: Option<u32>,
    /// Make everything again, also in a folder with an export of other options.
    #[arg(long)]
    pub(crate) force: bool,
    /// Worker threads (default: all cores). The files do not depend on it.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<usize>,
    /// Only say what would be written, what it would come to and what would be left out.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) progress: ProgressMode,
}

impl CommonArgs {
    /// What of the store is wanted, where a layout takes every so many frames.
    pub(crate) fn selection(&self, every_n_frames: u32) -> Selection {
        Selection {
            scenes: self.scenes.as_ref().map(|scenes| scenes.ranges().to_vec()),
            splits: self.split.clone(),
            agents: self.agents.clone(),
            sensors: self.sensors.clone(),
            every_n_frames: self.every.unwrap_or(every_n_frames),
        }
    }
}
