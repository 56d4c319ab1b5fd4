//! What a town of style `rural` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use crate::error::TownError;

/// Country roads.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RuralParameters {
    /// Crossroads from west to east (3..=8).
    pub columns: u32,
    /// Crossroads from south to north (3..=8).
    pub rows: u32,
    /// Least and largest distance between two crossroads, metres (180 to 600).
    pub spacing_m: [f64; 2],
    /// How far crossroads lie off the grid, and roads off the straight line, metres (0..=60, and at
    /// most a quarter of the least spacing).
    pub disorder_m: f64,
    /// Width of a lane of the narrow roads, metres (2.5..=3.5).
    pub lane_m: f64,
    /// Probability that a road between two crossroads is left out (0..=0.4).
    pub missing_share: f64,
    /// Farms at the end of a track (0..=12).
    pub farms: u32,
    /// Whether a railway crosses the map.
    pub railway: bool,
    /// Height difference between the highest and the lowest ground, metres; less where roads would be too
    /// steep (0..=15).
    pub relief_m: f64,
}

impl Default for RuralParameters {
    fn default() -> Self {
        Self {
            columns: 4,
            rows: 4,
            spacing_m: [220.0, 310.0],
            disorder_m: 54.0,
            lane_m: 2.75,
            missing_share: 0.25,
            farms: 5,
            railway: true,
            relief_m: 10.0,
        }
    }
}

impl RuralParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("rural.columns", f64::from(self.columns), [3.0, 8.0], "3 to 8")?;
        within("rural.rows", f64::from(self.rows), [3.0, 8.0], "3 to 8")?;
        within("rural.spacing_m[0]", self.spacing_m[0], [180.0, 600.0], "180 to 600 m")?;
        let most = [self.spacing_m[0], 600.0];
        within("rural.spacing_m[1]", self.spacing_m[1], most, "from spacing_m[0] to 600 m")?;
        let most = (0.25 * self.spacing_m[0]).min(60.0);
        within(
            "rural.disorder_m",
            self.disorder_m,
            [0.0, most],
            "0 to 60 m, a quarter of spacing_m[0] at most",
        )?;
        within("rural.lane_m", self.lane_m, [2.5, 3.5], "2.5 to 3.5 m")?;
        within("rural.missing_share", self.missing_share, [0.0, 0.4], "0 to 0.4")?;
        within("rural.farms", f64::from(self.farms), [0.0, 12.0], "0 to 12")?;
        within("rural.relief_m", self.relief_m, [0.0, 15.0], "0 to 15 m")
    }
}
