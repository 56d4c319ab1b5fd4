//! What a town of style `grid` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A street grid with signalised crossings inside a ring road.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GridParameters {
    /// Streets that run north, each crossing every street that runs east (1..=64).
    pub columns: u32,
    /// Streets that run east (1..=64).
    pub rows: u32,
    /// Least and largest distance between the centre lines of two neighbouring streets, metres.
    pub block_m: [f64; 2],
    /// Radius of the ring road's centre line in its four corners, metres (15..=45).
    pub ring_radius_m: f64,
    /// Widest place of the avenue's median, metres; 0 builds a painted centre line only (0..=6).
    pub median_m: f64,
    /// Probability that a side of a street has a parking lane (0..=1).
    pub parking_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=12).
    pub relief_m: f64,
}

impl Default for GridParameters {
    fn default() -> Self {
        Self {
            columns: 4,
            rows: 3,
            block_m: [70.0, 110.0],
            ring_radius_m: 35.0,
            median_m: 2.4,
            parking_share: 0.6,
            relief_m: 4.0,
        }
    }
}

impl GridParameters {
    pub(super) fn check(&self, lane_width_m: f64, sidewalk_m: f64) -> Result<(), TownError> {
        within("grid.columns", f64::from(self.columns), [1.0, 64.0], "1 to 64")?;
        within("grid.rows", f64::from(self.rows), [1.0, 64.0], "1 to 64")?;
        within("grid.block_m[0]", self.block_m[0], [40.0, 1000.0], "40 to 1000 m")?;
        within("grid.block_m[1]", self.block_m[1], [self.block_m[0], 1000.0], "from block_m[0] to 1000 m")?;
        within("grid.ring_radius_m", self.ring_radius_m, [15.0, 45.0], "15 to 45 m")?;
        within("grid.median_m", self.median_m, [0.0, 6.0], "0 to 6 m")?;
        within("grid.parking_share", self.parking_share, [0.0, 1.0], "0 to 1")?;
        within("grid.relief_m", self.relief_m, [0.0, 12.0], "0 to 12 m")?;
        // The ring's corners turn round the sidewalk inside them.
        let most = self.ring_radius_m - lane_width_m - 4.0;
        within("sidewalk_m", sidewalk_m, [1.5, most], "1.5 to 5 m, and less than the ring's corners")
    }
}
