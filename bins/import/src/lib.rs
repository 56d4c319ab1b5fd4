//! Makes a store of a dataset in another layout.

use std::ffi::OsString;
use std::process::ExitCode;

use arguments::import::{Import, ImportArgs, ImportCommand};
use import_core::{ImportError, ProgressWatch, Prospect, Selection, Source, import, prospect};
use runner::{EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Programs, Progress, StageError, say};
use store::{Lock, Store};

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    let ImportCommand::Simbev2x(args) = arguments::parse::<Import>(&words, build_stamp::STAMP).layout;
    runner::init_logging();
    runner::listen_for_signals();
    ExitCode::from(match run(&args) {
        Ok(code) => code,
        Err(error) => {
            tracing::error!("{}", runner::report(&error));
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
    let programs = Programs::of_build(build_stamp::STAMP, Some("import"));
    let selection = Selection { scenes, force: args.force, made_by: Some(programs.made_by("import")) };

    let _lock = if args.dry_run { None } else { Some(hold(&store)?) };
    let found = pool.install(|| prospect(&source, &store, &selection))?;
    announce(&found);
    if args.dry_run {
        return Ok(if found.failed.is_empty() { EXIT_DONE } else { EXIT_SOME_FAILED });
    }
    let are_processed = found.scenes.iter().all(|scene| scene.is_processed);
    let name = args.store.file_name().map_or_else(|| "import".into(), |name| name.to_string_lossy());
    let progress = Progress::start(args.progress.into(), "import simbev2x".to_owned(), found.agent_frames());
    let watching = Watching(progress);
    let outcome = pool.install(|| import(&source, &store, found, &selection, &name, &watching));
    watching.0.finish();
    let outcome = outcome?;
    for (scene, error) in &outcome.failed {
        tracing::error!("scene {scene} is not imported: {}", runner::report(error));
    }
    let (made, kept, failed) = (outcome.made, outcome.kept, outcome.failed.len());
    let store = args.store.display();
    say(&format!("{store}: {made} scenes imported, {kept} kept, {failed} failed"));
    if made + kept > 0 {
        let next = match are_processed {
            true => "tracks (merge-tracks), then statistics, report and dataset card (stats)",
            false => "statistics, report and dataset card (stats); what is not post-processed has no tracks",
        };
        say(&format!("not made yet: {next}"));
    }
    Ok(if failed == 0 { EXIT_DONE } else { EXIT_SOME_FAILED })
}

/// Holds the store: an import writes the plan when it ends, and knows no scenes that others plan meanwhile.
fn hold(store: &Store) -> Result<Lock, ImportError> {
    runner::hold_alone(store, "import").map_err(|error| match error {
        StageError::Store(error) => ImportError::Store(error),
        StageError::Stopped => ImportError::Stopped,
        error => ImportError::Refused(error.report()),
    })
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
        tracing::warn!("scene {scene} cannot be imported: {}", runner::report(error));
    }
}

/// The progress of a stage, for the import.
struct Watching(Progress);

impl ProgressWatch for Watching {
    fn advance(&self, agent_frames: u64) -> bool {
        self.0.advance(agent_frames).is_err()
    }
}
