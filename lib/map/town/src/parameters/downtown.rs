//! What a town of style `downtown` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A down-town with wide boulevards.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DowntownParameters {
    /// Streets that run north, the boulevard and both sides of the drive among them (7..=14).
    pub columns: u32,
    /// Streets that run east, the avenues and both sides of the drive among them (6..=12).
    pub rows: u32,
    /// Least and largest distance between two neighbouring streets, metres.
    pub block_m: [f64; 2],
    /// How far the streets of either district turn away from a right angle with the boulevard, degrees
    /// (0..=9).
    pub skew_deg: f64,
    /// How far the shore bulges out between its ends, metres (0..=120).
    pub shore_m: f64,
    /// Probability that an ordinary street is one-way (0..=1).
    pub one_way_share: f64,
    /// Probability that a side of a street has a parking lane (0..=1).
    pub parking_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=10).
    pub relief_m: f64,
}

impl Default for DowntownParameters {
    fn default() -> Self {
        Self {
            columns: 8,
            rows: 7,
            block_m: [112.0, 145.0],
            skew_deg: 7.0,
            shore_m: 70.0,
            one_way_share: 0.6,
            parking_share: 0.7,
            relief_m: 5.0,
        }
    }
}

impl DowntownParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("downtown.columns", f64::from(self.columns), [7.0, 14.0], "7 to 14")?;
        within("downtown.rows", f64::from(self.rows), [6.0, 12.0], "6 to 12")?;
        within("downtown.block_m[0]", self.block_m[0], [110.0, 400.0], "110 to 400 m")?;
        within("downtown.block_m[1]", self.block_m[1], [self.block_m[0], 400.0], "from block_m[0] to 400 m")?;
        within("downtown.skew_deg", self.skew_deg, [0.0, 9.0], "0 to 9 degrees")?;
        within("downtown.shore_m", self.shore_m, [0.0, 120.0], "0 to 120 m")?;
        within("downtown.one_way_share", self.one_way_share, [0.0, 1.0], "0 to 1")?;
        within("downtown.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")?;
        within("downtown.relief_m", self.relief_m, [0.0, 10.0], "0 to 10 m")
    }
}
