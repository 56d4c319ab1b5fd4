//! What the `convoy` program does with stores: all stages in order, the status table, verification.

mod member;
mod merge;
mod mixed;
mod replanning;
mod status;
mod tidy;
mod verify;
mod why;

use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

use arguments::device::DeviceArgs;
use arguments::stage::Progress;
use clap::Subcommand;

use self::replanning::Replanning;

use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Graph, Programs, STAMP_LEN, SceneList,
    Suspicious, UnitKind, say,
};

/// How often a running stage is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Commands of the `convoy` program that concern a store.
#[derive(Debug, Subcommand)]
pub(crate) enum StoreCommand {
    /// Runs everything that is missing or stale, in order.
    Run {
        /// Dataset configuration (TOML, or YAML of SimBEV2X).
        #[arg(long, value_name = "FILE")]
        config: PathBuf,
        /// The store: a folder, by its path or as file:///FOLDER.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
        /// Folder with OpenDRIVE files.
        #[arg(long, value_name = "DIR")]
        maps: Option<PathBuf>,
        /// Only these scenes.
        #[arg(long, value_name = "LIST")]
        scenes: Option<String>,
        /// Keep planned scenes as they are: scenes that the configuration asks for beyond them are an edition
        /// of their own.
        #[arg(long, conflicts_with = "edition")]
        grow: bool,
        /// Put the configuration in place of one edition of the store, by its number (default: the one that
        /// it equals, else the newest).
        #[arg(long, value_name = "N")]
        edition: Option<u32>,
        /// Make finished work again that a changed configuration or newer code makes stale. Without it
        /// `run` asks, or ends with 2 and touches nothing, where that is more than `store.ask_beyond_s`.
        #[arg(long)]
        redo: bool,
        /// Warnings about the configuration and about the plan are errors (2).
        #[arg(long)]
        strict: bool,
        /// Let a configuration of another name take over the store.
        #[arg(long, conflicts_with = "accept_code")]
        force: bool,
        /// Keep what older code made, where nothing else changed; the manifests say so. For upgrades in
        /// mid-dataset.
        #[arg(long)]
        accept_code: bool,
        #[command(flatten)]
        device: DeviceArgs,
        /// Worker threads.
        #[arg(long, value_name = "N")]
        threads: Option<usize>,
        /// Only say what would be done.
        #[arg(long)]
        dry_run: bool,
        /// How to show progress.
        #[arg(long, value_enum, default_value = "auto")]
        progress: Progress,
    },
    /// Prints a table of scenes and stages: done, stale, failed, missing.
    Status {
        /// Dataset configuration (TOML, or YAML of SimBEV2X); a store that was imported needs none.
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
        /// The store: a folder, by its path or as file:///FOLDER.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
        /// Folder with OpenDRIVE files: what changed there is looked for, too.
        #[arg(long, value_name = "DIR")]
        maps: Option<PathBuf>,
        /// Only these scenes.
        #[arg(long, value_name = "LIST")]
        scenes: Option<SceneList>,
        /// What a run with `--grow` would find.
        #[arg(long, conflicts_with = "edition")]
        grow: bool,
        /// What a run with `--edition N` would find.
        #[arg(long, value_name = "N")]
        edition: Option<u32>,
        /// Only why a stage of a scene is done, stale, missing or failed: the changed keys that it sees, what
        /// it was made from, and the same of that, down to the plan.
        #[arg(long, num_args = 2, value_names = ["SCENE", "STAGE"], conflicts_with = "scenes")]
        why: Option<Vec<String>>,
        /// Say what is suspicious in the configuration; it is an error (2).
        #[arg(long)]
        strict: bool,
    },
    /// Takes into a store all that other stores of the same plan have and it has not: scenes that were made
    /// on several machines.
    Merge {
        /// The store that takes it: a folder, by its path or as file:///FOLDER; made where there is none.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
        /// Take scenes of other settings, too: each keeps the settings that it was made by, as an edition of
        /// them. Scenes that both stores have must be the same; `first_scene` keeps numbers apart.
        #[arg(long)]
        mixed: bool,
        /// Stores that are joined; they stay as they are.
        #[arg(required = true, value_name = "STORE")]
        from: Vec<PathBuf>,
    },
    /// Removes tiles of the static world that no scene's log names: those of older code or other settings,
    /// and locks of the dead. Not while anything else works on the store.
    Tidy {
        /// The store: a folder, by its path or as file:///FOLDER.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
    },
    /// Re-hashes a store and names every missing, truncated or changed shard.
    Verify {
        /// The store: a folder, by its path or as file:///FOLDER.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
    },
}

