//! What every stage binary does around its work.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use schema::settings::DatasetSettings;
use store::{Attempt, Failure, Identity, Manifest, Scope, Store, StoreError, Unit};

use crate::args::{ProgressMode, StageArgs};
use crate::graph::{Graph, StageSpec, UnitKind, config_hash};
use crate::progress::Progress;
use crate::status::{SOURCE, State, inputs, plan_section, planned_scenes, state_of};
use crate::{EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE, config, interrupt};

/// A stage: its name in `pipeline.toml` and its work for one scope.
#[derive(Clone, Copy)]
pub struct Stage {
    /// Name in `pipeline.toml`.
    pub name: &'static str,
    /// Does the work of one scope: opens units of [`Job`], writes their shards.
    pub run: fn(&mut Job<'_>) -> Result<(), StageError>,
    /// Digests of what it reads outside the store, by name, as far as that can be found now: where one changed, the
    /// stage is stale. Takes the settings and the folder with map files.
    pub sources: fn(&DatasetSettings, Option<&Path>) -> BTreeMap<String, String>,
    /// Lines that say what to expect, for `--dry-run`. Takes the settings, the folder with map files and the store.
    pub forecast: Option<Forecast>,
}

/// What to expect before anything runs, line by line.
pub type Forecast = fn(&DatasetSettings, Option<&Path>, &Store) -> Result<Vec<String>, StageError>;

/// The sources of a stage that reads nothing outside the store.
#[must_use]
pub fn no_sources(_settings: &DatasetSettings, _maps: Option<&Path>) -> BTreeMap<String, String> {
    BTreeMap::new()
}

/// Why the work of a scope ended early.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A signal came.
    #[error("stopped by a signal")]
    Stopped,
    /// The work cannot be done; the text says where and why.
    #[error("{0}")]
    Failed(String),
    /// The arguments or the configuration do not allow the work.
    #[error("{0}")]
    Usage(String),
}

impl StageError {
    /// A failure with its causes, outermost first.
    #[must_use]
    pub fn failed(error: &dyn std::error::Error) -> Self {
        let mut text = error.to_string();
        let mut cause = error.source();
        while let Some(inner) = cause {
            let inner_text = inner.to_string();
            if !text.ends_with(&inner_text) {
                text = format!("{text}: {inner_text}");
            }
            cause = inner.source();
        }
        Self::Failed(text)
    }
}

/// One piece of work: a scope of a stage.
pub struct Job<'a> {
    store: &'a Store,
    settings: &'a DatasetSettings,
    maps: Option<&'a Path>,
    scope: Scope,
    inputs: BTreeMap<String, Manifest>,
    attempt: Attempt,
    progress: Progress,
}

