#![doc = include_str!("README.md")]

mod arrays;
mod order;
mod pool;

pub use arrays::{FrameArray, FrameArrays, Labelled, label_agents, write_labels};
pub use order::{FrameGroup, Writer, in_turn};
