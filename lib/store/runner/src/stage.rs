//! What a stage is, and what it is given to work with.

use std::collections::BTreeMap;
use std::path::Path;

use settings::Suspicion;
use store::{Attempt, MadeBy, Manifest, Scope, Store, Unit};

use crate::editions::Editions;
use crate::error::{Place, StageError};
use crate::interrupt;
use crate::options::DeviceOptions;
use crate::prepared::Prepared;
use crate::progress::Progress;
use crate::seen::StageSettings;
use crate::state::plan_section;
use crate::status::Status;

/// A stage: its work for one scope. Its name in `pipeline.toml` is that of the settings that it sees.
#[derive(Clone, Copy)]
pub struct Stage<S> {
    /// Does the work of one scope: opens units of [`Job`], writes their shards.
    pub run: fn(&mut Job<'_, S>) -> Result<(), StageError>,
    /// Digests of what it reads outside the store, by name, as far as that can be found now: where one
    /// changed, the stage is stale. Takes the settings and the folder with map files.
    pub sources: fn(&S, Option<&Path>) -> BTreeMap<String, String>,
    /// Digests of the scenes of the plan that the stage would make, if it makes the plan.
    pub sections: Option<Sections<S>>,
    /// Lines that say what to expect, for `--dry-run`.
    pub forecast: Option<Forecast<S>>,
    /// What is suspicious in what the stage would make.
    pub suspicions: Option<Suspicions<S>>,
    /// Opens what it works with (into [`Outlook::prepared`]) before anything is made: what is not there is
    /// said at once, not scene by scene.
    pub open: Option<Open<S>>,
}

impl<S: StageSettings> Stage<S> {
    /// A stage that reads nothing outside the store.
    #[must_use]
    pub const fn new(run: fn(&mut Job<'_, S>) -> Result<(), StageError>) -> Self {
        Self {
            run,
            sources: |_, _| BTreeMap::new(),
            sections: None,
            forecast: None,
            suspicions: None,
            open: None,
        }
    }

    /// Name in `pipeline.toml`.
    pub const NAME: &'static str = S::STAGE;
}

/// What a stage may look at before it runs.
pub struct Outlook<'a, S> {
    /// What it sees of the configuration.
    pub settings: &'a S,
    /// The configurations that the store is made with.
    pub editions: &'a Editions,
    /// The folder with map files, if one was given.
    pub maps: Option<&'a Path>,
    /// What is to look at scenes.
    pub device: &'a DeviceOptions,
    /// The store, for reading.
    pub store: &'a Store,
    /// What the stage has worked out already.
    pub prepared: &'a Prepared,
}

/// Digests of the scenes of a plan, by scene.
pub type Sections<S> = fn(&Outlook<'_, S>) -> Result<BTreeMap<u32, String>, StageError>;

/// What to expect before anything runs, line by line.
pub type Forecast<S> = fn(&Outlook<'_, S>) -> Result<Vec<String>, StageError>;

/// What is suspicious in what a stage would make.
pub type Suspicions<S> = fn(&Outlook<'_, S>) -> Result<Vec<Suspicion>, StageError>;

/// Opens what a stage works with, and says what manifests remark of it.
pub type Open<S> = fn(&Outlook<'_, S>) -> Result<Option<String>, StageError>;

/// One piece of work: a scope of a stage.
pub struct Job<'a, S> {
    pub(crate) store: &'a Store,
    pub(crate) settings: &'a S,
    pub(crate) status: Status<'a>,
    pub(crate) made_by: MadeBy,
    pub(crate) maps: Option<&'a Path>,
    pub(crate) prepared: &'a Prepared,
    pub(crate) scope: Scope,
    pub(crate) inputs: BTreeMap<&'static str, Manifest>,
    pub(crate) scenes: BTreeMap<u32, Vec<Manifest>>,
    pub(crate) attempt: Attempt,
    pub(crate) progress: Progress,
}

impl<'a, S: StageSettings> Job<'a, S> {
    /// The store, for reading.
    #[must_use]
    pub fn store(&self) -> &Store {
        self.store
    }

    /// What the stage sees of the configuration.
    #[must_use]
    pub fn settings(&self) -> &S {
        self.settings
    }

    /// The folder with map files, if one was given.
    #[must_use]
    pub fn maps_folder(&self) -> Option<&Path> {
        self.maps
    }

    /// What the stage has worked out already.
    #[must_use]
    pub fn prepared(&self) -> &'a Prepared {
        self.prepared
    }

    /// The scene (0 for stages that work on the whole dataset).
    #[must_use]
    pub fn scene(&self) -> u32 {
        match self.scope {
            Scope::Scene(scene) => scene,
            Scope::Plan | Scope::Tile { .. } | Scope::Stats => 0,
        }
    }

    /// The manifest of a stage that this one reads.
    ///
    /// # Errors
    /// `pipeline.toml` does not say that this stage reads it.
    pub fn input(&self, stage: &str) -> Result<&Manifest, StageError> {
        self.inputs
            .get(stage)
            .ok_or_else(|| StageError::Undeclared { stage: S::STAGE, input: stage.to_owned() })
    }

    /// The manifests of all stages that this one reads of its scene: what a reader of scenes may open.
    pub fn inputs(&self) -> impl Iterator<Item = Manifest> + '_ {
        self.inputs.values().cloned()
    }

    /// Where the job is at work, for errors.
    #[must_use]
    pub fn place(&self) -> Place {
        match self.scope {
            Scope::Scene(scene) => Place::scene(scene),
            Scope::Plan | Scope::Tile { .. } | Scope::Stats => Place::default(),
        }
    }

    /// Opens a unit of work, or `None` when a killed run finished it already; several may be open at once. A
    /// signal stops here.
    ///
    /// # Errors
    /// A signal came, or the store cannot be read.
    pub fn unit(&self, name: &str) -> Result<Option<Unit<'_>>, StageError> {
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
        Ok(self.status.planned_scenes()?.unwrap_or_default())
    }

    /// Of a stage that works on the whole dataset, the manifests of the stages of scenes that are done, by
    /// scene, with those of their outputs that it reads ([`StageSettings::reads`]).
    #[must_use]
    pub fn done_stages(&self) -> &BTreeMap<u32, Vec<Manifest>> {
        &self.scenes
    }

    /// The build at work, for records of what is made beside the stage's own shards.
    #[must_use]
    pub fn made_by(&self) -> &MadeBy {
        &self.made_by
    }

    /// The job's progress, for loops: it also tells them when to stop.
    #[must_use]
    pub fn progress(&self) -> Progress {
        self.progress.clone()
    }
}
