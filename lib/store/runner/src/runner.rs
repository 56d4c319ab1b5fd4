//! What every stage binary does around its work.

mod foreseen;
mod paced;
mod records;

use std::collections::BTreeMap;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use store::{Attempt, Failure, Identity, MadeBy, Scope, Store, keys};

use crate::editions::{self, Editions};
use crate::error::StageError;
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::is_imported;
use crate::options::{DeviceOptions, ProgressMode, Shard, StageOptions};
use crate::pace::Pace;
use crate::prepared::Prepared;
use crate::programs::{Programs, STAMP_LEN};
use crate::progress::Progress;
use crate::seen::{StageSettings, of_scope};
use crate::shards::Part;
use crate::stage::{Job, Outlook, Stage};
use crate::state::{CodeRule, SOURCE, Staleness, State};
use crate::status::{Known, Status};
use crate::survey::Survey;
use crate::suspicions::{Suspicious, settings_or_faults};
use crate::task::{no_plan, share, versions_agree};
use crate::views::config_hash;
use crate::{EXIT_DONE, EXIT_SOME_FAILED, EXIT_USAGE, interrupt, lock};

/// Prints a line of the program's answer to standard output. Where the reader has closed it (`convoy status |
/// head`) the line is lost and the work goes on.
pub fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Runs a stage and returns its exit code. `stamp` is the build's (`build_stamp::STAMP`).
#[must_use]
pub fn run_stage<S: StageSettings>(
    stage: Stage<S>,
    options: &StageOptions,
    stamp: &[u8; STAMP_LEN],
) -> ExitCode {
    init_logging();
    interrupt::listen();
    let programs = Programs::of_build(stamp, Some(S::STAGE));
    ExitCode::from(run_with(stage, options, &programs))
}

/// Starts logging to standard error; `CONVOY_LOG` takes a filter such as `debug`.
pub fn init_logging() {
    let filter = tracing_subscriber::EnvFilter::try_from_env("CONVOY_LOG")
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("info,object_store=warn"));
    let format = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    // A closed standard error is no reason to stop.
    let format = format.log_internal_errors(false);
    // A second start (in tests) keeps the first.
    let _ = format.without_time().with_target(false).try_init();
}

fn run_with<S: StageSettings>(stage: Stage<S>, options: &StageOptions, programs: &Programs) -> u8 {
    match try_run(stage, options, programs) {
        Ok(code) => code,
        Err(error) => {
            tracing::error!("{}: {}", S::STAGE, error.report());
            error.exit_code()
        }
    }
}