impl Job<'_> {
    /// The store, for reading.
    #[must_use]
    pub fn store(&self) -> &Store {
        self.store
    }

    /// The configuration.
    #[must_use]
    pub fn settings(&self) -> &DatasetSettings {
        self.settings
    }

    /// The folder with map files, if one was given.
    #[must_use]
    pub fn maps_folder(&self) -> Option<&Path> {
        self.maps
    }

    /// The scene (0 for stages that work on the whole dataset).
    #[must_use]
    pub fn scene(&self) -> u32 {
        match self.scope {
            Scope::Scene(scene) => scene,
            Scope::Plan | Scope::Stats => 0,
        }
    }

    /// The manifest of a stage that this one reads.
    ///
    /// # Errors
    /// `pipeline.toml` does not say that this stage reads it.
    pub fn input(&self, stage: &str) -> Result<&Manifest, StageError> {
        self.inputs
            .get(stage)
            .ok_or_else(|| StageError::Failed(format!("pipeline.toml does not let this stage read {stage}")))
    }

    /// Opens a unit of work, or `None` when a killed run finished it already. A signal stops here.
    ///
    /// # Errors
    /// A signal came, or the store cannot be read.
    pub fn unit(&mut self, name: &str) -> Result<Option<Unit<'_>>, StageError> {
        if interrupt::stopped() {
            return Err(StageError::Stopped);
        }
        Ok(self.attempt.unit(name)?)
    }

    /// Remembers the digest of a scene's plan, so that each scene depends on its own part of the plan alone.
    pub fn plan_scene(&mut self, scene: u32, digest: String) {
        self.attempt.section(&plan_section(scene), digest);
    }

    /// Scenes of the plan.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn planned_scenes(&self) -> Result<Vec<u32>, StageError> {
        Ok(planned_scenes(self.store)?.unwrap_or_default())
    }

    /// The manifest of a stage for a scene, if the stage is done.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn manifest_if_done(&self, stage: &str, scene: u32) -> Result<Option<Manifest>, StageError> {
        let Some(spec) = Graph::get().stage(stage) else { return Ok(None) };
        let scope = Scope::Scene(scene);
        if state_of(self.store, self.settings, spec, scope)? == State::Done {
            return Ok(self.store.manifest(scope, stage)?);
        }
        Ok(None)
    }

    /// A handle for loops: progress and the wish to stop.
    #[must_use]
    pub fn pulse(&self) -> Pulse<'_> {
        Pulse { progress: &self.progress }
    }

    /// Splits the job into what a unit needs at the same time: the attempt's unit and the pulse.
    ///
    /// # Errors
    /// As [`Job::unit`].
    pub fn unit_and_pulse(&mut self, name: &str) -> Result<Option<(Unit<'_>, Pulse<'_>)>, StageError> {
        if interrupt::stopped() {
            return Err(StageError::Stopped);
        }
        let pulse = Pulse { progress: &self.progress };
        Ok(self.attempt.unit(name)?.map(|unit| (unit, pulse)))
    }
}

/// Progress and the wish to stop.
#[derive(Clone, Copy)]
pub struct Pulse<'a> {
    progress: &'a Progress,
}

impl Pulse<'_> {
    /// Sets the amount of work of the job.
    pub fn set_total(&self, total: u64) {
        self.progress.set_total(total);
    }

    /// Counts work done.
    ///
    /// # Errors
    /// A signal came: drop what is in hand and return.
    pub fn beat(&self, amount: u64) -> Result<(), StageError> {
        self.progress.advance(amount);
        if interrupt::stopped() { Err(StageError::Stopped) } else { Ok(()) }
    }
}

/// Runs a stage binary: arguments in, exit code out.
#[must_use]
pub fn run_stage(stage: Stage) -> ExitCode {
    let args = StageArgs::parse();
    init_logging();
    interrupt::listen();
    ExitCode::from(run_with(stage, &args))
}

/// Starts logging to standard error; `CONVOY_LOG` takes a filter such as `debug`.
pub fn init_logging() {
    let filter = tracing_subscriber::EnvFilter::try_from_env("CONVOY_LOG")
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("info"));
    let format = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    // A second start (in tests) keeps the first.
    let _ = format.without_time().with_target(false).try_init();
}

fn run_with(stage: Stage, args: &StageArgs) -> u8 {
    match try_run(stage, args) {
        Ok(code) => code,
        Err(error) => {
            tracing::error!("{}: {error}", stage.name);
            exit_code_of(&error)
        }
    }
}

fn exit_code_of(error: &StageError) -> u8 {
    match error {
        StageError::Stopped => EXIT_TRY_AGAIN,
        StageError::Store(e) if e.is_transient() => EXIT_TRY_AGAIN,
        StageError::Usage(_) => EXIT_USAGE,
        StageError::Store(_) | StageError::Failed(_) => EXIT_SOME_FAILED,
    }
}

/// Reads the configuration, printing every fault and, where they are `wanted`, all warnings.
pub(crate) fn settings_or_faults(path: &Path, wanted: bool) -> Option<DatasetSettings> {
    match config::load(path) {
        Ok((settings, warnings)) => {
            for warning in warnings.iter().filter(|_| wanted) {
                tracing::warn!("{warning}");
            }
            Some(settings)
        }
        Err(faults) => {
            for fault in faults {
                tracing::error!("{fault}");
            }
            None
        }
    }
}

