//! All stages, or some, one after the other; or, as a task of many, of a share of the scenes.

use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

use arguments::device::DeviceArgs;
use arguments::stage::Progress;
use runner::{
    EXIT_DONE, EXIT_KILLED, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Graph, Programs, STAMP_LEN,
    SceneList, Shard, StageSpec, Suspicious, TaskRules, TaskScene, UnitKind, say, settings_or_faults,
};

/// How often a running stage is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// What `convoy run` takes.
#[derive(Debug, clap::Args)]
pub(crate) struct RunArgs {
    /// Dataset configuration (TOML, or YAML of SimBEV2X), or the name of one that comes with this program
    /// (`convoy config list`). Where the planner is not among the stages, the store's own will do.
    #[arg(long, value_name = "FILE", required_unless_present = "stages")]
    config: Option<PathBuf>,
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    #[arg(long, value_name = "DIR")]
    store: PathBuf,
    /// Folder with OpenDRIVE files.
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
    /// Only these stages, in their order: `plan`, `scenes` (all that work on scenes), `stats`, or names
    /// (default: all).
    #[arg(long, value_name = "LIST")]
    stages: Option<StageList>,
    /// Only these scenes.
    #[arg(long, value_name = "LIST")]
    scenes: Option<SceneList>,
    /// A task of many: one of N shares of the scenes that take about as long, I from 0, scene by scene
    /// through all stages. Nobody is asked: what would need a yes ends with 2. With only N, I comes from
    /// SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX.
    #[arg(
        long,
        value_name = "[I/]N",
        requires = "stages",
        conflicts_with_all = ["scenes", "grow", "edition", "dry_run"]
    )]
    shard: Option<Shard>,
    /// Keep planned scenes as they are: scenes that the configuration asks for beyond them are an edition of
    /// their own.
    #[arg(long, conflicts_with = "edition")]
    grow: bool,
    /// Put the configuration in place of one edition of the store, by its number (default: the one that it
    /// equals, else the newest).
    #[arg(long, value_name = "N")]
    edition: Option<u32>,
    /// Make finished work again that a changed configuration or newer code makes stale. Without it `run`
    /// asks, or ends with 2 and touches nothing, where that is more than `store.ask_beyond_s`.
    #[arg(long)]
    redo: bool,
    /// Warnings about the configuration and about the plan are errors (2).
    #[arg(long)]
    strict: bool,
    /// Make what is done again; of the planner: let a configuration of another name take over the store.
    /// Where the planner is among the stages, it is for that alone.
    #[arg(long, conflicts_with_all = ["accept_code", "shard"])]
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
}

/// Stages, in running order.
#[derive(Clone, Debug)]
struct StageList(Vec<&'static StageSpec>);

impl std::str::FromStr for StageList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split(',').map(str::trim).collect();
        let is_meant = |stage: &StageSpec, word: &str| match word {
            "plan" => stage.unit == UnitKind::Plan,
            "scenes" => stage.unit == UnitKind::Scene,
            word => stage.name == word,
        };
        let all = &Graph::get().stages;
        if let Some(word) = words.iter().find(|word| !all.iter().any(|stage| is_meant(stage, word))) {
            let names: Vec<&str> = all.iter().map(|stage| stage.name).collect();
            return Err(format!("there is no stage `{word}`; there are plan, scenes, {}", names.join(", ")));
        }
        let is_wanted = |stage: &&StageSpec| words.iter().any(|word| is_meant(stage, word));
        Ok(Self(all.iter().filter(is_wanted).collect()))
    }
}

impl RunArgs {
    /// A whole dataset with nothing out of the ordinary.
    pub(crate) fn of_dataset(
        config: PathBuf,
        store: PathBuf,
        device: DeviceArgs,
        (threads, progress): (Option<usize>, Progress),
    ) -> Self {
        Self {
            config: Some(config),
            store,
            maps: None,
            stages: None,
            scenes: None,
            shard: None,
            grow: false,
            edition: None,
            redo: false,
            strict: false,
            force: false,
            accept_code: false,
            device,
            threads,
            dry_run: false,
            progress,
        }
    }

    /// The stages that are meant.
    fn stages(&self) -> Vec<&'static StageSpec> {
        match &self.stages {
            Some(StageList(stages)) => stages.clone(),
            None => Graph::get().stages.iter().collect(),
        }
    }

    /// What every stage is told.
    fn common(&self) -> Vec<String> {
        let mut words: Vec<String> = vec!["--store".into(), self.store.display().to_string()];
        if let Some(config) = &self.config {
            words.extend(["--config".into(), config.display().to_string()]);
        }
        if let Some(maps) = &self.maps {
            words.extend(["--maps".into(), maps.display().to_string()]);
        }
        words.extend(self.device.words());
        if let Some(threads) = self.threads {
            words.extend(["--threads".into(), threads.to_string()]);
        }
        if let Some(edition) = self.edition {
            words.extend(["--edition".into(), edition.to_string()]);
        }
        let flags = [("--accept-code", self.accept_code), ("--grow", self.grow), ("--dry-run", self.dry_run)];
        words.extend(flags.into_iter().filter(|(_, wanted)| *wanted).map(|(word, _)| word.to_owned()));
        words.extend(["--progress".into(), self.progress.word().into()]);
        words
    }
}

