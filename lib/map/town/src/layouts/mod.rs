//! The styles of towns: each turns its parameters into a layout.
//!
//! A new style is a file here with a `layout`, a file in `parameters/` with its struct (public,
//! `#[serde(default, deny_unknown_fields)]`) that has `check`, one variant of [`Style`] with its arms, and
//! its table in [`TownParameters`].

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

use crate::error::TownError;
use crate::layout::Layout;
use crate::parameters::{Style, TownParameters};

/// The layout of a town.
pub(crate) fn layout(parameters: &TownParameters) -> Result<Layout, TownError> {
    match parameters.style {
        Style::Grid => Ok(grid::layout(parameters)),
        Style::City => Ok(city::layout(parameters)),
        Style::Downtown => Ok(downtown::layout(parameters)),
        Style::Viaduct => Ok(viaduct::layout(parameters)),
        Style::Highways => Ok(highways::layout(parameters)),
        Style::River => Ok(river::layout(parameters)),
        Style::Commercial => Ok(commercial::layout(parameters)),
        Style::Rural => Ok(rural::layout(parameters)),
        Style::OldTown => Ok(old_town::layout(parameters)),
        Style::Mountain => Ok(mountain::layout(parameters)),
        Style::Region => region::layout(parameters, layout),
    }
}
