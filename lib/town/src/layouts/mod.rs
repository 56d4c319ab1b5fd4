//! The styles of towns: each turns its parameters into a layout.
//!
//! A new style is a file here with a `Parameters` struct (public, `#[serde(default, deny_unknown_fields)]`) that has
//! `check` and `layout`, one variant of [`Style`] with its arms below, and its table in
//! [`TownParameters`](crate::TownParameters).

mod blocks;
mod carriageways;
mod city;
mod commercial;
mod country;
mod downtown;
mod graph;
mod grid;
mod highways;
mod motorway;
mod mountain;
mod old_town;
mod patch;
mod plane;
mod region;
mod region_land;
mod region_roads;
mod river;
mod rural;
mod slope_town;
mod trumpet;
mod viaduct;

pub use city::CityParameters;
pub use commercial::CommercialParameters;
pub use downtown::DowntownParameters;
pub use grid::GridParameters;
pub use highways::HighwaysParameters;
pub use mountain::MountainParameters;
pub use old_town::OldTownParameters;
pub use region::RegionParameters;
pub use river::RiverParameters;
pub use rural::RuralParameters;
pub use viaduct::ViaductParameters;

use serde::Deserialize;

use crate::layout::Layout;
use crate::{TownError, TownParameters};

/// Which kind of town.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Style {
    /// Signalised blocks inside a ring road.
    #[default]
    Grid,
    /// A city with boulevards, turn lanes, a roundabout and an underpass.
    City,
    /// A down-town with wide boulevards, one-way streets and a drive around it.
    Downtown,
    /// A grid city with an elevated motorway.
    Viaduct,
    /// A motorway ring, and a divided highway with Michigan lefts.
    Highways,
    /// A small town on both banks of a river.
    River,
    /// A boulevard between a dense centre and large blocks.
    Commercial,
    /// Country roads with narrow lanes.
    Rural,
    /// Winding streets on a hill.
    OldTown,
    /// A motorway in a figure of eight round a town and a mountain.
    Mountain,
    /// Several towns, farmland and a motorway.
    Region,
}

impl Style {
    /// Every style.
    pub const ALL: [Self; 11] = [
        Self::Grid,
        Self::City,
        Self::Downtown,
        Self::Viaduct,
        Self::Highways,
        Self::River,
        Self::Commercial,
        Self::Rural,
        Self::OldTown,
        Self::Mountain,
        Self::Region,
    ];

    /// Its name in a parameter file: the value of `style`, and the name of its table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::City => "city",
            Self::Downtown => "downtown",
            Self::Viaduct => "viaduct",
            Self::Highways => "highways",
            Self::River => "river",
            Self::Commercial => "commercial",
            Self::Rural => "rural",
            Self::OldTown => "oldtown",
            Self::Mountain => "mountain",
            Self::Region => "region",
        }
    }

    pub(crate) fn check(self, parameters: &TownParameters) -> Result<(), TownError> {
        match self {
            Self::Grid => parameters.grid.check(parameters),
            Self::City => parameters.city.check(),
            Self::Downtown => parameters.downtown.check(),
            Self::Viaduct => parameters.viaduct.check(),
            Self::Highways => parameters.highways.check(),
            Self::River => parameters.river.check(),
            Self::Commercial => parameters.commercial.check(),
            Self::Rural => parameters.rural.check(),
            Self::OldTown => parameters.oldtown.check(),
            Self::Mountain => parameters.mountain.check(),
            Self::Region => parameters.region.check(),
        }
    }

    pub(crate) fn layout(self, parameters: &TownParameters) -> Result<Layout, TownError> {
        match self {
            Self::Grid => Ok(grid::layout(parameters)),
            Self::City => Ok(city::layout(parameters)),
            Self::Downtown => Ok(downtown::layout(parameters)),
            Self::Viaduct => Ok(viaduct::layout(parameters)),
            Self::Highways => Ok(highways::layout(parameters)),
            Self::River => Ok(river::layout(parameters)),
            Self::Commercial => Ok(commercial::layout(parameters)),
            Self::Rural => Ok(rural::layout(parameters)),
            Self::OldTown => Ok(old_town::layout(parameters)),
            Self::Mountain => Ok(mountain::layout(parameters)),
            Self::Region => region::layout(parameters),
        }
    }
}
