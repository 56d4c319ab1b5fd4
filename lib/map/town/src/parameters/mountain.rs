//! What a town of style `mountain` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A mountain town with a motorway in a figure of eight.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MountainParameters {
    /// Length of the figure of eight, metres (2200..=3600).
    pub length_m: f64,
    /// Its width, metres (940..=1400).
    pub width_m: f64,
    /// Lanes of the motorway in each direction (2..=4).
    pub lanes: u32,
    /// Height of the mountain, metres (30..=75).
    pub peak_m: f64,
    /// Streets along the slope of the town (3..=6).
    pub rows: u32,
    /// Probability that a side of a street in the town has parked cars (0..=1).
    pub parking_share: f64,
}

impl Default for MountainParameters {
    fn default() -> Self {
        Self { length_m: 2350.0, width_m: 960.0, lanes: 3, peak_m: 58.0, rows: 5, parking_share: 0.35 }
    }
}

impl MountainParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("mountain.length_m", self.length_m, [2200.0, 3600.0], "2200 to 3600 m")?;
        within("mountain.width_m", self.width_m, [940.0, 1400.0], "940 to 1400 m")?;
        within("mountain.lanes", f64::from(self.lanes), [2.0, 4.0], "2 to 4")?;
        within("mountain.peak_m", self.peak_m, [30.0, 75.0], "30 to 75 m")?;
        within("mountain.rows", f64::from(self.rows), [3.0, 6.0], "3 to 6")?;
        within("mountain.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")
    }
}
