//! What a town of style `oldtown` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A hilly old town.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OldTownParameters {
    /// Streets round the hill (3..=6).
    pub rings: u32,
    /// Least and largest distance between two of them, metres (70 to 150).
    pub ring_m: [f64; 2],
    /// Gates: lanes that come up from the outermost street (4..=8).
    pub gates: u32,
    /// How much the streets wind, as a share of their distance from the middle (0..=0.2).
    pub winding: f64,
    /// Height of the hill, metres; it is lower where lanes would be too steep (0..=60).
    pub hill_m: f64,
    /// Alleys that end (0..=10).
    pub alleys: u32,
    /// Probability that a side of a street has parked cars (0..=1).
    pub parking_share: f64,
}

impl Default for OldTownParameters {
    fn default() -> Self {
        Self {
            rings: 4,
            ring_m: [76.0, 94.0],
            gates: 6,
            winding: 0.14,
            hill_m: 38.0,
            alleys: 5,
            parking_share: 0.5,
        }
    }
}

impl OldTownParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("oldtown.rings", f64::from(self.rings), [3.0, 6.0], "3 to 6")?;
        within("oldtown.ring_m[0]", self.ring_m[0], [70.0, 150.0], "70 to 150 m")?;
        within("oldtown.ring_m[1]", self.ring_m[1], [self.ring_m[0], 150.0], "from ring_m[0] to 150 m")?;
        within("oldtown.gates", f64::from(self.gates), [4.0, 8.0], "4 to 8")?;
        within("oldtown.winding", self.winding, [0.0, 0.2], "0 to 0.2")?;
        within("oldtown.hill_m", self.hill_m, [0.0, 60.0], "0 to 60 m")?;
        within("oldtown.alleys", f64::from(self.alleys), [0.0, 10.0], "0 to 10")?;
        within("oldtown.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")
    }
}
