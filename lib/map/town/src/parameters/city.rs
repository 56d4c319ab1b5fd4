//! What a town of style `city` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A city with multi-lane junctions, a roundabout and an underpass.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CityParameters {
    /// Streets that run north, the boulevard and the two sides of the ring among them (6..=14).
    pub columns: u32,
    /// Streets that run east, the avenue and the two sides of the ring among them (5..=14).
    pub rows: u32,
    /// Least and largest distance between two neighbouring streets, metres.
    pub block_m: [f64; 2],
    /// How far crossings lie off the grid, metres (0..=25).
    pub disorder_m: f64,
    /// Radius of the roundabout's island, metres (12..=40); larger where the streets need it.
    pub island_m: f64,
    /// Probability that a side of a street has a parking lane (0..=1).
    pub parking_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=10).
    pub relief_m: f64,
}

impl Default for CityParameters {
    fn default() -> Self {
        Self {
            columns: 7,
            rows: 6,
            block_m: [125.0, 165.0],
            disorder_m: 12.0,
            island_m: 17.0,
            parking_share: 0.5,
            relief_m: 5.0,
        }
    }
}

impl CityParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("city.columns", f64::from(self.columns), [6.0, 14.0], "6 to 14")?;
        within("city.rows", f64::from(self.rows), [5.0, 14.0], "5 to 14")?;
        within("city.block_m[0]", self.block_m[0], [110.0, 1000.0], "110 to 1000 m")?;
        within("city.block_m[1]", self.block_m[1], [self.block_m[0], 1000.0], "from block_m[0] to 1000 m")?;
        within("city.disorder_m", self.disorder_m, [0.0, 25.0], "0 to 25 m")?;
        within("city.island_m", self.island_m, [12.0, 40.0], "12 to 40 m")?;
        within("city.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")?;
        within("city.relief_m", self.relief_m, [0.0, 10.0], "0 to 10 m")
    }
}
