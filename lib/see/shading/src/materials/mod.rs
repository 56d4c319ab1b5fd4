//! How surfaces look before light falls on them.

mod cells;
mod cloth;
mod dirt;
mod facade;
mod facet;
mod front;
mod ground;
mod gutter;
mod laid;
mod lane;
mod material;
mod pattern;
mod paving;
mod points;
mod room;
mod skin;

pub(crate) use facet::{Facet, Gloss, Points, Surroundings};
pub(crate) use ground::gets_wet;
pub(crate) use material::{Stuff, look};