fn try_run(stage: Stage, args: &StageArgs) -> Result<u8, StageError> {
    let StageArgs { config, store, maps, scenes: _, shard: _, force, threads, dry_run, progress } = args;
    let spec = Graph::get()
        .stage(stage.name)
        .ok_or_else(|| StageError::Usage(format!("pipeline.toml knows no stage {}", stage.name)))?;
    // One stage is enough to say what a configuration asks for in vain.
    let Some(settings) = settings_or_faults(config, spec.unit == UnitKind::Plan) else {
        return Ok(EXIT_USAGE);
    };
    if let Some(threads) = threads {
        // Fails only when the pool exists already, which does no harm.
        let _ = rayon::ThreadPoolBuilder::new().num_threads((*threads).max(1)).build_global();
    }
    let run = Run {
        stage,
        spec,
        settings: &settings,
        store: Store::on_disk(store),
        maps: maps.clone(),
        force: *force,
        progress: *progress,
    };
    if *dry_run && !run.is_planned()? {
        crate::drive::say(&format!("would run {} once the plan is made", stage.name));
        return Ok(EXIT_DONE);
    }
    let scopes = run.scopes(args)?;
    if *dry_run {
        return run.tell(&scopes);
    }
    run.all(&scopes)
}

struct Run<'a> {
    stage: Stage,
    spec: &'a StageSpec,
    settings: &'a DatasetSettings,
    store: Store,
    maps: Option<PathBuf>,
    force: bool,
    progress: ProgressMode,
}

