//! Exports a finished store in the layouts that other people's loaders read.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::process::ExitCode;

use arguments::export::CommonArgs;
use export_core::command::Export;
use export_core::{
    Destination, ExportError, Layout, Omission, Outcome, Plan, ProgressWatch, Selection, Source, export, plan,
};
use indicatif::{DecimalBytes, HumanDuration};
use runner::{EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, Programs, Progress, say};
use store::Store;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    let command = arguments::parse::<Export>(&words, build_stamp::STAMP).layout;
    runner::init_logging();
    runner::listen_for_signals();
    let done = command.split().and_then(|(layout, common)| run(layout.as_ref(), &common));
    ExitCode::from(match done {
        Ok(()) => EXIT_DONE,
        Err(error) => {
            tracing::error!("{}", runner::report(&error));
            exit_code(&error)
        }
    })
}

fn exit_code(error: &ExportError) -> u8 {
    match error {
        ExportError::Refused(_) => EXIT_USAGE,
        ExportError::Write { .. } | ExportError::Stopped => EXIT_TRY_AGAIN,
        ExportError::Store(error) if error.is_transient() => EXIT_TRY_AGAIN,
        ExportError::Store(error) if error.is_usage() => EXIT_USAGE,
        _ => EXIT_SOME_FAILED,
    }
}

fn run(layout: &dyn Layout, common: &CommonArgs) -> Result<(), ExportError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(common.threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| ExportError::Refused(format!("--threads: {e}")))?;
    let store = Store::open(&common.store)?;
    let source = Source::open(&store, &selection(common, layout.every_n_frames()), &layout.needs())?;
    let place = Destination::new(&common.dest, layout.name());
    let plan = plan(layout, &source, &place, &code(), common.force)?;
    announce(&plan, &source, pool.current_num_threads());
    if let Some(caution) = layout.caution(&common.dest) {
        tracing::warn!("{caution}");
    }
    if common.dry_run {
        return Ok(());
    }
    let progress =
        Progress::start(common.progress.into(), format!("export {}", layout.name()), plan.cost.agent_frames);
    let watching = Watching(progress);
    let outcome = pool.install(|| export(layout, &source, &place, &plan, &watching));
    watching.0.finish();
    let Outcome { made, units, agent_frames } = outcome?;
    let root = place.root().display();
    say(&format!("{root}: {made} of {units} parts made now, {agent_frames} agent-frames"));
    Ok(())
}

/// What made the files, as far as it decides their bytes: the version alone of a commit's build, the program,
/// too, of one with uncommitted changes.
fn code() -> String {
    let version = runner::code_version("export");
    let made_by = Programs::of_build(build_stamp::STAMP, Some("export")).made_by("export");
    match made_by.commit {
        Some(_) => version.to_owned(),
        None => format!("{version}, program {}", made_by.program),
    }
}

/// What of the store is wanted, where a layout takes every so many frames.
fn selection(common: &CommonArgs, every_n_frames: u32) -> Selection {
    Selection {
        scenes: common.scenes.as_ref().map(|scenes| scenes.ranges().to_vec()),
        splits: common.split.clone(),
        editions: common.edition.clone(),
        groups: common.group.clone(),
        agents: common.agents.clone(),
        sensors: common.sensors.clone(),
        every_n_frames: common.every.unwrap_or(every_n_frames),
    }
}

/// Says what will be made, and what not.
fn announce(plan: &Plan, source: &Source, threads: usize) {
    let cost = plan.cost;
    let wall_s = cost.cpu_s / threads.max(1) as f64;
    say(&format!(
        "{} scenes: {} parts to make, {} there already; {} agent-frames, about {} and {} on {threads} threads",
        source.scenes.len(),
        plan.missing(),
        plan.done,
        cost.agent_frames,
        DecimalBytes(cost.bytes),
        HumanDuration(std::time::Duration::from_secs_f64(wall_s.clamp(0.0, 1e9))),
    ));
    for (scene, why) in &source.unfinished {
        tracing::warn!("scene {scene} is left out: {why}");
    }
    let mut by_reason: BTreeMap<(bool, &str), Vec<&str>> = BTreeMap::new();
    for Omission { what, why, is_note } in &plan.omissions {
        by_reason.entry((*is_note, why)).or_default().push(what);
    }
    for ((is_note, why), what) in by_reason {
        let word = if is_note { "note" } else { "left out" };
        say(&format!("{word}: {} ({why})", what.join(", ")));
    }
}

/// The progress of a stage, for the export.
struct Watching(Progress);

impl ProgressWatch for Watching {
    fn advance(&self, agent_frames: u64) -> bool {
        self.0.advance(agent_frames).is_err()
    }
}
