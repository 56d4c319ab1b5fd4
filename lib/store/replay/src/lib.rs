#![doc = include_str!("../README.md")]

pub mod maps;
mod models;
pub mod packed;
mod replay;
pub mod tiles;

pub use replay::{Replay, ReplayError};
pub use world::Light;
