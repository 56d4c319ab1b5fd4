//! Why the work of a stage ended early.

use std::error::Error;
use std::fmt;

use schema::AgentId;
use store::StoreError;

use crate::editions::EditionError;
use crate::seen::ViewError;
use crate::state::{NotReady, StateError};
use crate::{EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE};

/// Why the work of a scope ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A signal came.
    #[error("stopped by a signal")]
    Stopped,
    /// What is read is not there yet, or no longer as it was.
    #[error("{0}: run that first")]
    NotReady(NotReady),
    /// The configuration cannot be handed to a stage.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The work cannot be done.
    #[error("{place}{source}")]
    Failed {
        /// Where, as far as it is known.
        place: Box<Place>,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The arguments or the configuration do not allow the work.
    #[error("{0}")]
    Usage(#[source] Box<dyn Error + Send + Sync>),
    /// A stage reads another one without saying so.
    #[error("a bug in Convoy: pipeline.toml does not let {stage} read {input} (please report it)")]
    Undeclared {
        /// The stage.
        stage: &'static str,
        /// What it wanted to read.
        input: String,
    },
    /// A stage writes where it does not say so.
    #[error(
        "a bug in Convoy: {stage} wrote {key}, which pipeline.toml does not list among what it writes (please report it)"
    )]
    Unlisted {
        /// The stage.
        stage: &'static str,
        /// What it wrote.
        key: String,
    },
    /// A panic.
    #[error("a bug in Convoy: {message} (please report it)")]
    Panic {
        /// What the panic said.
        message: String,
    },
}

impl From<StateError> for StageError {
    fn from(error: StateError) -> Self {
        match error {
            StateError::Store(error) => error.into(),
            StateError::View(error) => error.into(),
        }
    }
}

impl From<EditionError> for StageError {
    fn from(error: EditionError) -> Self {
        match error {
            EditionError::Store(error) => error.into(),
            error => Self::usage(error),
        }
    }
}

impl StageError {
    /// Something that the arguments or the configuration do not allow.
    #[must_use]
    pub fn usage(cause: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Usage(cause.into())
    }

    /// The error and its causes on one line; see [`report`].
    #[must_use]
    pub fn report(&self) -> String {
        report(self)
    }

    /// The exit code of a stage that ends with this error. Only [`EXIT_SOME_FAILED`] is the scene's own
    /// fault.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stopped => EXIT_TRY_AGAIN,
            Self::Usage(_) => EXIT_USAGE,
            Self::Store(_)
            | Self::NotReady(_)
            | Self::View(_)
            | Self::Failed { .. }
            | Self::Undeclared { .. }
            | Self::Unlisted { .. }
            | Self::Panic { .. } => match self.store_error() {
                Some(e) if e.is_transient() => EXIT_TRY_AGAIN,
                Some(e) if e.is_usage() => EXIT_USAGE,
                _ => EXIT_SOME_FAILED,
            },
        }
    }

    /// The store's error at the bottom, however many readers (of scenes, maps, logs) have wrapped it.
    fn store_error(&self) -> Option<&StoreError> {
        match self {
            // Transparent: its own source is what lies below the store's error.
            Self::Store(error) => Some(error),
            other => causes(other).find_map(|cause| cause.downcast_ref()),
        }
    }

    /// Whether the stage was tried and failed, as against not begun for want of its inputs.
    pub(crate) fn is_failure(&self) -> bool {
        !matches!(self, Self::NotReady(_))
    }
}

/// What an error comes from, nearest first.
fn causes(error: &dyn Error) -> impl Iterator<Item = &(dyn Error + 'static)> {
    std::iter::successors(error.source(), |&cause| cause.source())
}

/// An error and its causes on one line, outermost first. A cause that the text before it tells already is
/// left out.
#[must_use]
pub fn report(error: &dyn Error) -> String {
    let mut text = error.to_string();
    for cause in causes(error) {
        let inner = cause.to_string();
        if !text.contains(&inner) {
            text = format!("{text}: {inner}");
        }
    }
    text
}

/// Where in a dataset something went wrong; what is not known is left out.
///
/// ```
/// use runner::Place;
/// use schema::AgentId;
///
/// let place = Place::scene(42).frame(118).agent(AgentId::vehicle(1));
/// assert_eq!(place.to_string(), "scene 42 frame 118 vehicle_1: ");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// A file of the store, or one that was read.
    pub file: Option<String>,
    /// The scene.
    pub scene: Option<u32>,
    /// The frame.
    pub frame: Option<u32>,
    /// The agent.
    pub agent: Option<AgentId>,
    /// The agent's sensor.
    pub sensor: Option<String>,
}

impl Place {
    /// A scene.
    #[must_use]
    pub fn scene(scene: u32) -> Self {
        Self { scene: Some(scene), ..Self::default() }
    }