fn try_run<S: StageSettings>(
    stage: Stage<S>,
    options: &StageOptions,
    programs: &Programs,
) -> Result<u8, StageError> {
    let StageOptions {
        config,
        store,
        maps,
        scenes: _,
        shard: _,
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
    } = options;
    let spec = Graph::get()
        .stage(S::STAGE)
        .ok_or_else(|| StageError::usage(format!("pipeline.toml knows no stage {}", S::STAGE)))?;
    // One stage is enough to say what a configuration asks for in vain.
    let rule = Suspicious::of(*strict, spec.unit == UnitKind::Plan);
    let given = match config {
        Some(config) => match settings_or_faults(config, rule) {
            Some(settings) => Some(settings),
            None => return Ok(EXIT_USAGE),
        },
        None if spec.unit == UnitKind::Plan => {
            return Err(StageError::usage(format!("{} needs --config FILE", S::STAGE)));
        }
        None => None,
    };
    if let Some(threads) = threads {
        // Fails only when the pool exists already, which does no harm.
        let _ = rayon::ThreadPoolBuilder::new().num_threads((*threads).max(1)).build_global();
    }
    let store = Store::open(store)?;
    // A place without a plan is left as it is by whoever needs one.
    let is_planned = || store.backend().size(&Scope::Plan.manifest(Graph::get().planner().name));
    if !*dry_run && spec.unit == UnitKind::Scene && is_planned()?.is_none() {
        return Err(no_plan(&store));
    }
    let settings = match given {
        Some(settings) => settings,
        None => editions::newest_recorded(&store)?,
    };
    let _lock = if *dry_run { None } else { lock::hold(&store, &settings, S::STAGE)? };
    let editions = Editions::of_store(&store, &settings, *edition)?;
    let mut run = Run {
        stage,
        spec,
        of_dataset: S::of_dataset(&editions),
        editions,
        programs,
        store,
        maps: maps.clone(),
        device: device.clone(),
        device_in_use: None,
        force: *force,
        redo: *redo,
        redo_older: *redo_older,
        in_run: in_run.clone(),
        accept_code: *accept_code,
        progress: *progress,
        shard: options.shard,
        known: Arc::default(),
        prepared: Prepared::default(),
    };
    if *dry_run && !run.is_planned()? {
        say(&format!("would run {} once the plan is made", S::STAGE));
        return Ok(EXIT_DONE);
    }
    let scopes = run.scopes(options)?;
    let (looked, foresight) = run.look(&scopes)?;
    if let Some(config) = config
        && !rule.pass(&run.suspicions(config, *dry_run || *strict)?)
    {
        return Ok(EXIT_USAGE);
    }
    if *dry_run {
        return run.tell(&looked, &foresight);
    }
    run.agree(&foresight)?;
    if let Some(open) = run.stage.open {
        run.device_in_use = open(&run.outlook())?;
    }
    run.all(&looked)
}

struct Run<'a, S> {
    stage: Stage<S>,
    spec: &'static StageSpec,
    /// What the stage sees where it works on the whole dataset.
    of_dataset: S,
    editions: Editions,
    programs: &'a Programs,
    store: Store,
    maps: Option<PathBuf>,
    device: DeviceOptions,
    /// What looks at scenes, for manifests to remark.
    device_in_use: Option<String>,
    force: bool,
    redo: bool,
    redo_older: bool,
    in_run: Vec<String>,
    accept_code: bool,
    progress: ProgressMode,
    /// The share of the scenes that this run makes, if not all.
    shard: Option<Shard>,
    known: Arc<Known>,
    prepared: Prepared,
}

/// A scope as it was found before anything was made.
#[derive(Debug)]
struct Looked {
    scope: Scope,
    state: State,
    /// Whether a killed run left something behind.
    is_untidy: bool,
}

