#![doc = include_str!("../README.md")]

mod models;
mod replay;

pub use replay::{Replay, ReplayError};
pub use world::Light;
