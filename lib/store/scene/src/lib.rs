#![doc = include_str!("../README.md")]

mod arrays;
mod described;
mod error;
mod frames;
mod ground;
mod inventory;
mod labels;
mod log;
mod reader;
mod sensor;
mod unknown;

pub use arrays::ArrayReader;
pub use described::described;
pub use error::SceneError;
pub use frames::FrameRanges;
pub use ground::read_ground;
pub use inventory::{SensorEntry, sensors_of};
pub use labels::{BoxFrames, LabelledBox};
pub use log::SceneLog;
pub use reader::SceneReader;
pub use schema::SensorKind;
pub use sensor::{SensorFrames, agent_rows, read_calibration};
pub use unknown::unknown_columns;
