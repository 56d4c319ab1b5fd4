//! The styles of towns: each turns its parameters into a layout.
//!
//! A new style is a file here with a `Parameters` struct (public, `#[serde(default, deny_unknown_fields)]`) that has
//! `check` and `layout`, one variant of [`Style`] with its arms below, and its table in
//! [`TownParameters`](crate::TownParameters).

mod blocks;
mod city;
mod downtown;
mod grid;
mod highways;
mod motorway;
mod trumpet;
mod viaduct;

pub use city::CityParameters;
pub use downtown::DowntownParameters;
pub use grid::GridParameters;
pub use highways::HighwaysParameters;
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
}

impl Style {
    /// Every style.
    pub const ALL: [Self; 5] = [Self::Grid, Self::City, Self::Downtown, Self::Viaduct, Self::Highways];

    /// Its name in a parameter file: the value of `style`, and the name of its table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::City => "city",
            Self::Downtown => "downtown",
            Self::Viaduct => "viaduct",
            Self::Highways => "highways",
        }
    }

    pub(crate) fn check(self, parameters: &TownParameters) -> Result<(), TownError> {
        match self {
            Self::Grid => parameters.grid.check(parameters),
            Self::City => parameters.city.check(),
            Self::Downtown => parameters.downtown.check(),
            Self::Viaduct => parameters.viaduct.check(),
            Self::Highways => parameters.highways.check(),
        }
    }

    pub(crate) fn layout(self, parameters: &TownParameters) -> Result<Layout, TownError> {
        match self {
            Self::Grid => Ok(grid::layout(parameters)),
            Self::City => Ok(city::layout(parameters)),
            Self::Downtown => Ok(downtown::layout(parameters)),
            Self::Viaduct => Ok(viaduct::layout(parameters)),
            Self::Highways => Ok(highways::layout(parameters)),
        }
    }
}