    /// A file.
    #[must_use]
    pub fn file(file: impl Into<String>) -> Self {
        Self { file: Some(file.into()), ..Self::default() }
    }

    /// A file that belongs to this place.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.file = Some(file.into());
        self
    }

    /// One of its frames.
    #[must_use]
    pub fn frame(mut self, frame: u32) -> Self {
        self.frame = Some(frame);
        self
    }

    /// One of its agents.
    #[must_use]
    pub fn agent(mut self, agent: AgentId) -> Self {
        self.agent = Some(agent);
        self
    }

    /// One of its agent's sensors.
    #[must_use]
    pub fn sensor(mut self, sensor: &str) -> Self {
        self.sensor = Some(sensor.to_owned());
        self
    }
}

/// Ends with `: `, so that what happened follows; empty where nothing is known.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, scene, frame, agent, sensor } = self;
        if let Some(file) = file {
            write!(f, "{file}: ")?;
        }
        let parts = [
            scene.map(|scene| format!("scene {scene}")),
            frame.map(|frame| format!("frame {frame}")),
            agent.map(|agent| agent.to_string()),
            sensor.clone(),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { Ok(()) } else { write!(f, "{}: ", parts.join(" ")) }
    }
}

/// Says where an error happened.
pub trait At<T> {
    /// Turns the error into a [`StageError::Failed`] at a place.
    ///
    /// # Errors
    /// That of the result.
    fn at(self, place: impl FnOnce() -> Place) -> Result<T, StageError>;
}

impl<T, E: Into<Box<dyn Error + Send + Sync>>> At<T> for Result<T, E> {
    fn at(self, place: impl FnOnce() -> Place) -> Result<T, StageError> {
        self.map_err(|e| StageError::Failed { place: Box::new(place()), source: e.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("velocity is NaN")]
    struct Outer(#[source] std::num::ParseFloatError);

    #[test]
    fn a_report_names_place_and_causes_once() {
        let cause = "x".parse::<f64>().expect_err("is no number");
        let error = Err::<(), _>(Outer(cause)).at(|| Place::scene(3).frame(7).in_file("a.parquet"));
        let error = error.expect_err("fails");
        assert_eq!(error.report(), "a.parquet: scene 3 frame 7: velocity is NaN: invalid float literal");
        let full = std::io::Error::from_raw_os_error(28);
        let report = StageError::from(StoreError::write("b.npz", "write", full)).report();
        assert_eq!(report.matches("No space left").count(), 1, "{report}");
    }

    #[test]
    fn only_a_scenes_own_fault_lets_the_stage_go_on() {
        let io = |code| std::io::Error::from_raw_os_error(code);
        // ENOSPC, EDQUOT, EFBIG, EIO, EROFS.
        for code in [28, 122, 27, 5, 30] {
            assert_eq!(
                StageError::from(StoreError::write("f", "write", io(code))).exit_code(),
                EXIT_TRY_AGAIN
            );
        }
        assert_eq!(StageError::from(StoreError::read("f", "read", io(5))).exit_code(), EXIT_SOME_FAILED);
        let other = StoreError::Format { path: "m".into(), found: 2, expected: 1 };
        assert_eq!(StageError::from(other).exit_code(), EXIT_USAGE);
        assert_eq!(StageError::usage("no such map").exit_code(), EXIT_USAGE);
        assert_eq!(StageError::Panic { message: "x".into() }.exit_code(), EXIT_SOME_FAILED);
    }

    /// As readers of scenes, maps and logs wrap the store's errors.
    #[derive(Debug, thiserror::Error)]
    #[error("{0}")]
    struct Wrapped<E: Error + 'static>(#[source] E);

    #[test]
    fn the_stores_faults_keep_their_exit_code_however_deep_they_lie() {
        let late = || StoreError::read("f", "read", std::io::ErrorKind::TimedOut.into());
        let newer = || StoreError::Format { path: "m".into(), found: 2, expected: 1 };
        let broken = || StoreError::Corrupt { path: "f".into(), problem: "is no Parquet file".into() };
        for (fault, code) in [
            (&late as &dyn Fn() -> StoreError, EXIT_TRY_AGAIN),
            (&newer, EXIT_USAGE),
            (&broken, EXIT_SOME_FAILED),
        ] {
            let text = fault().to_string();
            let wrapped = [
                Err::<(), _>(fault()).at(|| Place::scene(3)),
                Err(Wrapped(fault())).at(|| Place::scene(3)),
                Err(Wrapped(Wrapped(fault()))).at(|| Place::scene(3)),
            ];
            for error in wrapped.map(|result| result.expect_err("fails")) {
                assert_eq!(error.exit_code(), code, "{error:?}");
                assert_eq!(error.report(), format!("scene 3: {text}"));
            }
        }
    }
}
