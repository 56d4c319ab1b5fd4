//! What is suspicious in a configuration or in the plan that it gives: said once, and refused on demand.

use std::path::Path;

use settings::{DatasetSettings, Fault};

/// What becomes of what is suspicious.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suspicious {
    /// It is not said: another program says it.
    Unsaid,
    /// It is said.
    Said,
    /// It is an error.
    Refused,
}

impl Suspicious {
    /// `strict` refuses it; else it is said where that is `told`.
    #[must_use]
    pub fn of(strict: bool, told: bool) -> Self {
        match (strict, told) {
            (true, _) => Self::Refused,
            (false, true) => Self::Said,
            (false, false) => Self::Unsaid,
        }
    }

    /// Says what was found; whether work may go on.
    #[must_use]
    pub(crate) fn pass(self, found: &[Fault]) -> bool {
        match self {
            Self::Unsaid => true,
            Self::Said => {
                found.iter().for_each(|suspicion| tracing::warn!("{suspicion}"));
                true
            }
            Self::Refused => {
                found.iter().for_each(|suspicion| tracing::error!("{suspicion}"));
                if !found.is_empty() {
                    tracing::error!("--strict: warnings are errors ({})", found.len());
                }
                found.is_empty()
            }
        }
    }
}

/// Reads the configuration, printing every fault and what is suspicious. None: it cannot be used.
#[must_use]
pub fn settings_or_faults(path: &Path, rule: Suspicious) -> Option<DatasetSettings> {
    match settings::load(path) {
        Ok((settings, found)) => rule.pass(&found).then_some(settings),
        Err(faults) => {
            for fault in faults {
                tracing::error!("{fault}");
            }
            None
        }
    }
}
