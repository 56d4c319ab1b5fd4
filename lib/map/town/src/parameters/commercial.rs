//! What a town of style `commercial` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// A commercial town.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CommercialParameters {
    /// Streets of the centre that leave the boulevard, the two outer ones among them (5..=12).
    pub columns: u32,
    /// Rows of blocks in the centre (2..=6); from 3 on there is a market place.
    pub rows: u32,
    /// Least and largest distance between two streets of the centre, metres (95 to 200).
    pub block_m: [f64; 2],
    /// Depth of the large blocks on the other side of the boulevard, metres (110..=300).
    pub depth_m: f64,
    /// Probability that a piece of street inside the centre is left out, so that blocks merge (0..=0.5).
    pub merged_share: f64,
    /// Closes behind the large blocks; at most one for each of them (0..=8).
    pub closes: u32,
    /// Height difference between the highest and the lowest ground, metres (0..=10).
    pub relief_m: f64,
}

impl Default for CommercialParameters {
    fn default() -> Self {
        Self {
            columns: 6,
            rows: 3,
            block_m: [98.0, 124.0],
            depth_m: 140.0,
            merged_share: 0.33,
            closes: 4,
            relief_m: 4.0,
        }
    }
}

impl CommercialParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("commercial.columns", f64::from(self.columns), [5.0, 12.0], "5 to 12")?;
        within("commercial.rows", f64::from(self.rows), [2.0, 6.0], "2 to 6")?;
        within("commercial.block_m[0]", self.block_m[0], [95.0, 200.0], "95 to 200 m")?;
        let most = [self.block_m[0], 200.0];
        within("commercial.block_m[1]", self.block_m[1], most, "from block_m[0] to 200 m")?;
        within("commercial.depth_m", self.depth_m, [110.0, 300.0], "110 to 300 m")?;
        within("commercial.merged_share", self.merged_share, [0.0, 0.5], "0 to 0.5")?;
        within("commercial.closes", f64::from(self.closes), [0.0, 8.0], "0 to 8")?;
        within("commercial.relief_m", self.relief_m, [0.0, 10.0], "0 to 10 m")
    }
}
