//! Scripts that make a dataset on a cluster: an engine starts tasks, and each is a call of this program.

mod size;
mod slurm;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::ValueEnum;
use runner::forecast::Machine;
use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_USAGE, EditionWish, Graph, Programs, STAMP_LEN, StageError, Status,
    Suspicious, say, settings_or_faults,
};

use self::size::{Limits, Size};
use self::slurm::{Cluster, Split};
use crate::stores::{run_program, stage_program};

/// What `convoy submit` takes. The plan is made at once, here: what it will cost is told from it.
#[derive(Debug, clap::Args)]
pub(crate) struct SubmitArgs {
    /// What starts the tasks.
    #[arg(long, value_enum)]
    engine: Engine,
    /// Dataset configuration (TOML, or YAML of SimBEV2X).
    #[arg(long, value_name = "FILE")]
    config: PathBuf,
    /// The store, in a place that all nodes see.
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Folder with OpenDRIVE files.
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
    /// How many tasks (default: as many as end in time).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    tasks: Option<u32>,
    /// Minutes that a task may take.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(5..))]
    minutes: u32,
    /// Cores of a task.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    cores: u32,
    /// Memory of a task, GiB (default: 2 and one for each core).
    #[arg(long, value_name = "GIB", value_parser = clap::value_parser!(u32).range(1..))]
    memory: Option<u32>,
    /// Partition of all tasks.
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// A stage whose tasks go elsewhere: `render-sensors=gpu` to another partition, with further options of
    /// the engine after commas (`render-sensors=gpu,--gres=gpu:1`).
    #[arg(long, value_name = "STAGE=PARTITION[,OPTION]")]
    split: Vec<Split>,
    /// A further option of the engine for all jobs, such as `--account=lab`.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    option: Vec<String>,
    /// Tasks that may run at once (default: all).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    at_once: Option<u32>,
    /// Most tasks that the engine takes as one array (Slurm: one less than `MaxArraySize`).
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..))]
    largest_array: u32,
    /// Folder for the scripts and their logs (default: the store's name with `-jobs`, beside it).
    #[arg(long, value_name = "DIR")]
    to: Option<PathBuf>,
    /// Send them as well.
    #[arg(long)]
    submit: bool,
}

/// What starts tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Engine {
    /// Slurm: a job that plans, an array of tasks, a job that joins.
    Slurm,
}

/// Writes the scripts; the exit code.
pub(crate) fn run(args: &SubmitArgs, stamp: &[u8; STAMP_LEN]) -> u8 {
    match submit(args, stamp) {
        Ok(code) => code,
        Err(e) => {
            tracing::error!("{}", e.report());
            e.exit_code()
        }
    }
}

fn submit(args: &SubmitArgs, stamp: &[u8; STAMP_LEN]) -> Result<u8, StageError> {
    let Engine::Slurm = args.engine;
    let Some(settings) = settings_or_faults(&args.config, Suspicious::Unsaid) else { return Ok(EXIT_USAGE) };
    if args.submit {
        is_there(args)?;
    }
    let code = plan(args)?;
    if code != EXIT_DONE {
        return Ok(code);
    }
    let store = store::Store::open(&args.store)?;
    let editions = runner::Editions::of_store(&store, &settings, EditionWish::Known)?;
    let programs = Programs::of_build(stamp, None);
    let status = Status::new(&store, &editions, &programs);
    let times = Machine::measured().times;
    let sum =
        |stages: &BTreeMap<_, runner::forecast::Work>| stages.values().map(|work| work.core_s).sum::<f64>();
    let work = runner::planned_work(&status)?;
    let work_s: BTreeMap<u32, f64> =
        work.iter().map(|(scene, stages)| (*scene, times * sum(stages))).collect();
    let bytes: f64 = work.values().flat_map(BTreeMap::values).map(|work| work.bytes).sum();
    let limits = Limits { minutes: args.minutes, cores: args.cores, largest_array: args.largest_array };
    let size = Size::choose(&work_s, args.tasks, limits).map_err(StageError::usage)?;

    let absolute = |path: &Path| std::path::absolute(path).map_err(StageError::usage);
    let root = absolute(&args.store)?;
    let folder = match &args.to {
        Some(folder) => absolute(folder)?,
        None => {
            let name = root.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            root.with_file_name(format!("{name}-jobs"))
        }
    };
    let cluster = Cluster {
        name: settings.name.clone(),
        convoy: std::env::current_exe().map_err(StageError::usage)?,
        config: absolute(&args.config)?,
        store: root,
        maps: args.maps.as_deref().map(absolute).transpose()?,
        folder: folder.clone(),
        tasks: size.tasks,
        cores: args.cores,
        memory_gib: args.memory.unwrap_or(2 + args.cores),
        minutes: args.minutes,
        partition: args.partition.clone(),
        splits: args.split.clone(),
        options: args.option.clone(),
        at_once: args.at_once,
    };
    size.lines(bytes).iter().for_each(|line| say(line));
    let write = |(name, text): (String, String)| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|e| StageError::usage(format!("{}: {e}", path.display())))
    };
    fs::create_dir_all(folder.join("logs"))
        .map_err(|e| StageError::usage(format!("{}: cannot be made: {e}", folder.display())))?;
    cluster.scripts().into_iter().try_for_each(write)?;
    let script = folder.join("submit.sh");
    if !args.submit {
        say(&format!("written: {0} (start it by: bash {0})", script.display()));
        return Ok(EXIT_DONE);
    }
    match Command::new("bash").arg(&script).status() {
        Ok(status) if status.success() => Ok(EXIT_DONE),
        Ok(_) => Ok(EXIT_SOME_FAILED),
        Err(e) => Err(StageError::usage(format!("bash: {e}"))),
    }
}

/// Makes the plan, or keeps it; the planner's exit code.
fn plan(args: &SubmitArgs) -> Result<u8, StageError> {
    let planner = Graph::get().planner().name;
    let Ok(mut command) = stage_program(planner) else { return Ok(EXIT_SOME_FAILED) };
    command.arg("--config").arg(&args.config).arg("--store").arg(&args.store);
    if let Some(maps) = &args.maps {
        command.arg("--maps").arg(maps);
    }
    Ok(run_program(&mut command))
}

/// Refuses where the engine is not there, or knows no such partition: before anything is written.
fn is_there(args: &SubmitArgs) -> Result<(), StageError> {
    let none =
        |e| StageError::usage(format!("--submit: sinfo cannot be started ({e}): is this a node of Slurm?"));
    let known = Command::new("sinfo").args(["-h", "-o", "%R"]).output().map_err(none)?;
    if !known.status.success() {
        let said = String::from_utf8_lossy(&known.stderr).trim().to_owned();
        return Err(StageError::usage(format!("--submit: Slurm does not answer: {said}")));
    }
    let known: Vec<String> =
        String::from_utf8_lossy(&known.stdout).lines().map(|line| line.trim().to_owned()).collect();
    let wanted = args.partition.iter().chain(args.split.iter().map(|split| &split.partition));
    match wanted.into_iter().find(|wanted| !known.contains(wanted)) {
        Some(unknown) => Err(StageError::usage(format!(
            "there is no partition `{unknown}`; there are {}",
            known.join(", ")
        ))),
        None => Ok(()),
    }
}