/// Runs stages as processes of their own: a stage's memory ends with it, and a crash is the stage's alone.
pub(crate) fn run(args: &RunArgs, stamp: &[u8; STAMP_LEN]) -> u8 {
    runner::listen_for_signals();
    let stages = args.stages();
    if args.config.is_none() && stages.iter().any(|stage| stage.unit == UnitKind::Plan) {
        tracing::error!("the planner needs --config FILE");
        return EXIT_USAGE;
    }
    if let (Some(_), Some(stage)) = (&args.shard, stages.iter().find(|stage| stage.unit != UnitKind::Scene)) {
        tracing::error!("--shard: {} works on the whole dataset: give it a run of its own", stage.name);
        return EXIT_USAGE;
    }
    // A device that is not there is said before anything is planned.
    let is_looked = stages.iter().any(|stage| stage.name == "render-sensors");
    if is_looked
        && args.device.must_be_there()
        && let Err(code) = device_is_there(&args.device)
    {
        return code;
    }
    let hold = || runner::hold_for_all_stages(args.config.as_deref(), &args.store);
    let _lock = match if args.dry_run { Ok(None) } else { hold() } {
        Ok(lock) => lock,
        Err(e) => {
            tracing::error!("{}", e.report());
            return e.exit_code();
        }
    };
    let mut table = Table { common: args.common(), rows: Vec::new(), worst: EXIT_DONE };
    let ended = match args.shard {
        Some(shard) => of_task(args, (shard, &stages), stamp, &mut table),
        None => {
            of_stages(args, &stages, &mut table);
            None
        }
    };
    if let Some(code) = ended {
        return code;
    }
    table.tell();
    if args.stages.is_none() && table.worst <= EXIT_SOME_FAILED {
        let root = args.store.display();
        say(&format!("dataset: {root} (scenes in {root}/scenes, report in {root}/stats/report.html)"));
    }
    table.worst
}

/// Runs stages one after the other, each of all scenes that are meant.
fn of_stages(args: &RunArgs, stages: &[&StageSpec], table: &mut Table) {
    let of_planner = [("--redo", args.redo), ("--force", args.force), ("--strict", args.strict)];
    let of_planner: Vec<&str> =
        of_planner.into_iter().filter(|(_, wanted)| *wanted).map(|(word, _)| word).collect();
    let is_planned = stages.iter().any(|stage| stage.unit == UnitKind::Plan);
    let scenes = args.scenes.as_ref().map(ToString::to_string);
    let in_run = stages.iter().map(|stage| stage.name).collect::<Vec<_>>().join(",");
    for stage in stages {
        let mut words: Vec<&str> = vec!["--in-run", in_run.as_str()];
        if let (UnitKind::Scene, Some(scenes)) = (stage.unit, &scenes) {
            words.extend(["--scenes", scenes]);
        }
        // The planner asks for all stages, and records what was agreed: they do not ask again.
        match (stage.unit, is_planned) {
            (UnitKind::Plan, _) => words.extend(&of_planner),
            (_, true) => words.push("--redo-older"),
            (_, false) if args.force => words.push("--force"),
            (_, false) => words.extend(args.redo.then_some("--redo")),
        }
        let code = table.run(stage, &words);
        if is_final(code) || (code != EXIT_DONE && stage.unit == UnitKind::Plan) {
            return;
        }
    }
}

