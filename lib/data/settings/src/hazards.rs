//! Accidents and road works.

use serde::Serialize;

/// Accidents and road works. Shares are 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HazardSettings {
    /// Share of the spawn points around the agents at which a hazard is tried (0.016).
    pub share: f64,
    /// Chance that it is an accident and not road works (0.5).
    pub accident_share: f64,
    /// Chance that an emergency vehicle stands at an accident (0.5).
    pub emergency_share: f64,
    /// Chance that a cone beside a hazard is missing (0.32).
    pub missing_cone_share: f64,
}

impl Default for HazardSettings {
    fn default() -> Self {
        Self { share: 0.016, accident_share: 0.5, emergency_share: 0.5, missing_cone_share: 0.32 }
    }
}
