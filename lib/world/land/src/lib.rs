#![doc = include_str!("../README.md")]

pub mod horizon;
pub mod scenery;
pub mod surfaces;
pub mod tiles;
