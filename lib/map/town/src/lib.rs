//! Generated road networks, written as OpenDRIVE.
//!
//! [`generate`] turns [`TownParameters`] into an [`opendrive::Network`]: the same parameters give the same
//! bytes. A style (`layouts/`) states nodes, edges and the ground under them ([`layout`] has a worked
//! example); every style shares the builder: streets with their lanes, heights and bends, junctions of all
//! kinds, signals and signs, bridges and tunnels.
//!
//! ```
//! let parameters = town::named("convoy/demo").unwrap_or_default();
//! let network = town::generate(&parameters)?;
//! let xodr = opendrive::write(&network);
//! assert!(xodr.contains("<junction"));
//! # Ok::<(), town::TownError>(())
//! ```

mod arm;
mod arrow;
mod assemble;
mod banking;
mod control;
mod decks;
mod error;
mod fill;
mod heights;
mod ids;
mod junction;
mod layout;
mod layouts;
mod limits;
mod marks;
mod movements;
mod node_plan;
mod parameters;
mod path;
mod profile;
mod roundabout;
mod route;
mod seam;
mod section;
mod street;
mod strips;
mod terrain;
mod water;
mod word;

#[cfg(test)]
#[path = "../tests/town/check/mod.rs"]
mod check;
#[cfg(test)]
mod proofs;

pub use error::TownError;
pub use parameters::{
    CityParameters, CommercialParameters, DowntownParameters, GridParameters, HighwaysParameters,
    MountainParameters, OldTownParameters, RegionParameters, RiverParameters, RuralParameters, Style,
    TownParameters, ViaductParameters, named, names,
};

use opendrive::Network;

/// Builds the road network of a town.
///
/// Right-hand traffic, metres, x east, y north, the town's middle near the origin.
///
/// # Errors
/// [`TownError`] where a parameter is out of range, or what it asks for has no room: streets too short or too
/// steep, bends too tight, roads that cross without a junction or enough height between them.
pub fn generate(parameters: &TownParameters) -> Result<Network, TownError> {
    parameters.check()?;
    assemble::build(&layouts::layout(parameters)?)
}
