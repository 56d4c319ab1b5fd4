//! What a town of style `highways` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// Highways with ramps and Michigan lefts.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HighwaysParameters {
    /// Roads that cross the divided highway (3..=8).
    pub crossroads: u32,
    /// Least and largest distance between two of them, metres.
    pub spacing_m: [f64; 2],
    /// Width of the highway's median, metres (14..=24).
    pub median_m: f64,
    /// How far roads wander from straight lines, metres (0..=50).
    pub wander_m: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=12).
    pub relief_m: f64,
}

impl Default for HighwaysParameters {
    fn default() -> Self {
        Self { crossroads: 4, spacing_m: [480.0, 560.0], median_m: 18.0, wander_m: 35.0, relief_m: 8.0 }
    }
}

impl HighwaysParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("highways.crossroads", f64::from(self.crossroads), [3.0, 8.0], "3 to 8")?;
        within("highways.spacing_m[0]", self.spacing_m[0], [460.0, 900.0], "460 to 900 m")?;
        within(
            "highways.spacing_m[1]",
            self.spacing_m[1],
            [self.spacing_m[0], 900.0],
            "from spacing_m[0] to 900 m",
        )?;
        within("highways.median_m", self.median_m, [14.0, 24.0], "14 to 24 m")?;
        within("highways.wander_m", self.wander_m, [0.0, 50.0], "0 to 50 m")?;
        within("highways.relief_m", self.relief_m, [0.0, 12.0], "0 to 12 m")
    }
}