impl<S: StageSettings> Run<'_, S> {
    fn outlook(&self) -> Outlook<'_, S> {
        Outlook {
            settings: &self.of_dataset,
            editions: &self.editions,
            maps: self.maps.as_deref(),
            device: &self.device,
            store: &self.store,
            prepared: &self.prepared,
        }
    }

    fn status(&self) -> Status<'_> {
        Status::new(&self.store, &self.editions, self.programs).knowing(&self.known)
    }

    /// The rule for the code that made what is there.
    fn code(&self) -> CodeRule {
        if self.accept_code { CodeRule::Any } else { CodeRule::Same }
    }

    fn scopes(&self, options: &StageOptions) -> Result<Vec<Scope>, StageError> {
        match self.spec.unit {
            UnitKind::Plan => return Ok(vec![Scope::Plan]),
            UnitKind::Stats => return Ok(vec![Scope::Stats]),
            UnitKind::Scene => {}
        }
        let (planner, status) = (Graph::get().planner(), self.status());
        let Some(scenes) = status.planned_scenes()? else { return Err(no_plan(&self.store)) };
        if let Some(manifest) = status.plan()?.sound()
            && !is_imported(manifest)
            && status.config_hash(planner, Scope::Plan)?.is_some_and(|hash| manifest.config_hash != hash)
        {
            let message = format!("the plan was made from another configuration: run {} first", planner.name);
            return Err(StageError::usage(message));
        }
        if let Some(list) = &options.scenes {
            let unknown = list.outside(&scenes);
            if !unknown.is_empty() {
                let last = scenes.last().copied().unwrap_or(0);
                let message = format!("--scenes: no scene {unknown:?} in the plan (it has 0 to {last})");
                return Err(StageError::usage(message));
            }
        }
        let scenes = match options.shard {
            Some(shard) => self.share(shard)?,
            None => scenes,
        };
        let wanted = |scene: &u32| options.scenes.as_ref().is_none_or(|list| list.contains(*scene));
        Ok(scenes.into_iter().filter(wanted).map(Scope::Scene).collect())
    }

    /// The scenes of a share.
    fn share(&self, shard: Shard) -> Result<Vec<u32>, StageError> {
        let plan = self.status().plan()?;
        let Some(plan) = plan.sound() else { return Err(no_plan(&self.store)) };
        versions_agree(plan, self.spec)?;
        Ok(share(&self.store, plan, &self.editions, shard)?.0)
    }

    /// Whether a plan of this configuration stands, where the stage needs one.
    fn is_planned(&self) -> Result<bool, StageError> {
        let planner = Graph::get().planner();
        Ok(self.spec.unit != UnitKind::Scene || self.status().state(planner, Scope::Plan)? == State::Done)
    }

    fn label(&self, scope: Scope) -> String {
        match scope {
            Scope::Scene(scene) => format!("{} scene {scene:04}", S::STAGE),
            Scope::Plan | Scope::Tile { .. } | Scope::Stats => S::STAGE.to_owned(),
        }
    }

    fn all(&self, looked: &[Looked]) -> Result<u8, StageError> {
        let start = Instant::now();
        let (mut done, mut kept, mut failed) = (0, 0, 0);
        let mut pace = self.pace(looked)?;
        for of_scope in looked {
            let scope = of_scope.scope;
            let made = if !self.is_made(of_scope) {
                self.keep(scope, of_scope.is_untidy).map(|()| false)
            } else {
                let made = self.one(scope, pace.clone());
                pace.step();
                made
            };
            match made {
                Ok(true) => done += 1,
                Ok(false) => kept += 1,
                Err(error) if error.exit_code() != EXIT_SOME_FAILED => return Err(error),
                Err(error) => {
                    let reason = error.report();
                    tracing::error!("{}: {reason}", self.label(scope));
                    if error.is_failure() {
                        let failure = Failure { code_version: crate::code_version(S::STAGE).into(), reason };
                        self.store.write_json(&scope.failure(S::STAGE), S::STAGE, &failure)?;
                    }
                    failed += 1;
                }
            }
        }
        let secs = start.elapsed().as_secs_f64();
        let name = S::STAGE;
        tracing::info!("{name}: {done} done, {kept} kept, {failed} failed in {secs:.1} s");
        Ok(if failed == 0 { EXIT_DONE } else { EXIT_SOME_FAILED })
    }

    /// Whether a scope is about to be made, or made again.
    fn is_made(&self, of_scope: &Looked) -> bool {
        of_scope.state != State::Done || self.force
    }

    /// What the stage reads outside the store, by the names of its manifest.
    fn sources(&self) -> BTreeMap<String, String> {
        let found = (self.stage.sources)(&self.of_dataset, self.maps.as_deref());
        found.into_iter().map(|(name, digest)| (format!("{SOURCE}{name}"), digest)).collect()
    }

    /// State of a scope, sources included: one that cannot be found now has not changed.
    fn state_of(&self, survey: &Survey<'_>, sources: &BTreeMap<String, String>) -> Result<State, StageError> {
        let state = survey.state(self.spec)?;
        if state == State::Done
            && !sources.is_empty()
            && let Some(manifest) = survey.record(S::STAGE)?.sound().filter(|manifest| !is_imported(manifest))
            && let Some((name, _)) =
                sources.iter().find(|(name, now)| manifest.inputs.get(*name) != Some(*now))
        {
            return Ok(State::Stale(Staleness::Source(name.clone())));
        }
        Ok(state)
    }

    /// State of a scope as it is now.
    fn state(&self, scope: Scope, sources: &BTreeMap<String, String>) -> Result<State, StageError> {
        let status = self.status().by_code(self.code());
        self.state_of(&status.survey(scope), sources)
    }

    /// Keeps what is done.
    fn keep(&self, scope: Scope, is_untidy: bool) -> Result<(), StageError> {
        if is_untidy {
            Attempt::tidy(&self.store, scope, S::STAGE)?;
        }
        if self.accept_code {
            self.accept(scope)?;
        }
        if self.spec.unit == UnitKind::Plan {
            self.renew_record()?;
            self.renew_versions()?;
        }
        Ok(())
    }

    /// A stage writes only where `pipeline.toml` says.
    fn check_places(&self, scope: Scope, attempt: &Attempt) -> Result<(), StageError> {
        let folder = match scope {
            Scope::Scene(_) => format!("{}/", scope.folder()),
            Scope::Plan | Scope::Tile { .. } | Scope::Stats => String::new(),
        };
        let is_stray =
            |key: &String| !key.strip_prefix(&folder).is_some_and(|path| self.spec.may_write(path));
        match attempt.keys().into_iter().find(is_stray) {
            None => Ok(()),
            Some(key) => Err(StageError::Unlisted { stage: S::STAGE, key }),
        }
    }

    /// Runs one scope. `false`: there was nothing to do.
    fn one(&self, scope: Scope, pace: Pace) -> Result<bool, StageError> {
        let (sources, status) = (self.sources(), self.status().by_code(self.code()));
        let survey = status.survey(scope);
        // Somebody else may have made it since.
        if !self.force && self.state_of(&survey, &sources)? == State::Done {
            self.keep(scope, survey.is_untidy(S::STAGE)?)?;
            return Ok(false);
        }
        let survey = self.status();
        let ready = survey.survey(scope).inputs(self.spec)?.map_err(StageError::NotReady)?;
        let made_by = MadeBy { device: self.device_in_use.clone(), ..self.programs.made_by(S::STAGE) };
        let identity = Identity {
            stage: S::STAGE.into(),
            scope,
            code_version: crate::code_version(S::STAGE).into(),
            config_hash: config_hash(self.spec, &self.editions, scope)?,
            inputs: ready.digests.into_iter().chain(sources).collect(),
            made_by: Some(made_by.clone()),
        };
        let attempt = Attempt::start(&self.store, identity, self.force)?;
        let settings: S = of_scope(&self.editions, scope);
        let manifest_of = |(name, part): (_, Part)| Some((name, part.into_manifest()?));
        let mut job = Job {
            store: &self.store,
            settings: &settings,
            status: self.status(),
            made_by,
            maps: self.maps.as_deref(),
            prepared: &self.prepared,
            scope,
            inputs: ready.parts.into_iter().filter_map(manifest_of).collect(),
            scenes: ready.scenes,
            attempt,
            progress: Progress::of_piece(self.progress, self.label(scope), 0, pace),
        };
        // A panic is a bug of ours; it must not take the other scenes with it.
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.stage.run)(&mut job)));
        job.progress.finish();
        match outcome {
            Ok(Ok(())) => {
                if self.spec.unit == UnitKind::Plan
                    && let Some(mut unit) = job.attempt.unit("dataset")?
                {
                    unit.bytes(keys::DATASET, &self.record()?, 1)?;
                    unit.finish()?;
                }
                self.check_places(scope, &job.attempt)?;
                job.attempt.commit()?;
                Ok(true)
            }
            Ok(Err(error)) => Err(error),
            Err(panic) => {
                let text = panic
                    .downcast_ref::<String>()
                    .map(String::as_str)
                    .or_else(|| panic.downcast_ref::<&str>().copied())
                    .unwrap_or("no message");
                Err(StageError::Panic { message: text.to_owned() })
            }
        }
    }
}

#[cfg(test)]
mod tests;
