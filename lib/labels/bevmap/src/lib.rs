#![doc = include_str!("../README.md")]

mod lanes;
mod paint;

pub use lanes::LaneCollector;
pub use paint::{Paint, Reach, road_lines};
