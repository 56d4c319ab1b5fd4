//! Generated road networks, written as OpenDRIVE.
//!
//! [`generate`] turns [`TownParameters`] into an [`opendrive::Network`]: the same parameters give the same bytes. The
//! pieces compose: a layout (a street grid with a ring road is the one at hand) states nodes and edges, and every
//! layout shares the street builder, the junction builder and the signs and signals.
//!
//! ```
//! let parameters = town::named("convoy/demo").unwrap_or_default();
//! let network = town::generate(&parameters)?;
//! let xodr = opendrive::write(&network);
//! assert!(xodr.contains("<junction"));
//! # Ok::<(), town::TownError>(())
//! ```

mod assemble;
mod control;
mod grid;
mod junction;
mod marks;
mod movements;
mod parameters;
mod path;
mod section;
mod street;

pub use parameters::{TownError, TownParameters, named, names};

use opendrive::Network;

/// Builds the road network of a town.
///
/// Right-hand traffic, metres, x east, y north, the town's middle near the origin.
///
/// # Errors
/// [`TownError`] where a parameter is out of range, or blocks are too small for the junctions at their corners.
pub fn generate(parameters: &TownParameters) -> Result<Network, TownError> {
    parameters.check()?;
    assemble::assemble(&grid::layout(parameters))
}
