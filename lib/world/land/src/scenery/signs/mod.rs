//! Signs: those that the map has, and those that roads have besides.

mod codes;
mod given;
mod plates;
mod roadside;
mod rules;

pub(crate) use given::given;
pub use plates::{PLATES, Plate};
pub(crate) use roadside::roadside;
