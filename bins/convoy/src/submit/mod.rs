//! Scripts that make a dataset on a cluster: an engine starts tasks, and each is a call of this program.

mod args;
mod config_map;
mod groups;
mod kubernetes;
mod ray;
mod size;
mod slurm;
mod storage;
mod there;
mod yaml;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use runner::forecast::{Machine, Work};
use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_USAGE, EditionWish, Graph, PlannedWork, Programs, STAMP_LEN,
    StageError, State, Status, Suspicious, say, settings_or_faults,
};
use settings::{DatasetSettings, change_lines};
use store::{Scope, Store, StoreError};

pub(crate) use self::args::SubmitArgs;

use self::args::Engine;
use self::config_map::ConfigMap;
use self::kubernetes::Jobs;
use self::ray::Driver;
use self::size::{Limits, Most, Size};
use self::slurm::Cluster;
use self::storage::Storage;
use crate::stores::{run_program, stage_program};
use crate::words::quoted;

/// Most tasks of an array where nobody says: one less than Slurm's own `MaxArraySize`.
const LARGEST_ARRAY: u32 = 1000;

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
    args.check_engine().map_err(StageError::usage)?;
    let Some(settings) = settings_or_faults(&args.config, Suspicious::Unsaid) else { return Ok(EXIT_USAGE) };
    store::check_place(&args.store)?;
    let store = if is_url(&args.store) { args.store.clone() } else { absolute(&args.store)? };
    let handed_over = match args.engine {
        Engine::Kubernetes => Some(handed_over(args, &store)?),
        Engine::Slurm | Engine::Ray => None,
    };
    if args.engine == Engine::Ray {
        ray::check_splits(&args.split).map_err(StageError::usage)?;
    }
    there::check(args).map_err(StageError::usage)?;
    let is_in_place = match args.engine {
        Engine::Slurm => true,
        Engine::Kubernetes => false,
        Engine::Ray => !is_url(&store),
    };
    let folder = match &args.to {
        Some(folder) => absolute(folder)?,
        None => jobs_folder(&store)?,
    };
    let is_planned = is_in_place && has_plan(args, &store, &settings, stamp)?;
    // A store gets its plan last: what is refused changes nothing.
    let aside = tempfile::tempdir().map_err(|e| StageError::usage(format!("a temporary folder: {e}")))?;
    let sizes = if is_planned { store.clone() } else { aside.path().join("sizes") };
    if !is_planned {
        let code = plan(args, &sizes, if is_in_place { Words::Errors } else { Words::All })?;
        if code != EXIT_DONE {
            return Ok(code);
        }
    }
    let work = work_of(&sizes, &settings, stamp)?;
    let size = size_of(&work, args).map_err(|problem| {
        let is_there = folder.join("submit.sh").exists();
        let earlier = format!("; the scripts in {} are of an earlier call", folder.display());
        StageError::usage(format!("{problem}{}", if is_there { &earlier } else { "" }))
    })?;
    if is_in_place {
        let code = if is_planned { EXIT_DONE } else { plan(args, &store, Words::All)? };
        if code != EXIT_DONE {
            return Ok(code);
        }
        store::probe(&Store::open(&store)?)?;
    }
    let bytes: f64 = work.values().flat_map(BTreeMap::values).map(|work| work.bytes).sum();

    let has_logs = handed_over.is_none();
    let files = match handed_over {
        Some((storage, config)) => manifests(args, &settings.name, (storage, config), size.tasks)?,
        None => scripts(args, &settings.name, (&store, &folder), size.tasks)?,
    };
    size.lines(bytes).iter().for_each(|line| say(line));
    let made = if has_logs { folder.join("logs") } else { folder.clone() };
    fs::create_dir_all(&made)
        .map_err(|e| StageError::usage(format!("{}: cannot be made: {e}", made.display())))?;
    for (name, text) in files {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|e| StageError::usage(format!("{}: {e}", path.display())))?;
    }
    let script = folder.join("submit.sh");
    if !args.submit {
        say(&format!("written: {} (start it by: bash {})", script.display(), quoted(&script)));
        return Ok(EXIT_DONE);
    }
    match Command::new("bash").arg(&script).status() {
        Ok(status) if status.success() => Ok(EXIT_DONE),
        Ok(_) => Ok(EXIT_SOME_FAILED),
        Err(e) => Err(StageError::usage(format!("bash: {e}"))),
    }
}

/// The files of an engine whose nodes see the folders of this machine.
fn scripts(
    args: &SubmitArgs,
    name: &str,
    (store, folder): (&Path, &Path),
    tasks: u32,
) -> Result<Vec<(String, String)>, StageError> {
    let this_program = std::env::current_exe().map_err(StageError::usage)?;
    // What comes with the programs has its name everywhere.
    let config = match settings::Shipped::at(&args.config) {
        Some(_) => args.config.clone(),
        None => absolute(&args.config)?,
    };
    let maps = args.maps.as_deref().map(absolute).transpose()?;
    let (cores, memory_gib) = (args.cores, args.memory_gib());
    let (store, folder) = (store.to_owned(), folder.to_owned());
    if args.engine == Engine::Ray {
        let driver = Driver {
            config,
            store,
            maps,
            folder,
            program: args.program.clone().unwrap_or(this_program),
            address: args.address.clone(),
            tasks,
            cores,
            memory_gib,
            splits: args.split.clone(),
        };
        return Ok(vec![("submit.sh".to_owned(), driver.script())]);
    }
    let cluster = Cluster {
        name: name.to_owned(),
        convoy: this_program,
        config,
        directory: std::env::current_dir().map_err(StageError::usage)?,
        store,
        maps,
        folder,
        tasks,
        cores,
        memory_gib,
        minutes: args.minutes,
        partition: args.partition.clone(),
        splits: args.split.clone(),
        options: args.option.clone(),
        at_once: args.at_once,
    };
    Ok(cluster.scripts())
}

