#![doc = include_str!("../README.md")]

mod arrays;
mod order;
mod pool;

pub use arrays::{FrameArray, FrameArrays, label_agents, write_arrays};
pub use order::in_frame_order;