/// Runs a share of the scenes, each through all stages; an exit code where nothing could be begun.
fn of_task(
    args: &RunArgs,
    (shard, stages): (Shard, &[&'static StageSpec]),
    stamp: &[u8; STAMP_LEN],
    table: &mut Table,
) -> Option<u8> {
    let rule = Suspicious::of(args.strict, false);
    let settings = match &args.config {
        Some(config) => match settings_or_faults(config, rule) {
            Some(settings) => Some(settings),
            None => return Some(EXIT_USAGE),
        },
        None => None,
    };
    let rules = TaskRules { redo: args.redo, accept_code: args.accept_code };
    let programs = Programs::of_build(stamp, None);
    let task = runner::task((settings.as_ref(), &args.store), shard, stages, (&programs, rules));
    let scenes = match task {
        Ok(scenes) => scenes,
        Err(e) => {
            tracing::error!("{}", e.report());
            return Some(e.exit_code());
        }
    };
    let (index, count) = (shard.index, shard.count);
    tracing::info!("share {index} of {count}: {} scenes to make", scenes.len());
    let all_s: f64 = scenes.iter().flat_map(|scene| &scene.stages).map(|(_, work_s)| work_s).sum();
    let (start, mut done_s, all) = (Instant::now(), 0.0, scenes.len());
    for (number, TaskScene { scene, stages }) in scenes.into_iter().enumerate() {
        if let Some((amount, unit)) = time_left(start.elapsed(), done_s, all_s) {
            tracing::info!("scene {} of {all} of this share: {amount} {unit} left", number + 1);
        }
        done_s += stages.iter().map(|(_, work_s)| work_s).sum::<f64>();
        let scene = scene.to_string();
        for (stage, _) in stages {
            let code = table.run(stage, &["--scenes", &scene, "--redo"]);
            if is_final(code) {
                return None;
            }
            if code != EXIT_DONE {
                // What is made from it cannot be made.
                break;
            }
        }
    }
    None
}

/// How long the rest of some work takes at the pace of what is done; nothing before anything is.
fn time_left(since: Duration, done_s: f64, all_s: f64) -> Option<(String, &'static str)> {
    let is_known = done_s > 0.0 && done_s < all_s;
    is_known.then(|| runner::forecast::span(since.as_secs_f64() * (all_s - done_s) / done_s))
}

/// Whether nothing more is to be tried after an exit code.
fn is_final(code: u8) -> bool {
    [EXIT_USAGE, EXIT_TRY_AGAIN, EXIT_KILLED].contains(&code)
}

/// Stages that ran, with the seconds that they took.
struct Table {
    common: Vec<String>,
    rows: Vec<(&'static str, f64, u8)>,
    worst: u8,
}

impl Table {
    /// Runs a stage; its exit code.
    fn run(&mut self, stage: &StageSpec, words: &[&str]) -> u8 {
        let start = Instant::now();
        let code = match stage_program(stage.name) {
            Ok(mut command) => run_program(command.args(&self.common).args(words)),
            Err(code) => code,
        };
        let secs = start.elapsed().as_secs_f64();
        match self.rows.iter_mut().find(|(name, ..)| *name == stage.name) {
            Some((_, all_s, worst)) => (*all_s, *worst) = (*all_s + secs, (*worst).max(code)),
            None => self.rows.push((stage.name, secs, code)),
        }
        self.worst = self.worst.max(code);
        code
    }

    fn tell(&self) {
        say(&format!("{:<20} {:>9}", "stage", "seconds"));
        for (name, secs, code) in &self.rows {
            let outcome = match *code {
                EXIT_DONE => "",
                EXIT_SOME_FAILED => "  some scenes failed",
                EXIT_USAGE => "  bad arguments or configuration",
                EXIT_TRY_AGAIN => "  stopped, run again",
                EXIT_KILLED => "  killed by the system (out of memory?)",
                _ => "  crashed",
            };
            say(&format!("{name:<20} {secs:>9.1}{outcome}"));
        }
        // Of nothing the sum would be -0.0.
        let total = self.rows.iter().fold(0.0, |total, (_, secs, _)| total + secs);
        say(&format!("{:<20} {total:>9.1}", "total"));
    }
}

/// The exit code of a program that ended. What the system kills (where memory runs out) is told from what was
/// asked to stop: another try may end alike.
fn exit_code(status: ExitStatus) -> u8 {
    use rustix::process::Signal;
    let is_one_of = |signals: &[Signal]| {
        status.signal().is_some_and(|raw| signals.iter().any(|signal| signal.as_raw() == raw))
    };
    match status.code() {
        Some(code) => u8::try_from(code).unwrap_or(EXIT_SOME_FAILED),
        // What aborts has no memory left: a panic is caught.
        None if is_one_of(&[Signal::KILL, Signal::ABORT]) => EXIT_KILLED,
        None if is_one_of(&[Signal::TERM, Signal::INT, Signal::HUP]) => EXIT_TRY_AGAIN,
        None => EXIT_SOME_FAILED,
    }
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
pub(crate) fn stage_program(name: &str) -> Result<Command, u8> {
    runner::program_beside(name).map_err(|e| {
        tracing::error!("cannot find the stage programs: {e}");
        EXIT_SOME_FAILED
    })
}

/// Runs a stage program to its end and returns its exit code, or that of what goes wrong, which is said. A
/// signal that ends this program ends the stage first.
pub(crate) fn run_program(command: &mut Command) -> u8 {
    try_run_program(command).unwrap_or_else(|e| {
        let program = command.get_program().display();
        tracing::error!("{program}: cannot start: {e} (build the workspace first)");
        EXIT_USAGE
    })
}

fn try_run_program(command: &mut Command) -> std::io::Result<u8> {
    let mut child = runner::stops_with_this_one(command).spawn()?;
    let mut told = false;
    loop {
        if let Some(status) = child.try_wait()? {
            // A stage may end in time by itself; the next one is not started.
            return Ok(if runner::was_stopped() { EXIT_TRY_AGAIN } else { exit_code(status) });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_that_is_left_follows_the_pace_of_what_is_done() {
        let left = |done_s, all_s| time_left(Duration::from_secs(300), done_s, all_s);
        assert_eq!(left(100.0, 400.0), Some(("15".to_owned(), "minutes")));
        assert_eq!([left(0.0, 400.0), left(400.0, 400.0)], [None, None]);
    }
}