/// Runs a command; logging must have been started. `stamp` is the build's (`build_stamp::STAMP`). The exit
/// code is one of `EXIT_*`.
#[must_use]
pub(crate) fn drive(command: StoreCommand, stamp: &[u8; STAMP_LEN]) -> u8 {
    match command {
        StoreCommand::Run {
            config,
            store,
            maps,
            scenes,
            grow,
            edition,
            redo,
            strict,
            force,
            accept_code,
            device,
            threads,
            dry_run,
            progress,
        } => {
            let mut common: Vec<String> = vec!["--config".into(), config.display().to_string()];
            common.extend(["--store".into(), store.display().to_string()]);
            if let Some(maps) = maps {
                common.extend(["--maps".into(), maps.display().to_string()]);
            }
            common.extend(device.words());
            if let Some(threads) = threads {
                common.extend(["--threads".into(), threads.to_string()]);
            }
            if accept_code {
                common.push("--accept-code".into());
            }
            if grow {
                common.push("--grow".into());
            }
            if let Some(edition) = edition {
                common.extend(["--edition".into(), edition.to_string()]);
            }
            if dry_run {
                common.push("--dry-run".into());
            }
            common.extend(["--progress".into(), progress.word().into()]);
            let of_planner = [("--redo", redo), ("--force", force), ("--strict", strict)];
            let of_planner = of_planner.into_iter().filter(|(_, wanted)| *wanted);
            let of_planner: Vec<&str> = of_planner.map(|(word, _)| word).collect();
            runner::listen_for_signals();
            // A device that is not there is said before anything is planned.
            if device.must_be_there()
                && let Err(code) = device_is_there(&device)
            {
                return code;
            }
            let lock = if dry_run { Ok(None) } else { runner::hold_for_all_stages(&config, &store) };
            match lock {
                Ok(_lock) => run(&common, &of_planner, scenes.as_deref(), &store),
                Err(e) => {
                    tracing::error!("{}", e.report());
                    e.exit_code()
                }
            }
        }
        StoreCommand::Status { config, store, maps, scenes, why, grow, edition, strict } => {
            let programs = Programs::of_build(stamp, None);
            let place = (&*store, arguments::stage::edition_wish(grow, edition));
            match (why.as_deref(), config.as_deref()) {
                (Some([scene, stage]), config) => why::why(config, place, (scene, stage), &programs),
                // What is only suspicious, `run` says.
                (_, Some(config)) => {
                    let rule = Suspicious::of(strict, false);
                    let plan = Replanning::new(config, &store, maps.as_deref(), (grow, edition));
                    status::status((config, rule), place, scenes.as_ref(), (&programs, &plan))
                }
                (_, None) => status::status_of_import(&store, scenes.as_ref(), &programs),
            }
        }
        StoreCommand::Merge { store, mixed, from } => merge::merge(&store, &from, mixed),
        StoreCommand::Tidy { store } => tidy::tidy(&store),
        StoreCommand::Verify { store } => verify::verify(&store),
    }
}

/// Runs every stage as a process of its own: a stage's memory ends with it, and a crash is the stage's alone.
fn run(common: &[String], of_planner: &[&str], scenes: Option<&str>, store: &std::path::Path) -> u8 {
    let mut worst = EXIT_DONE;
    let mut times = Vec::new();
    for stage in &Graph::get().stages {
        let mut command = match stage_program(stage.name) {
            Ok(command) => command,
            Err(code) => return code,
        };
        command.args(common);
        if let (UnitKind::Scene, Some(scenes)) = (stage.unit, scenes) {
            command.args(["--scenes", scenes]);
        }
        // The planner asks for all stages, and records what was agreed: they do not ask again.
        if stage.unit == UnitKind::Plan {
            command.args(of_planner);
        } else {
            command.arg("--redo-older");
        }
        let start = Instant::now();
        let code = run_program(&mut command);
        times.push((stage.name, start.elapsed().as_secs_f64(), code));
        worst = worst.max(code);
        if code == EXIT_USAGE || code == EXIT_TRY_AGAIN || (code != EXIT_DONE && stage.unit == UnitKind::Plan)
        {
            break;
        }
    }
    say(&format!("{:<20} {:>9}", "stage", "seconds"));
    for (name, secs, code) in &times {
        let outcome = match *code {
            EXIT_DONE => "",
            EXIT_SOME_FAILED => "  some scenes failed",
            EXIT_USAGE => "  bad arguments or configuration",
            EXIT_TRY_AGAIN => "  stopped, run again",
            _ => "  crashed",
        };
        say(&format!("{name:<20} {secs:>9.1}{outcome}"));
    }
    let total: f64 = times.iter().map(|(_, secs, _)| secs).sum();
    say(&format!("{:<20} {total:>9.1}", "total"));
    if worst != EXIT_USAGE && worst != EXIT_TRY_AGAIN {
        let root = store.display();
        say(&format!("dataset: {root} (scenes in {root}/scenes, report in {root}/stats/report.html)"));
    }
    worst
}

/// Whether there is a device of this name; the exit code where there is none, which is said.
fn device_is_there(device: &DeviceArgs) -> Result<(), u8> {
    let mut command = stage_program("render-sensors")?;
    match run_program(command.arg("--try-device").args(device.words())) {
        EXIT_DONE => Ok(()),
        code => Err(code),
    }
}

/// A stage's program, which lies beside this one; the exit code if nobody knows where that is.
fn stage_program(name: &str) -> Result<Command, u8> {
    match std::env::current_exe() {
        Ok(exe) => Ok(Command::new(exe.with_file_name(name))),
        Err(e) => {
            tracing::error!("cannot find the stage programs: {e}");
            Err(EXIT_SOME_FAILED)
        }
    }
}

/// Runs a stage program to its end and returns its exit code, or that of what goes wrong, which is said. A
/// signal that ends this program ends the stage first.
fn run_program(command: &mut Command) -> u8 {
    try_run_program(command).unwrap_or_else(|e| {
        let program = command.get_program().display();
        tracing::error!("{program}: cannot start: {e} (build the workspace first)");
        EXIT_USAGE
    })
}

fn try_run_program(command: &mut Command) -> std::io::Result<u8> {
    let mut child = command.spawn()?;
    let mut told = false;
    loop {
        if let Some(status) = child.try_wait()? {
            let code = status.code().map_or(EXIT_TRY_AGAIN, |c| u8::try_from(c).unwrap_or(EXIT_SOME_FAILED));
            // A stage may end in time by itself; the next one is not started.
            return Ok(if runner::was_stopped() { EXIT_TRY_AGAIN } else { code });
        }
        if runner::was_stopped() && !told {
            told = true;
            // If it is gone already, the next look sees it.
            let _ = rustix::process::kill_process(
                rustix::process::Pid::from_child(&child),
                rustix::process::Signal::TERM,
            );
        }
        std::thread::sleep(LOOK_EVERY);
    }
}
