#![doc = include_str!("../README.md")]

mod make;
mod number;

pub use make::{Surroundings, Tile, TileMaker};
pub use number::{Numbered, TooManyObjects, number, reached};