impl Run<'_> {
    fn scopes(&self, args: &StageArgs) -> Result<Vec<Scope>, StageError> {
        match self.spec.unit {
            UnitKind::Plan => return Ok(vec![Scope::Plan]),
            UnitKind::Stats => return Ok(vec![Scope::Stats]),
            UnitKind::Scene => {}
        }
        let planner = &Graph::get().stages[0];
        let Some(scenes) = planned_scenes(&self.store)? else {
            let place = self.store.location("");
            return Err(StageError::Usage(format!("{place} holds no plan: run {} first", planner.name)));
        };
        if let Some(manifest) = self.store.manifest(Scope::Plan, &planner.name)?
            && manifest.config_hash != config_hash(planner, self.settings)
        {
            let message = format!("the plan was made from another configuration: run {} first", planner.name);
            return Err(StageError::Usage(message));
        }
        if let Some(list) = &args.scenes {
            let unknown = list.outside(&scenes);
            if !unknown.is_empty() {
                let last = scenes.last().copied().unwrap_or(0);
                let message = format!("--scenes: no scene {unknown:?} in the plan (it has 0 to {last})");
                return Err(StageError::Usage(message));
            }
        }
        let wanted = scenes.into_iter().enumerate().filter(|(position, scene)| {
            args.scenes.as_ref().is_none_or(|list| list.contains(*scene))
                && args.shard.is_none_or(|shard| shard.contains(*position))
        });
        Ok(wanted.map(|(_, scene)| Scope::Scene(scene)).collect())
    }

    /// Whether a plan of this configuration stands, where the stage needs one.
    fn is_planned(&self) -> Result<bool, StageError> {
        let planner = &Graph::get().stages[0];
        let stands = || state_of(&self.store, self.settings, planner, Scope::Plan);
        Ok(self.spec.unit != UnitKind::Scene || stands()? == State::Done)
    }

    fn label(&self, scope: Scope) -> String {
        match scope {
            Scope::Scene(scene) => format!("{} scene {scene:04}", self.stage.name),
            Scope::Plan | Scope::Stats => self.stage.name.to_owned(),
        }
    }

    /// Says what would be done.
    fn tell(&self, scopes: &[Scope]) -> Result<u8, StageError> {
        let sources = self.sources();
        for &scope in scopes {
            let state = self.state(scope, &sources)?;
            let verb = if state == State::Done && !self.force { "would keep" } else { "would run" };
            crate::drive::say(&format!("{verb} {} ({state})", self.label(scope)));
        }
        if let Some(forecast) = self.stage.forecast {
            for line in forecast(self.settings, self.maps.as_deref(), &self.store)? {
                crate::drive::say(&line);
            }
        }
        Ok(EXIT_DONE)
    }

    fn all(&self, scopes: &[Scope]) -> Result<u8, StageError> {
        let start = Instant::now();
        let (mut done, mut kept) = (0, 0);
        let mut failed: Vec<String> = Vec::new();
        for &scope in scopes {
            match self.one(scope) {
                Ok(true) => done += 1,
                Ok(false) => kept += 1,
                Err(error) if exit_code_of(&error) != EXIT_SOME_FAILED => return Err(error),
                Err(error) => {
                    let reason = error.to_string();
                    tracing::error!("{}: {reason}", self.label(scope));
                    let failure =
                        Failure { code_version: crate::code_version(self.stage.name).into(), reason };
                    let key = scope.failure(self.stage.name);
                    if let Err(error) = self.store.write_json(&key, self.stage.name, &failure) {
                        tracing::warn!("the failure could not be recorded: {error}");
                    }
                    failed.push(self.label(scope));
                }
            }
        }
        let secs = start.elapsed().as_secs_f64();
        let name = self.stage.name;
        tracing::info!("{name}: {done} done, {kept} kept, {} failed in {secs:.1} s", failed.len());
        Ok(if failed.is_empty() { EXIT_DONE } else { EXIT_SOME_FAILED })
    }

    /// What the stage reads outside the store, by the names of its manifest.
    fn sources(&self) -> BTreeMap<String, String> {
        let found = (self.stage.sources)(self.settings, self.maps.as_deref());
        found.into_iter().map(|(name, digest)| (format!("{SOURCE}{name}"), digest)).collect()
    }

    /// State of a scope, sources included: one that cannot be found now has not changed.
    fn state(&self, scope: Scope, sources: &BTreeMap<String, String>) -> Result<State, StageError> {
        let state = state_of(&self.store, self.settings, self.spec, scope)?;
        if state == State::Done
            && let Some(manifest) = self.store.manifest(scope, self.stage.name)?
            && let Some((name, _)) =
                sources.iter().find(|(name, now)| manifest.inputs.get(*name) != Some(*now))
        {
            return Ok(State::Stale(format!("{name} changed")));
        }
        Ok(state)
    }

    /// Runs one scope. `false`: there was nothing to do.
    fn one(&self, scope: Scope) -> Result<bool, StageError> {
        let sources = self.sources();
        if !self.force && self.state(scope, &sources)? == State::Done {
            Attempt::tidy(&self.store, scope, self.stage.name)?;
            return Ok(false);
        }
        let ready = inputs(&self.store, self.settings, self.spec, scope)?
            .map_err(|why| StageError::Failed(format!("{why}: run that first")))?;
        let identity = Identity {
            stage: self.stage.name.into(),
            scope,
            code_version: crate::code_version(self.stage.name).into(),
            config_hash: config_hash(self.spec, self.settings),
            inputs: ready.digests.into_iter().chain(sources).collect(),
        };
        let attempt = Attempt::start(&self.store, identity, self.force)?;
        let mut job = Job {
            store: &self.store,
            settings: self.settings,
            maps: self.maps.as_deref(),
            scope,
            inputs: ready.manifests,
            attempt,
            progress: Progress::start(self.progress, self.label(scope), 0),
        };
        // A panic is a bug of ours; it must not take the other scenes with it.
        let outcome = catch_unwind(AssertUnwindSafe(|| (self.stage.run)(&mut job)));
        job.progress.finish();
        match outcome {
            Ok(Ok(())) => {
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
                Err(StageError::Failed(format!("a bug in Convoy: {text} (please report it)")))
            }
        }
    }
}