/// What pods are given of the store and of the configuration.
fn handed_over(args: &SubmitArgs, store: &Path) -> Result<(Storage, ConfigMap), StageError> {
    kubernetes::check_splits(&args.split).map_err(StageError::usage)?;
    let storage = Storage::of(store, args.volume_claim.as_ref()).map_err(StageError::usage)?;
    Ok((storage, ConfigMap::read(&args.config).map_err(StageError::usage)?))
}

/// The files of Kubernetes.
fn manifests(
    args: &SubmitArgs,
    name: &str,
    (storage, config): (Storage, ConfigMap),
    tasks: u32,
) -> Result<Vec<(String, String)>, StageError> {
    let jobs = Jobs {
        name: name.to_owned(),
        // The command line has one.
        image: args.image.clone().unwrap_or_default(),
        namespace: args.namespace.clone(),
        secret: args.secret.clone(),
        storage,
        maps: args.maps.as_deref().map(absolute).transpose()?,
        config,
        tasks,
        cores: args.cores,
        memory_gib: args.memory_gib(),
        splits: args.split.clone(),
        at_once: args.at_once,
    };
    Ok(jobs.files())
}

fn is_url(store: &Path) -> bool {
    store.to_str().is_some_and(|text| text.contains("://"))
}

fn absolute(path: &Path) -> Result<PathBuf, StageError> {
    std::path::absolute(path).map_err(StageError::usage)
}

/// Where scripts go by themselves: beside the store, or into the folder of whoever calls where it is a URL.
fn jobs_folder(store: &Path) -> Result<PathBuf, StageError> {
    let name = store.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let jobs = format!("{name}-jobs");
    if is_url(store) { absolute(Path::new(&jobs)) } else { Ok(store.with_file_name(jobs)) }
}

/// Whether a store has a plan by this configuration. One by another is not touched here: who plans is told
/// what that makes again.
fn has_plan(
    args: &SubmitArgs,
    place: &Path,
    settings: &DatasetSettings,
    stamp: &[u8; STAMP_LEN],
) -> Result<bool, StageError> {
    let store = match Store::open_made(place) {
        Ok(store) => store,
        Err(StoreError::NoStore { .. }) => return Ok(false),
        // One that cannot be had is no new one.
        Err(e) => return Err(e.into()),
    };
    let editions = runner::Editions::of_store(&store, settings, EditionWish::Known)?;
    let programs = Programs::of_build(stamp, None);
    let planner = Graph::get().planner();
    // Settings of sensors change no plan, but what is made by it.
    let (changes, _) = editions.changes();
    let why = match Status::new(&store, &editions, &programs).state(planner, Scope::Plan)? {
        State::Missing | State::Failed(_) => return Ok(false),
        State::Done if changes.is_empty() => return Ok(true),
        State::Done => "the configuration changed".to_owned(),
        State::Stale(why) => why.to_string(),
    };
    let changes: String = change_lines(&changes).iter().map(|line| format!("\n  {line}")).collect();
    let (place, config) = (quoted(place), quoted(&args.config));
    Err(StageError::usage(format!(
        "{place}: has a plan already, and {why}: see first what another one makes again, by `convoy run --stages \
         plan --config {config} --store {place}` (it asks, or wants --redo or --grow){changes}"
    )))
}

/// What the plan of a store will cost.
fn work_of(
    store: &Path,
    settings: &DatasetSettings,
    stamp: &[u8; STAMP_LEN],
) -> Result<PlannedWork, StageError> {
    let store = Store::open(store)?;
    let editions = runner::Editions::of_store(&store, settings, EditionWish::Known)?;
    let programs = Programs::of_build(stamp, None);
    runner::planned_work(&Status::new(&store, &editions, &programs))
}

/// How many tasks end in time at the speed of this machine, or why none do.
fn size_of(work: &PlannedWork, args: &SubmitArgs) -> Result<Size, String> {
    let times = Machine::measured().times;
    let sum = |stages: &BTreeMap<_, Work>| stages.values().map(|work| work.core_s).sum::<f64>();
    let work_s: BTreeMap<u32, f64> =
        work.iter().map(|(scene, stages)| (*scene, times * sum(stages))).collect();
    let most = match args.engine {
        Engine::Slurm => Most::Array(args.largest_array.unwrap_or(LARGEST_ARRAY)),
        Engine::Kubernetes => Most::Job(kubernetes::MOST_TASKS),
        Engine::Ray => Most::Any,
    };
    Size::choose(&work_s, args.tasks, Limits { minutes: args.minutes, cores: args.cores, most })
}

/// What the planner says.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Words {
    All,
    /// Why it makes no plan; it is started once more.
    Errors,
}

/// Makes the plan in a store, or keeps it; the planner's exit code.
fn plan(args: &SubmitArgs, store: &Path, words: Words) -> Result<u8, StageError> {
    let planner = Graph::get().planner().name;
    let Ok(mut command) = stage_program(planner) else { return Ok(EXIT_SOME_FAILED) };
    command.arg("--config").arg(&args.config).arg("--store").arg(store);
    if let Some(maps) = &args.maps {
        command.arg("--maps").arg(maps);
    }
    if words == Words::Errors {
        command.args(["--progress", "none"]).env("CONVOY_LOG", "error");
    }
    Ok(run_program(&mut command))
}
