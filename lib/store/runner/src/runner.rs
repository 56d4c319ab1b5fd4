//! What every stage binary does around its work.

use std::collections::BTreeMap;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use serde::Serialize;
use settings::{DatasetSettings, Fault};
use store::{Attempt, Failure, Identity, MadeBy, Manifest, Scope, Store, keys};

use crate::editions::{self, Editions};
use crate::error::StageError;
use crate::foresight::{Blame, Foresight, Intent};
use crate::graph::{Graph, StageSpec, UnitKind};
use crate::imported::{self, is_imported};
use crate::options::{DeviceOptions, ProgressMode, StageOptions};
use crate::prepared::Prepared;
use crate::programs::{Programs, STAMP_LEN};
use crate::progress::Progress;
use crate::question::confirmed;
use crate::seen::{StageSettings, ViewError};
use crate::stage::{Job, Outlook, Stage};
use crate::status::{CodeRule, SOURCE, Staleness, State, Status, manifest_or_stale, planned_scenes};
use crate::suspicions::{Suspicious, settings_or_faults};
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
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("info"));
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
    let Some(settings) = settings_or_faults(config, rule) else {
        return Ok(EXIT_USAGE);
    };
    if let Some(threads) = threads {
        // Fails only when the pool exists already, which does no harm.
        let _ = rayon::ThreadPoolBuilder::new().num_threads((*threads).max(1)).build_global();
    }
    let store = Store::open(store)?;
    // A place without a plan is left as it is by whoever needs one.
    if !*dry_run && spec.unit == UnitKind::Scene && planned_scenes(&store)?.is_none() {
        return Err(no_plan(&store));
    }
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
        accept_code: *accept_code,
        progress: *progress,
        prepared: Prepared::default(),
    };
    if *dry_run && !run.is_planned()? {
        say(&format!("would run {} once the plan is made", S::STAGE));
        return Ok(EXIT_DONE);
    }
    let scopes = run.scopes(options)?;
    run.refuse_imported(&scopes)?;
    // Shares of one store are one wish: what all of them would make again counts.
    let foresight = run.foresee(&scopes, options.shard.is_some())?;
    if !rule.pass(&run.suspicions(config, *dry_run || *strict)?) {
        return Ok(EXIT_USAGE);
    }
    if *dry_run {
        return run.tell(&scopes, &foresight);
    }
    run.agree(&foresight)?;
    if let Some(open) = run.stage.open {
        run.device_in_use = open(&run.outlook())?;
    }
    run.all(&scopes)
}

fn no_plan(store: &Store) -> StageError {
    let (place, planner) = (store.location(""), Graph::get().planner().name);
    StageError::usage(format!("{place} holds no plan: run {planner} first"))
}

