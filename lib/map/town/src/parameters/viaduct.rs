//! What a town of style `viaduct` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A grid city with an elevated motorway.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViaductParameters {
    /// Streets that run north (10..=16).
    pub columns: u32,
    /// Streets that run east south of the viaduct (2..=6).
    pub rows_south: u32,
    /// Streets that run east north of the viaduct (3..=6).
    pub rows_north: u32,
    /// Least and largest distance between two neighbouring streets, metres.
    pub block_m: [f64; 2],
    /// Height of the viaduct over the ground, metres (6.5..=9).
    pub deck_m: f64,
    /// Driving lanes of each direction of the motorway (2..=4).
    pub motorway_lanes: u8,
    /// Probability that a stretch of street is left out, so that two blocks are one (0..=0.3).
    pub gaps: f64,
    /// Probability that a side of a street has a parking lane (0..=1).
    pub parking_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=6).
    pub relief_m: f64,
}

impl Default for ViaductParameters {
    fn default() -> Self {
        Self {
            columns: 11,
            rows_south: 3,
            rows_north: 4,
            block_m: [116.0, 136.0],
            deck_m: 7.4,
            motorway_lanes: 2,
            gaps: 0.12,
            parking_share: 0.6,
            relief_m: 3.0,
        }
    }
}

impl ViaductParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("viaduct.columns", f64::from(self.columns), [10.0, 16.0], "10 to 16")?;
        within("viaduct.rows_south", f64::from(self.rows_south), [2.0, 6.0], "2 to 6")?;
        within("viaduct.rows_north", f64::from(self.rows_north), [3.0, 6.0], "3 to 6")?;
        within("viaduct.block_m[0]", self.block_m[0], [115.0, 140.0], "115 to 140 m")?;
        within("viaduct.block_m[1]", self.block_m[1], [self.block_m[0], 200.0], "from block_m[0] to 200 m")?;
        within("viaduct.deck_m", self.deck_m, [6.5, 9.0], "6.5 to 9 m")?;
        within("viaduct.motorway_lanes", f64::from(self.motorway_lanes), [2.0, 4.0], "2 to 4")?;
        within("viaduct.gaps", self.gaps, [0.0, 0.3], "0 to 0.3")?;
        within("viaduct.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")?;
        within("viaduct.relief_m", self.relief_m, [0.0, 6.0], "0 to 6 m")
    }
}
