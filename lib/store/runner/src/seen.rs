//! What a stage sees: its part of the configuration, and of the shards of others.

use std::collections::BTreeMap;

use schema::AgentId;
use serde::Serialize;
use settings::DatasetSettings;
use store::Scope;

use crate::editions::Editions;

/// Whether a shard is read, by its path in the scene's folder.
pub type IsRead<'a> = Box<dyn Fn(&str) -> bool + 'a>;

/// Digests of what the shards of a scene depend on, by key.
pub type MadeFrom = BTreeMap<String, String>;

/// The part of a configuration that a stage sees.
pub trait StageSettings: Serialize + Sized + Send + Sync + 'static {
    /// The stage, by its name in `pipeline.toml`.
    const STAGE: &'static str;

    /// Takes the part out of the whole.
    fn of(all: &DatasetSettings) -> Self;

    /// Which shards of a scene it reads of another stage, if not all: it sees no others, and the others may
    /// be made again without it.
    fn reads(&self, _stage: &str) -> Option<IsRead<'_>> {
        None
    }

    /// What each shard of a scene with some agents depends on of these settings, where the stage can make
    /// some without the others: those that depend on what they did are kept when it is done again.
    ///
    /// # Errors
    /// The settings cannot be written down.
    fn made_from(&self, _scene: u32, _agents: &[AgentId]) -> Result<MadeFrom, ViewError> {
        Ok(MadeFrom::new())
    }

    /// The part of a stage that works on the whole dataset.
    fn of_dataset(editions: &Editions) -> Self {
        Self::of(editions.newest())
    }
}

/// The part for a scope: a scene has the settings of its group in its edition, and nothing else.
pub(crate) fn of_scope<S: StageSettings>(editions: &Editions, scope: Scope) -> S {
    match scope {
        Scope::Scene(_) => S::of(editions.of(scope)),
        Scope::Plan | Scope::Tile { .. } | Scope::Stats => S::of_dataset(editions),
    }
}

/// What a stage sees of the configuration cannot be told.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// Nothing is said of it.
    #[error("stage {stage} has no view of the configuration (lib/store/runner/src/views.rs)")]
    Unknown {
        /// The stage.
        stage: &'static str,
    },
    /// It cannot be written down.
    #[error("the configuration's view of {stage} cannot be written down")]
    Json {
        /// The stage.
        stage: &'static str,
        /// Why.
        #[source]
        source: serde_json::Error,
    },
}
