#![doc = include_str!("../README.md")]

mod replay;

pub use replay::{Replay, ReplayError};
