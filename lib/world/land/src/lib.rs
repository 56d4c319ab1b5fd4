#![doc = include_str!("../README.md")]

pub mod horizon;
mod noise;
pub mod scenery;
pub mod surfaces;
pub mod tiles;