/// `dataset.json`.
#[derive(Serialize)]
struct DatasetRecord<'a> {
    format_version: u32,
    code_version: &'a str,
    /// The newest edition.
    config: &'a DatasetSettings,
    /// All of them, where there are several.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    editions: &'a [DatasetSettings],
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
    accept_code: bool,
    progress: ProgressMode,
    prepared: Prepared,
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
        Status::new(&self.store, &self.editions, self.programs)
    }

    fn scopes(&self, options: &StageOptions) -> Result<Vec<Scope>, StageError> {
        match self.spec.unit {
            UnitKind::Plan => return Ok(vec![Scope::Plan]),
            UnitKind::Stats => return Ok(vec![Scope::Stats]),
            UnitKind::Scene => {}
        }
        let planner = Graph::get().planner();
        let Some(scenes) = planned_scenes(&self.store)? else { return Err(no_plan(&self.store)) };
        if let Some(manifest) = self.store.manifest(Scope::Plan, planner.name)?
            && !is_imported(&manifest)
            && manifest.config_hash != config_hash(planner, &self.editions, Scope::Plan)?
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
        let wanted = scenes.into_iter().enumerate().filter(|(position, scene)| {
            options.scenes.as_ref().is_none_or(|list| list.contains(*scene))
                && options.shard.is_none_or(|shard| shard.contains(*position))
        });
        Ok(wanted.map(|(_, scene)| Scope::Scene(scene)).collect())
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

    /// What is finished and would be made again: by this stage, or, as all follows from the plan, by all
    /// stages. What `--force` asks for is no slip.
    fn foresee(&self, scopes: &[Scope], is_share: bool) -> Result<Foresight, StageError> {
        let is_plan = self.spec.unit == UnitKind::Plan;
        if !self.force {
            self.check_name()?;
        }
        if self.spec.unit == UnitKind::Stats || (self.force && !is_plan) {
            return Ok(Foresight::default());
        }
        let is_kept = |state: &State| *state == State::Done && !self.force;
        let sections = match self.stage.sections {
            Some(sections) if !is_kept(&self.state(Scope::Plan, &self.sources())?) => {
                // Of a fresh store there is nothing to ask.
                if self.store.backend().list("scenes")?.is_empty() {
                    return Ok(Foresight::default());
                }
                Some(sections(&self.outlook())?)
            }
            _ => None,
        };
        let scene = |scope: &Scope| if let Scope::Scene(scene) = scope { Some(*scene) } else { None };
        let intent = Intent {
            stages: if is_plan { Graph::get().stages.iter().collect() } else { self.spec.with_followers() },
            scenes: (!is_plan && !is_share).then(|| scopes.iter().filter_map(scene).collect()),
            sections,
            code: if self.accept_code { CodeRule::Any } else { CodeRule::Same },
            status: self.status(),
        };
        Ok(Foresight::of(&self.store, &self.editions, &intent)?)
    }

    /// Refuses a configuration of another dataset.
    fn check_name(&self) -> Result<(), StageError> {
        let planner = Graph::get().planner().name;
        let plan = manifest_or_stale(&self.store, Scope::Plan, planner)?.unwrap_or_default();
        let is_import = plan.is_some_and(|plan| is_imported(&plan));
        let recorded = if is_import { Vec::new() } else { editions::recorded(&self.store)? };
        let name = &self.editions.given().name;
        match recorded.last().and_then(|config| config["name"].as_str()) {
            Some(recorded) if recorded != name => Err(StageError::usage(format!(
                "{} holds the dataset `{recorded}`, and this configuration is of `{name}`: give another --store, or --force if \
                 this one is to become that",
                self.store.location("")
            ))),
            _ => Ok(()),
        }
    }

    /// Whether a stage's work is made again by this run, or by those that follow from the plan.
    fn makes(&self, stage: &str) -> bool {
        self.spec.unit == UnitKind::Plan || stage == self.spec.name
    }

    /// Says what is made again, and asks where that is much and the configuration or the code is to blame.
    fn agree(&self, foresight: &Foresight) -> Result<(), StageError> {
        let told = foresight.lines();
        if told.is_empty() {
            return Ok(());
        }
        let verb = |stage: &str| if self.makes(stage) { "makes again" } else { "makes stale" };
        let lines = told.into_iter().map(|(stage, line)| format!("{} {line}", verb(stage)));
        let added = foresight.added().map(|scenes| format!("adds {scenes}"));
        let lines: Vec<String> = lines.chain(added).chain(foresight.changed()).collect();
        let limit_s = self.editions.given().store.ask_beyond_s;
        let least = if self.redo_older { Blame::Configuration } else { Blame::Code };
        let is_much = foresight.blamed_s(least).is_some_and(|asked_s| asked_s >= limit_s);
        if self.redo || !is_much || confirmed(&lines)? {
            lines.iter().for_each(|line| tracing::info!("{line}"));
            // What was agreed is not asked again, by whoever goes on with it.
            if foresight.blames(Blame::Configuration) && self.spec.unit == UnitKind::Scene {
                self.renew_record()?;
            }
            return Ok(());
        }
        let mut ways = vec!["--redo makes it again"];
        if foresight.blames(Blame::Code) {
            ways.push("--accept-code keeps what older code made");
        }
        if foresight.blames(Blame::Configuration) {
            ways.push("--grow leaves it, and makes further scenes alone by this configuration");
        }
        Err(StageError::usage(format!(
            "nothing was touched, as this\n  {}\n{}; another --store keeps what is there, too (asked beyond \
             store.ask_beyond_s = {limit_s} s)",
            lines.join("\n  "),
            ways.join("; ")
        )))
    }

    /// What is suspicious in what the stage would make; in what is made already only if that is asked for.
    fn suspicions(&self, config: &Path, also_made: bool) -> Result<Vec<Fault>, StageError> {
        let Some(look) = self.stage.suspicions else { return Ok(Vec::new()) };
        if !also_made && !self.force && self.state(Scope::Plan, &self.sources())? == State::Done {
            return Ok(Vec::new());
        }
        let found = look(&self.outlook())?;
        Ok(settings::suspicions_in(config, &found))
    }

    /// Says what would be done.
    fn tell(&self, scopes: &[Scope], foresight: &Foresight) -> Result<u8, StageError> {
        for (stage, line) in foresight.lines() {
            let verb = if self.makes(stage) { "make again" } else { "make stale" };
            say(&format!("would {verb} {line}"));
        }
        if let Some(added) = foresight.added() {
            say(&format!("would add {added}"));
        }
        foresight.changed().for_each(|line| say(&line));
        let sources = self.sources();
        for &scope in scopes {
            let state = self.state(scope, &sources)?;
            let verb = if state == State::Done && !self.force { "would keep" } else { "would run" };
            say(&format!("{verb} {} ({state})", self.label(scope)));
        }
        if let Some(forecast) = self.stage.forecast {
            for line in forecast(&self.outlook())? {
                say(&line);
            }
        }
        Ok(EXIT_DONE)
    }

    fn all(&self, scopes: &[Scope]) -> Result<u8, StageError> {
        let start = Instant::now();
        let (mut done, mut kept, mut failed) = (0, 0, 0);
        for &scope in scopes {
            match self.one(scope) {
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

    /// Refuses what would have to be made from a log that was never there.
    fn refuse_imported(&self, scopes: &[Scope]) -> Result<(), StageError> {
        let is_kept = |scope| -> Result<bool, StageError> {
            Ok(!self.force && self.state(scope, &BTreeMap::new())? == State::Done)
        };
        match imported::refusal(&self.store, self.spec, scopes, is_kept)? {
            Some(why) => Err(StageError::usage(why)),
            None => Ok(()),
        }
    }

    /// What the stage reads outside the store, by the names of its manifest.
    fn sources(&self) -> BTreeMap<String, String> {
        let found = (self.stage.sources)(&self.of_dataset, self.maps.as_deref());
        found.into_iter().map(|(name, digest)| (format!("{SOURCE}{name}"), digest)).collect()
    }

    /// State of a scope, sources included: one that cannot be found now has not changed.
    fn state(&self, scope: Scope, sources: &BTreeMap<String, String>) -> Result<State, StageError> {
        let code = if self.accept_code { CodeRule::Any } else { CodeRule::Same };
        let state = self.status().by_code(code).state(self.spec, scope)?;
        if state == State::Done
            && let Some(manifest) = self.store.manifest(scope, S::STAGE)?
            && !is_imported(&manifest)
            && let Some((name, _)) =
                sources.iter().find(|(name, now)| manifest.inputs.get(*name) != Some(*now))
        {
            return Ok(State::Stale(Staleness::Source(name.clone())));
        }
        Ok(state)
    }

    /// Keeps what older code made, if it did: the manifest says so from here on.
    fn accept(&self, scope: Scope) -> Result<(), StageError> {
        let Some(read) = self.store.manifest(scope, S::STAGE)?.filter(|manifest| !is_imported(manifest))
        else {
            return Ok(());
        };
        let mut manifest = read.clone();
        // A manifest may be of another version, and of another program as well.
        while let Err(why) = self.status().is_of_code(S::STAGE, &manifest) {
            manifest.accepted_by.push(match why {
                Staleness::Program => self.programs.made_by(S::STAGE).program,
                _ => crate::code_version(S::STAGE).to_owned(),
            });
        }
        if manifest != read {
            tracing::info!("{}: keeps what code {} made", self.label(scope), read.code_version);
            self.store.replace_manifest(scope, &read, &manifest)?;
        }
        Ok(())
    }

    /// `dataset.json`: the whole configuration. It goes with the plan, but the plan sees only a part of it.
    fn record(&self) -> Result<Vec<u8>, StageError> {
        let record = DatasetRecord {
            format_version: schema::FORMAT_VERSION,
            code_version: crate::code_version(Graph::get().planner().name),
            config: self.editions.newest(),
            editions: if self.editions.all().len() > 1 { self.editions.all() } else { &[] },
        };
        let stage = S::STAGE;
        Ok(serde_json::to_vec_pretty(&record).map_err(|source| ViewError::Json { stage, source })?)
    }

    /// Brings `dataset.json` up to date where something changed that the plan does not see.
    fn renew_record(&self) -> Result<(), StageError> {
        let record = self.record()?;
        let planner = Graph::get().planner().name;
        let written = self.store.manifest(Scope::Plan, planner)?;
        let hash = store::hash_bytes(&record);
        let is_old =
            |m: Manifest| !is_imported(&m) && m.output(keys::DATASET).is_none_or(|o| o.blake3 != hash);
        if written.is_some_and(is_old) {
            Attempt::amend(&self.store, Scope::Plan, planner, keys::DATASET, &record)?;
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
    fn one(&self, scope: Scope) -> Result<bool, StageError> {
        let sources = self.sources();
        if !self.force && self.state(scope, &sources)? == State::Done {
            Attempt::tidy(&self.store, scope, S::STAGE)?;
            if self.accept_code {
                self.accept(scope)?;
            }
            if self.spec.unit == UnitKind::Plan {
                self.renew_record()?;
            }
            return Ok(false);
        }
        let ready = self.status().inputs(self.spec, scope)?.map_err(StageError::NotReady)?;
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
        let settings = S::of_scope(&self.editions, scope);
        let mut job = Job {
            store: &self.store,
            settings: &settings,
            status: self.status(),
            made_by,
            maps: self.maps.as_deref(),
            prepared: &self.prepared,
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
