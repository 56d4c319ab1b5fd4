//! The command line of `import`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use runner::SceneList;

use crate::stage::Progress;

/// Makes a store of a dataset in another layout.
#[derive(Debug, Parser)]
#[command(
    name = "import",
    version,
    after_help = "Exit codes: 0 done, 1 some scenes cannot be imported (each is listed; the others are kept), 2 bad arguments, no such \
                  dataset, or a store of something else, 75 stopped by a signal or a full disk, or others work on \
                  the store (run the same command again)."
)]
pub struct Import {
    /// The layout, with its options.
    #[command(subcommand)]
    pub layout: ImportCommand,
}

/// From which layout.
#[derive(Debug, Subcommand)]
pub enum ImportCommand {
    /// SimBEV2X's own layout, raw or post-processed
    Simbev2x(ImportArgs),
}

/// What to import, and where to.
#[derive(Debug, Args)]
pub struct ImportArgs {
    /// The dataset: the folder simbev2x, or that which holds it.
    #[arg(long, value_name = "DIR")]
    pub source: PathBuf,
    /// The store to write: a fresh folder, or one with the same import, which is gone on with.
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// Only these scenes, such as 0,3,5-9 (default: all).
    #[arg(long, value_name = "LIST")]
    pub scenes: Option<SceneList>,
    /// Import again what has been imported.
    #[arg(long)]
    pub force: bool,
    /// Worker threads (default: all cores). The files do not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Only say what would be imported.
    #[arg(long)]
    pub dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: Progress,
}
