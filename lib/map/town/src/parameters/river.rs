//! What a town of style `river` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A small town on a river.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RiverParameters {
    /// Bridges (2..=5).
    pub bridges: u32,
    /// Length of the town along the river, metres (450..=1500, and 160 for each bridge).
    pub length_m: f64,
    /// Width of the river, metres (12..=60).
    pub river_m: f64,
    /// How far the river swings to either side, metres (0..=60).
    pub swing_m: f64,
    /// Rows of blocks on the north bank, where the centre is (1..=4).
    pub north_rows: u32,
    /// Rows of blocks on the south bank (1..=4).
    pub south_rows: u32,
    /// Height difference between the highest and the lowest ground, metres (0..=10).
    pub relief_m: f64,
}

impl Default for RiverParameters {
    fn default() -> Self {
        Self {
            bridges: 3,
            length_m: 620.0,
            river_m: 30.0,
            swing_m: 38.0,
            north_rows: 2,
            south_rows: 1,
            relief_m: 4.0,
        }
    }
}

impl RiverParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("river.bridges", f64::from(self.bridges), [2.0, 5.0], "2 to 5")?;
        let least = (160.0 * f64::from(self.bridges)).max(450.0);
        within("river.length_m", self.length_m, [least, 1500.0], "450 to 1500 m, 160 m for each bridge")?;
        within("river.river_m", self.river_m, [12.0, 60.0], "12 to 60 m")?;
        within("river.swing_m", self.swing_m, [0.0, 60.0], "0 to 60 m")?;
        within("river.north_rows", f64::from(self.north_rows), [1.0, 4.0], "1 to 4")?;
        within("river.south_rows", f64::from(self.south_rows), [1.0, 4.0], "1 to 4")?;
        within("river.relief_m", self.relief_m, [0.0, 10.0], "0 to 10 m")
    }
}
