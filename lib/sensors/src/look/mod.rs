//! How surfaces look before light falls on them.

mod material;
mod noise;
mod pattern;

pub(crate) use material::{Facet, Gloss, Points, Surroundings, look};
pub(crate) use noise::{Noise, hash2, unit};
