//! What the `convoy` program does with stores: all stages in order, the status table, verification.

mod forecast;
mod member;
mod merge;
mod mixed;
mod progress;
mod replanning;
mod run;
mod status;
mod tidy;
mod verify;
mod why;

use std::path::PathBuf;
use std::time::Duration;

use clap::Subcommand;
use runner::{Programs, STAMP_LEN, SceneList, Suspicious};

use self::forecast::ForecastArgs;
use self::replanning::Replanning;
pub(crate) use self::run::{RunArgs, run as run_stages, run_program, stage_program};
use self::status::Told;

/// Commands of the `convoy` program that concern a store.
#[derive(Debug, Subcommand)]
pub(crate) enum StoreCommand {
    /// Runs everything that is missing or stale, in order.
    Run(RunArgs),
    /// Says what a configuration comes to: scenes, frames, bytes and time, and how much of it is still to do.
    /// Writes nothing.
    Forecast(ForecastArgs),
    /// Prints a table of scenes and stages: done, stale, failed, missing.
    Status {
        /// Dataset configuration (TOML, or YAML of SimBEV2X); without one, that which the store was planned
        /// by.
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
        /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
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
        /// Print all of it as JSON, for dashboards.
        #[arg(long, conflicts_with_all = ["why", "scenes", "watch"])]
        json: bool,
        /// Print counts, the rate of the last minutes, the time that is left and failures, every so many
        /// seconds until all is done.
        #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "10",
            value_parser = clap::value_parser!(u64).range(1..), conflicts_with_all = ["why", "scenes"])]
        watch: Option<u64>,
        /// Say what is suspicious in the configuration; it is an error (2).
        #[arg(long)]
        strict: bool,
    },
    /// Takes into a store all that other stores of the same plan have and it has not: scenes that were made
    /// on several machines.
    Merge {
        /// The store that takes it: a folder, or s3://BUCKET/FOLDER (az://, gs://); made where there is none.
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
        /// Take scenes of other settings, too: each keeps the settings that it was made by, as an edition of
        /// them. Scenes that both stores have must be the same; `first_scene` keeps numbers apart.
        #[arg(long)]
        mixed: bool,
        /// Only these scenes: what copies some from a bucket, say.
        #[arg(long, value_name = "LIST")]
        scenes: Option<SceneList>,
        /// Stores that are joined; they stay as they are.
        #[arg(required = true, value_name = "STORE")]
        from: Vec<PathBuf>,
    },
    /// Removes tiles of the static world that no scene's log names (those of older code or other settings),
    /// files that no manifest names, older than a day, in scenes in which all is done, and locks of the dead.
    /// Not while anything else works on the store.
    Tidy {
        /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
    },
    /// Re-hashes a store and names every missing, truncated or changed shard.
    Verify {
        /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
        #[arg(long, value_name = "DIR")]
        store: PathBuf,
    },
}

/// Runs a command; logging must have been started. `stamp` is the build's (`build_stamp::STAMP`). The exit
/// code is one of `EXIT_*`.
#[must_use]
pub(crate) fn drive(command: StoreCommand, stamp: &[u8; STAMP_LEN]) -> u8 {
    match command {
        StoreCommand::Run(args) => run::run(&args, stamp),
        StoreCommand::Forecast(args) => forecast::forecast(&args, stamp),
        StoreCommand::Status { config, store, maps, scenes, why, grow, edition, strict, json, watch } => {
            let programs = Programs::of_build(stamp, None);
            let (config, maps) = (config.as_deref(), maps.as_deref());
            let place = (&*store, arguments::stage::edition_wish(grow, edition));
            if let Some([scene, stage]) = why.as_deref() {
                return why::why(config, place, (scene, stage), &programs);
            }
            let plan = config.map(|config| Replanning::new(config, &store, maps, (grow, edition)));
            let told = match watch {
                Some(seconds) => Told::Watched(Duration::from_secs(seconds)),
                None if json => Told::Json,
                None => Told::Table(scenes.as_ref()),
            };
            // What is only suspicious, `run` says.
            let rule = Suspicious::of(strict, false);
            status::status((config, rule), place, told, (&programs, plan.as_ref()))
        }
        StoreCommand::Merge { store, mixed, scenes, from } => {
            merge::merge(&store, &from, scenes.as_ref(), mixed)
        }
        StoreCommand::Tidy { store } => tidy::tidy(&store),
        StoreCommand::Verify { store } => verify::verify(&store),
    }
}
