//! The command line that all stages share.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, ValueEnum};
use runner::{EditionWish, ProgressMode, STAMP_LEN, SceneList, Shard, Stage, StageOptions, StageSettings};

use crate::about;
use crate::device::DeviceArgs;

/// A stage of Convoy's pipeline: does what is missing or stale, for all scenes of the plan or for some.
#[derive(Clone, Debug, Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done, 1 some scenes failed (each listed), 2 bad arguments or configuration, \
                  75 stopped by a signal or a full disk, or another run holds the store (run the same command \
                  again)."
)]
pub struct StageArgs {
    /// Dataset configuration (TOML, or YAML of SimBEV2X), or the name of one that comes with the programs
    /// (`convoy config list`). All stages but the planner do without: the store
    /// has the one that it was planned by.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Folder with OpenDRIVE files for maps that the configuration names.
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
    /// Only these scenes, such as 0,3,5-9 (default: all).
    #[arg(long, value_name = "LIST", conflicts_with = "shard")]
    scenes: Option<SceneList>,
    /// One of N shares of the scenes that take about as long, I from 0: nobody is asked, and a plan of other
    /// versions of stages is refused. With only N, I comes from SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX.
    #[arg(long, value_name = "[I/]N")]
    shard: Option<Shard>,
    /// Keep planned scenes as they are: scenes that the configuration asks for beyond them are an edition of
    /// their own.
    #[arg(long, conflicts_with = "edition")]
    grow: bool,
    /// Put the configuration in place of one edition of the store, by its number (default: the one that it
    /// equals, else the newest).
    #[arg(long, value_name = "N")]
    edition: Option<u32>,
    /// Redo scenes that are done; what was made from them becomes stale.
    #[arg(long)]
    force: bool,
    /// Make finished work again that a changed configuration or newer code makes stale. Without it a stage
    /// asks, or ends with 2, where that is more than `store.ask_beyond_s`.
    #[arg(long)]
    redo: bool,
    /// Make again what older code made: `convoy run` says so to its stages once the planner has asked.
    #[arg(long, hide = true)]
    redo_older: bool,
    /// The stages of the run that this is one of: `convoy run` says so, for the time that is left of all.
    #[arg(long, hide = true, value_name = "LIST", value_delimiter = ',')]
    in_run: Vec<String>,
    /// Warnings about the configuration and about the plan are errors (2).
    #[arg(long)]
    strict: bool,
    /// Keep what older code made, where nothing else changed; the manifests say so. For upgrades in
    /// mid-dataset.
    #[arg(long, conflicts_with = "force")]
    accept_code: bool,
    #[command(flatten)]
    device: DeviceArgs,
    /// Worker threads (default: all cores). The output does not depend on it.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Only say what would be done.
    #[arg(long)]
    dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    progress: Progress,
}

/// How to show progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Progress {
    /// A bar on a terminal, plain lines elsewhere.
    Auto,
    /// A bar.
    #[value(hide = true)]
    Bar,
    /// A line every ten seconds.
    Plain,
    /// Nothing.
    None,
}

impl Progress {
    /// The word for it on a command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Bar => "bar",
            Self::Plain => "plain",
            Self::None => "none",
        }
    }
}

impl From<Progress> for ProgressMode {
    fn from(progress: Progress) -> Self {
        match progress {
            Progress::Auto => Self::Auto,
            Progress::Bar => Self::Bar,
            Progress::Plain => Self::Plain,
            Progress::None => Self::None,
        }
    }
}

impl From<StageArgs> for StageOptions {
    fn from(args: StageArgs) -> Self {
        let StageArgs {
            config,
            store,
            maps,
            scenes,
            shard,
            grow,
            edition,
            force,
            redo,
            redo_older,
            in_run,
            strict,
            accept_code,
            device,
            threads,
            dry_run,
            progress,
        } = args;
        let progress = progress.into();
        let edition = edition_wish(grow, edition);
        Self {
            config,
            store,
            maps,
            scenes,
            shard,
            edition,
            force,
            redo,
            redo_older,
            in_run,
            strict,
            accept_code,
            device: device.into(),
            threads,
            dry_run,
            progress,
        }
    }
}

/// What `--grow` and `--edition` ask for.
#[must_use]
pub fn edition_wish(grow: bool, edition: Option<u32>) -> EditionWish {
    match edition {
        _ if grow => EditionWish::Grown,
        Some(edition) => EditionWish::Of(edition),
        None => EditionWish::Known,
    }
}

/// Runs a stage program: its words in, of which the first is its name, its exit code out. `stamp` is the
/// build's (`build_stamp::STAMP`).
#[must_use]
pub fn run<S: StageSettings>(words: Vec<OsString>, stage: Stage<S>, stamp: &[u8; STAMP_LEN]) -> ExitCode {
    let command = StageArgs::command().name(S::STAGE).version(runner::release(stamp));
    let command = command.about(about::of_stage(S::STAGE)).long_about(None);
    // What `get_matches` lets pass has all arguments; else clap's own message ends the program.
    let args = StageArgs::from_arg_matches(&command.get_matches_from(words)).unwrap_or_else(|e| e.exit());
    runner::run_stage(stage, &args.into(), stamp)
}
