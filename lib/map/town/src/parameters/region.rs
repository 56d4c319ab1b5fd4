//! What a town of style `region` can be asked to look like.

use serde::Deserialize;

use super::range::within;
use super::style::Style;
use crate::error::TownError;

/// Largest height difference of ground with open water, metres: its lowest parts are just over it.
const FLAT_M: f64 = 8.0;
/// Styles whose towns have neither motorways nor rivers of their own.
const IN_REGIONS: [Style; 5] = [Style::City, Style::Grid, Style::Downtown, Style::Commercial, Style::OldTown];

/// A region with several towns.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RegionParameters {
    /// Length of the region's sides, metres (7000..=12000).
    pub size_m: f64,
    /// Styles of its towns: `city`, `grid`, `downtown`, `commercial` or `oldtown`.
    pub towns: Vec<Style>,
    /// Roundabouts where main roads meet, instead of traffic lights.
    pub roundabouts: bool,
    /// Lanes of the motorway in each direction (2..=4).
    pub motorway_lanes: u32,
    /// Its speed limit, km/h (80..=130).
    pub motorway_kmh: f64,
    /// Width of the lanes of main country roads, metres (2.75..=3.75); others are narrower.
    pub road_m: f64,
    /// Speed limit of main country roads, km/h (50..=100).
    pub road_kmh: f64,
    /// Distance between neighbouring road junctions in the farmland, metres (600..=1500).
    pub farms_m: f64,
    /// How much country roads wind (0..=1).
    pub winding: f64,
    /// Probability that a country junction has a hamlet round it (0..=1).
    pub hamlet_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=60, with a river or a coast
    /// 0..=8).
    pub relief_m: f64,
    /// A river from north to south.
    pub river: bool,
    /// The sea in the south.
    pub coast: bool,
}

impl Default for RegionParameters {
    fn default() -> Self {
        Self {
            size_m: 10_000.0,
            towns: vec![
                Style::City,
                Style::Downtown,
                Style::Grid,
                Style::Commercial,
                Style::OldTown,
                Style::Grid,
            ],
            roundabouts: false,
            motorway_lanes: 3,
            motorway_kmh: 120.0,
            road_m: 3.5,
            road_kmh: 90.0,
            farms_m: 950.0,
            winding: 0.35,
            hamlet_share: 0.22,
            relief_m: 36.0,
            river: false,
            coast: false,
        }
    }
}

impl RegionParameters {
    pub(super) fn check(&self) -> Result<(), TownError> {
        within("region.size_m", self.size_m, [7000.0, 12_000.0], "7000 to 12000 m")?;
        within("region.motorway_lanes", f64::from(self.motorway_lanes), [2.0, 4.0], "2 to 4")?;
        within("region.motorway_kmh", self.motorway_kmh, [80.0, 130.0], "80 to 130 km/h")?;
        within("region.road_m", self.road_m, [2.75, 3.75], "2.75 to 3.75 m")?;
        within("region.road_kmh", self.road_kmh, [50.0, 100.0], "50 to 100 km/h")?;
        within("region.farms_m", self.farms_m, [600.0, 1500.0], "600 to 1500 m")?;
        within("region.winding", self.winding, [0.0, 1.0], "0 to 1")?;
        within("region.hamlet_share", self.hamlet_share, [0.0, 1.0], "0 to 1")?;
        if self.river || self.coast {
            let most = [0.0, FLAT_M];
            within("region.relief_m", self.relief_m, most, "0 to 8 m where there is a river or a coast")?;
        }
        within("region.relief_m", self.relief_m, [0.0, 60.0], "0 to 60 m")?;
        within("region.towns, their number,", self.towns.len() as f64, [1.0, 10.0], "1 to 10")?;
        let whole = |s: &&Style| !IN_REGIONS.contains(s);
        match self.towns.iter().find(whole) {
            Some(style) => Err(TownError::Layout {
                place: "region.towns".into(),
                problem: format!("a region can't hold a town of style {}", style.name()),
            }),
            None => Ok(()),
        }
    }
}
