//! What can be said of a stage: done, or why not.

use std::fmt;

use store::StoreError;

use crate::seen::ViewError;

/// State of a stage for a scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Its manifest stands, everything it was made from is unchanged, its outputs are there.
    Done,
    /// It was never done, or a run was killed half-way.
    Missing,
    /// It was done from something else.
    Stale(Staleness),
    /// The last try failed.
    Failed(String),
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Done => f.write_str("done"),
            Self::Missing => f.write_str("missing"),
            Self::Stale(why) => write!(f, "stale: {why}"),
            Self::Failed(why) => write!(f, "failed: {why}"),
        }
    }
}

/// Why what was made no longer holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Staleness {
    /// Its manifest is damaged: where and how.
    Damaged(String),
    /// The stage sees other settings now.
    Configuration,
    /// The version of the stage's code is another.
    Code,
    /// The version is the same, but the stage's program is another, and one of the two has uncommitted
    /// changes.
    Program,
    /// What it was made from cannot be read yet, or no longer.
    NotReady(NotReady),
    /// An input (a stage, or a stage of a scene) was redone.
    Redone(String),
    /// Something outside the store changed.
    Source(String),
    /// An output is missing or has another size.
    Output,
}

impl fmt::Display for Staleness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged(what) => f.write_str(what),
            Self::Configuration => f.write_str("the configuration changed"),
            Self::Code => f.write_str("the code changed"),
            Self::Program => f.write_str("the program changed (a build with uncommitted changes)"),
            Self::NotReady(why) => write!(f, "{why}"),
            Self::Redone(input) => write!(f, "{input} was redone"),
            Self::Source(name) => write!(f, "{name} changed"),
            Self::Output => f.write_str("an output is missing or truncated"),
        }
    }
}

/// Why a stage cannot run for a scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotReady {
    /// A stage that it reads is not done.
    Stage {
        /// The stage.
        name: &'static str,
        /// Its state.
        state: Box<State>,
    },
    /// The plan has no such scene.
    Unplanned {
        /// The scene.
        scene: u32,
    },
}

impl fmt::Display for NotReady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The first stage that is not done is the one to run, however long the way to it.
            Self::Stage { name, state } => match &**state {
                State::Stale(Staleness::NotReady(why @ Self::Stage { .. })) => write!(f, "{why}"),
                State::Missing => write!(f, "{name} is missing"),
                State::Failed(why) => write!(f, "{name} failed ({why})"),
                state => write!(f, "{name} is {state}"),
            },
            Self::Unplanned { scene } => write!(f, "scene {scene} is not in the plan"),
        }
    }
}

/// Which code a manifest must be of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CodeRule {
    /// This program's, or one that this program's was accepted for.
    Same,
    /// Any.
    Any,
}

/// Begins the names of inputs that are not in the store (map files).
pub(crate) const SOURCE: &str = "source/";

/// Stands for the digest of what is not done.
pub(crate) const NOT_DONE: &str = "not done";

/// Name of a scene's digest in the plan's manifest.
pub(crate) fn plan_section(scene: u32) -> String {
    format!("scene/{scene:04}")
}

/// The state of a stage cannot be told.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The configuration cannot be handed to the stage.
    #[error(transparent)]
    View(#[from] ViewError),
}
