//! Makes a store of a dataset in another layout.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use import_core::{ImportError, Prospect, Selection, Source, Watch, import, prospect};
use pipeline::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Progress, ProgressMode, SceneList, say,
};
use store::Store;

/// Makes a store of a dataset in another layout.
#[derive(Debug, Parser)]
#[command(
    name = "import",
    version,
    after_help = "Exit codes: 0 done, 1 some scenes cannot be imported (each is listed; the others are kept), 2 bad arguments, no such \
                  dataset, or a store of something else, 75 stopped by a signal or a full disk (run the same command again)."
)]
struct Cli {
    #[command(subcommand)]
    layout: LayoutCommand,
}

#[derive(Debug, Subcommand)]
enum LayoutCommand {
    /// SimBEV2X's own layout, raw or post-processed
    Simbev2x(ImportArgs),
}

#[derive(Debug, Args)]
struct ImportArgs {
    /// The dataset: the folder simbev2x, or that which holds it.
    #[arg(long, value_name = "DIR")]
    source: PathBuf,
    /// The store to write: a fresh folder, or one with the same import, which is gone on with.
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Only these scenes, such as 0,3,5-9 (default: all).
    #[arg(long, value_name = "LIST")]
    scenes: Option<SceneList>,
    /// Import again what has been imported.
    #[arg(long)]
    force: bool,
    /// Worker threads (default: all cores). The files do not depend on it.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Only say what would be imported.
    #[arg(long)]
    dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    progress: ProgressMode,
}

fn main() -> ExitCode {
    let LayoutCommand::Simbev2x(args) = Cli::parse().layout;
    pipeline::init_logging();
    pipeline::listen_for_signals();
    ExitCode::from(match run(&args) {
        Ok(code) => code,
        Err(error) => {
            tracing::error!("{}", pipeline::report(&error));
            exit_code(&error)
        }
    })
}

fn exit_code(error: &ImportError) -> u8 {
    match error {
        ImportError::Refused(_) => EXIT_USAGE,
        ImportError::Stopped => EXIT_TRY_AGAIN,
        ImportError::Store(error) if error.is_transient() => EXIT_TRY_AGAIN,
        ImportError::Store(error) if error.is_usage() => EXIT_USAGE,
        _ => EXIT_SOME_FAILED,
    }
}

fn run(args: &ImportArgs) -> Result<u8, ImportError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| ImportError::Refused(format!("--threads: {e}")))?;
    let source = Source::open(&args.source)?;
    let store = Store::open(&args.store)?;
    let scenes = args.scenes.as_ref().map(|scenes| scenes.ranges().to_vec());
    let selection = Selection { scenes, force: args.force };
    let found = pool.install(|| prospect(&source, &store, &selection))?;
    announce(&found);
    if args.dry_run {
        return Ok(if found.failed.is_empty() { EXIT_DONE } else { EXIT_SOME_FAILED });
    }
    let name = args.store.file_name().map_or_else(|| "import".into(), |name| name.to_string_lossy());
    let progress = Progress::start(args.progress, "import simbev2x".to_owned(), found.agent_frames());
    let outcome = pool.install(|| import(&source, &store, found, &selection, &name, &Watching(progress)))?;
    for (scene, error) in &outcome.failed {
        tracing::error!("scene {scene} is not imported: {}", pipeline::report(error));
    }
    let (made, kept, failed) = (outcome.made, outcome.kept, outcome.failed.len());
    say(&format!("{}: {made} scenes imported, {kept} kept, {failed} failed", args.store.display()));
    Ok(if failed == 0 { EXIT_DONE } else { EXIT_SOME_FAILED })
}

/// Says what there is to be imported.
fn announce(found: &Prospect) {
    let frames: u64 =
        found.scenes.iter().map(|scene| u64::from(scene.frames) * scene.agents.len() as u64).sum();
    let processed = found.scenes.iter().filter(|scene| scene.is_processed).count();
    say(&format!(
        "{} scenes with {frames} agent-frames, {processed} of them post-processed; {} are imported already",
        found.scenes.len(),
        found.done.len(),
    ));
    for (scene, error) in &found.failed {
        tracing::warn!("scene {scene} cannot be imported: {}", pipeline::report(error));
    }
}

/// The progress of a stage, for the import.
struct Watching(Progress);

impl Watch for Watching {
    fn advance(&self, agent_frames: u64) -> bool {
        self.0.advance(agent_frames).is_err()
    }
}
